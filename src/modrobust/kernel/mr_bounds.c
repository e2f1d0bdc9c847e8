/* Checked computations at one state: parameters, inverse dynamics, its bounds, (12). */
#include "mr_internal.h"

#define DOUBLES(type) (sizeof(type) / sizeof(double))

size_t mr_workspace_size(const mr_model *model) {
    const size_t j = (size_t)model->j, b = (size_t)model->b, padded = mr_padded(model);
    return j * (DOUBLES(mr_link) + DOUBLES(mr_wrench_box) + DOUBLES(mr_size) + DOUBLES(mr_pose)) +
           b * DOUBLES(mr_motion) + 19 * padded;
}

mr_workspace mr_workspace_view(const mr_model *model, double *memory) {
    const size_t j = (size_t)model->j, b = (size_t)model->b, padded = mr_padded(model);
    mr_workspace view;
    view.links = (mr_link *)memory;
    memory += j * DOUBLES(mr_link);
    view.motions = (mr_motion *)memory;
    memory += b * DOUBLES(mr_motion);
    view.wrench.box = (mr_wrench_box *)memory;
    memory += j * DOUBLES(mr_wrench_box);
    view.sizes = (mr_size *)memory;
    memory += j * DOUBLES(mr_size);
    view.poses = (mr_pose *)memory;
    memory += j * DOUBLES(mr_pose);
    view.axes = memory;
    memory += 9 * padded;
    double **arrays[10] = {&view.lo,    &view.hi,      &view.mid,     &view.slack,   &view.dq_a,
                           &view.ddq_a, &view.full[0], &view.full[1], &view.full[2], &view.full[3]};
    for (size_t k = 0; k < 10; ++k) *arrays[k] = memory + k * padded;
    return view;
}

size_t mr_parameters_size(const mr_model *model) {
    return 10 * (size_t)model->b + 3 * (size_t)model->j;
}

mr_parameters mr_parameters_view(const mr_model *model, const double *packed) {
    const size_t b = (size_t)model->b, j = (size_t)model->j;
    mr_parameters view;
    view.mass = packed;
    view.com = view.mass + b;
    view.inertia = view.com + 3 * b;
    view.rotor_inertia = view.inertia + 6 * b;
    view.viscous = view.rotor_inertia + j;
    view.coulomb = view.viscous + j;
    return view;
}

int32_t mr_do_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                             int32_t *uncertain) {
    int32_t count = 0;
    for (int32_t k = 0; k < b; ++k) {
        int differs = lower->mass[k] != upper->mass[k];
        for (int32_t e = 3 * k; e < 3 * k + 3; ++e) differs |= lower->com[e] != upper->com[e];
        for (int32_t e = 6 * k; e < 6 * k + 6; ++e)
            differs |= lower->inertia[e] != upper->inertia[e];
        if (differs) uncertain[count++] = k;
    }
    return count;
}

mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const double *q,
                        const double *dq, const double *dq_a, const double *ddq_a,
                        mr_state *state) {
    const int32_t n = model->n, j = model->j;
    const double *given[4] = {q, dq, dq_a, ddq_a};
    for (int v = 0; v < 4; ++v)
        if (!mr_all_finite(n, given[v])) return MR_NOT_FINITE;
    *state = (mr_state){q, dq, dq_a, ddq_a};
    if (j > n) {
        mr_follow(model, state, ws->full);
        for (int v = 0; v < 4; ++v)
            if (!mr_all_finite(j, ws->full[v])) return MR_NOT_FINITE;
    }
    for (int32_t i = 0; i < j; ++i)
        if (model->joint_type[i] == MR_REVOLUTE && fabs(state->q[i]) > MR_ANGLE_MAX)
            return MR_ANGLE_RANGE;
    return MR_OK;
}

static mr_status copy_finite(int32_t n, const double *from, double *to) {
    if (!mr_all_finite(n, from)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < n; ++i) to[i] = from[i];
    return MR_OK;
}

/* error may be NULL */
mr_status mr_do_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, int drives, double *workspace, double *tau,
                                 double *error) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_forward_recursion(model, &state, ws.links);
    mr_body_motions(model, ws.links, ws.motions);
    mr_newton_euler(model, parameters, ws.links, ws.motions, ws.wrench.real, ws.mid);
    if (drives) mr_add_drives(model, parameters, state.dq, state.ddq_a, ws.mid);
    mr_lead(model, ws.mid);
    if (error) {
        const double followed = mr_motion_sizes(model, &state, ws.sizes);
        mr_nominal_slack(model, parameters, &state, followed, drives, ws.sizes, ws.slack);
        if (!mr_all_finite(model->n, ws.mid)) return MR_NOT_FINITE;
        if (copy_finite(model->n, ws.slack, error)) return MR_NOT_FINITE;
    }
    return copy_finite(model->n, ws.mid, tau);
}

mr_status mr_do_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                        mr_method method, const double *q, const double *dq,
                                        const double *dq_a, const double *ddq_a, int drives,
                                        double *workspace, double *tau_lo, double *tau_hi) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_torque_box(model, bounds, method, &state, drives, &ws);
    mr_total_bounds(model, method, &ws);
    if (!mr_all_finite(model->n, ws.lo)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.hi, tau_hi)) return MR_NOT_FINITE;
    return copy_finite(model->n, ws.lo, tau_lo);
}

mr_status mr_do_perturbation_bounds(const mr_model *model, const mr_bounds *bounds,
                                    mr_method method, const double *q, const double *dq,
                                    const double *dq_a, const double *ddq_a, double *workspace,
                                    double *nominal, double *phi_lo, double *phi_hi) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_torque_box(model, bounds, method, &state, 1, &ws);
    for (int32_t i = 0; i < model->n; ++i) {
        const mr_interval d = {bounds->disturbance_lo[i], bounds->disturbance_hi[i]};
        mr_interval w = {ws.lo[i], ws.hi[i]};
        if (method == MR_IANEA) /* hull: already a difference, and the slack holds u0's rounding */
            w = mr_i_sub(w, (mr_interval){ws.mid[i], ws.mid[i]});
        else
            w = mr_i_widen(w, ws.slack[i]);
        w = mr_i_sub(w, d);
        ws.lo[i] = w.lo;
        ws.hi[i] = w.hi;
    }
    if (!mr_all_finite(model->n, ws.mid) || !mr_all_finite(model->n, ws.lo)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.hi, phi_hi)) return MR_NOT_FINITE;
    copy_finite(model->n, ws.mid, nominal);
    return copy_finite(model->n, ws.lo, phi_lo);
}

mr_status mr_do_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                             const double *dq, const double *dq_a, const double *ddq_a,
                             int drives, double *workspace, double *slack) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_hull_slack(model, bounds, &state, mr_motion_sizes(model, &state, ws.sizes), drives,
                  ws.sizes, ws.slack);
    return copy_finite(model->n, ws.slack, slack);
}
