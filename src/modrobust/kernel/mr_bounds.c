/* Checked computations at one state: parameters, inverse dynamics, its bounds, (12). */
#include "mr_internal.h"

#define DOUBLES(type) (sizeof(type) / sizeof(double))

enum { ARRAYS = 14 };

size_t mr_workspace_size(const mr_model *model) {
    const size_t j = (size_t)model->j, joints = mr_joint_stride(model);
    const size_t bodies = mr_body_stride(model);
    return 8 + joints * (MR_MOTION + 9 + 2 + ARRAYS) + bodies * (MR_BODY + MR_POINT) +
           j * (DOUBLES(mr_link) + DOUBLES(mr_wrench_box) + DOUBLES(mr_pose));
}

mr_workspace mr_workspace_view(const mr_model *model, double *memory) {
    const size_t j = (size_t)model->j, joints = mr_joint_stride(model);
    const size_t bodies = mr_body_stride(model);
    mr_workspace view;
    view.motion = mr_align(memory);
    view.axes = view.motion + joints * MR_MOTION;
    view.sines = view.axes + joints * 9;
    view.lo = view.sines + joints * 2;
    view.hi = view.lo + joints;
    view.mid = view.hi + joints;
    view.slack = view.mid + joints;
    view.dq_a = view.slack + joints;
    view.ddq_a = view.dq_a + joints;
    view.dq_a_size = view.ddq_a + joints;
    view.ddq_a_size = view.dq_a_size + joints;
    for (size_t k = 0; k < 6; ++k) view.full[k] = view.ddq_a_size + (k + 1) * joints;
    view.bodies = view.full[5] + joints;
    view.point = view.bodies + bodies * MR_BODY;
    view.links = (mr_link *)(view.point + bodies * MR_POINT);
    view.wrench.box = (mr_wrench_box *)(view.links + j);
    view.poses = (mr_pose *)(view.wrench.box + j);
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

/* Registers read some of the padding too: it holds zeros, so that nothing there is slow. */
static void clear_padding(const mr_model *model, const mr_workspace *ws) {
    const size_t stride = mr_joint_stride(model), j = (size_t)model->j;
    for (size_t i = j; i % MR_BLOCK; ++i) {
        ws->full[0][i] = 0.0;
        for (size_t k = 0; k < MR_MOTION; ++k) ws->motion[k * stride + i] = 0.0;
        for (size_t k = 0; k < 9; ++k) ws->axes[k * stride + i] = 0.0;
    }
}

mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const mr_state *given,
                        mr_state *state) {
    const int32_t n = model->n, j = model->j;
    if (!(mr_all_finite(n, given->q) & mr_all_finite(n, given->dq) &
          mr_all_finite(n, given->dq_a) & mr_all_finite(n, given->ddq_a)))
        return MR_NOT_FINITE;
    *state = *given;
    mr_expand_mimic(model, state, ws->full);
    if (j > n)
        for (int v = 0; v < 4; ++v)
            if (!mr_all_finite(j, ws->full[v])) return MR_NOT_FINITE;
    int beyond = 0;
    for (int32_t i = 0; i < j; ++i)
        beyond |= (model->joint_type[i] == MR_REVOLUTE) & (fabs(state->q[i]) > MR_ANGLE_MAX);
    if (beyond) return MR_ANGLE_RANGE;
    clear_padding(model, ws);
    return MR_OK;
}

static mr_status copy_finite(int32_t n, const double *from, double *to) {
    if (!mr_all_finite(n, from)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < n; ++i) to[i] = from[i];
    return MR_OK;
}

mr_status mr_do_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, int drives, double *workspace, double *tau) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    const mr_state given = {q, dq, dq_a, ddq_a, NULL, NULL};
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_point_of(model, parameters, ws.point);
    mr_newton_euler(model, ws.point, &state, &ws, ws.mid);
    if (drives) mr_add_drives(model, parameters, &state, ws.mid);
    mr_fold_mimic_torque(model, ws.mid);
    return copy_finite(model->n, ws.mid, tau);
}

mr_status mr_torque_with_error(const mr_model *model, const mr_parameters *parameters,
                               const mr_slack_factors *factors,
                               const mr_slack_constants *constants, const mr_state *given,
                               int drives, double *workspace, double *tau, double *error) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, given, &state);
    if (status) return status;
    mr_point_of(model, parameters, ws.point);
    mr_newton_euler(model, ws.point, &state, &ws, ws.mid);
    if (drives) mr_add_drives(model, parameters, &state, ws.mid);
    mr_fold_mimic_torque(model, ws.mid);
    const mr_motion_size size = mr_size_of_motion(model, &state, &ws);
    mr_rounding_slack(model, factors, constants, drives ? parameters : NULL, &state, &size,
                      ws.slack);
    if (!mr_all_finite(model->n, ws.mid)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.slack, error)) return MR_NOT_FINITE;
    return copy_finite(model->n, ws.mid, tau);
}

mr_status mr_do_inverse_dynamics_rounding(const mr_model *model, const mr_parameters *parameters,
                                          const double *q, const double *dq, const double *dq_a,
                                          const double *ddq_a, int drives, double *workspace,
                                          double *tau, double *error) {
    const mr_state given = {q, dq, dq_a, ddq_a, NULL, NULL};
    /* 12 doubles a joint: the torque needs no poses */
    double *work = (double *)mr_workspace_view(model, workspace).poses;
    mr_slack_constants *constants = (mr_slack_constants *)work;
    mr_slack_factors factors;
    mr_point_slack(model, parameters, work + model->j * DOUBLES(mr_slack_constants), &factors,
                   constants);
    return mr_torque_with_error(model, parameters, &factors, constants, &given, drives, workspace,
                                tau, error);
}

mr_status mr_do_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                        mr_method method, const double *q, const double *dq,
                                        const double *dq_a, const double *ddq_a, int drives,
                                        double *workspace, double *tau_lo, double *tau_hi) {
    if (!mr_is_sound(bounds)) return MR_NOT_FINITE;
    mr_workspace ws = mr_workspace_view(model, workspace);
    const mr_state given = {q, dq, dq_a, ddq_a, NULL, NULL};
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_torque_box(model, bounds, method, &state, drives, &ws);
    mr_total_bounds(model, method, &ws);
    if (!mr_all_finite(model->n, ws.lo)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.hi, tau_hi)) return MR_NOT_FINITE;
    return copy_finite(model->n, ws.lo, tau_lo);
}

mr_status mr_perturbation_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                              const mr_state *given, const mr_workspace *ws) {
    if (!mr_is_sound(bounds)) return MR_NOT_FINITE;
    mr_state state;
    const mr_status status = mr_full_state(model, ws, given, &state);
    if (status) return status;
    mr_torque_box(model, bounds, method, &state, 1, ws);
    for (int32_t i = 0; i < model->n; ++i) {
        const mr_interval d = {bounds->disturbance_lo[i], bounds->disturbance_hi[i]};
        mr_interval w = {ws->lo[i], ws->hi[i]};
        if (method == MR_IANEA) /* hull: already a difference, and the slack holds u0's rounding */
            w = mr_i_sub(w, (mr_interval){ws->mid[i], ws->mid[i]});
        else
            w = mr_i_widen(w, ws->slack[i]);
        w = mr_i_sub(w, d);
        ws->lo[i] = w.lo;
        ws->hi[i] = w.hi;
    }
    const int finite = mr_all_finite(model->n, ws->mid) & mr_all_finite(model->n, ws->lo) &
                       mr_all_finite(model->n, ws->hi);
    return finite ? MR_OK : MR_NOT_FINITE;
}

mr_status mr_do_perturbation_bounds(const mr_model *model, const mr_bounds *bounds,
                                    mr_method method, const mr_state *given, double *workspace,
                                    double *nominal, double *phi_lo, double *phi_hi) {
    const mr_workspace ws = mr_workspace_view(model, workspace);
    const mr_status status = mr_perturbation_box(model, bounds, method, given, &ws);
    if (status) return status;
    for (int32_t i = 0; i < model->n; ++i) {
        nominal[i] = ws.mid[i];
        phi_lo[i] = ws.lo[i];
        phi_hi[i] = ws.hi[i];
    }
    return MR_OK;
}

mr_status mr_do_bounds_slack(const mr_model *model, const mr_bounds *bounds, const double *q,
                             const double *dq, const double *dq_a, const double *ddq_a, int drives,
                             double *workspace, double *slack) {
    if (!mr_is_sound(bounds)) return MR_NOT_FINITE;
    mr_workspace ws = mr_workspace_view(model, workspace);
    const mr_state given = {q, dq, dq_a, ddq_a, NULL, NULL};
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, &given, &state);
    if (status) return status;
    mr_forward_recursion(model, &state, &ws);
    const mr_motion_size size = mr_size_of_motion(model, &state, &ws);
    mr_rounding_slack(model, mr_factors(bounds), mr_hull_slack_constants(model, bounds),
                      drives ? &bounds->upper : NULL, &state, &size, ws.slack);
    return copy_finite(model->n, ws.slack, slack);
}
