/* Checked entries: parameters, inverse dynamics, its bounds and the perturbation set (12). */
#include "mr_internal.h"

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

int32_t mr_find_uncertain(int32_t b, const mr_parameters *lower, const mr_parameters *upper,
                          int32_t *uncertain) {
    int32_t count = 0;
    for (int32_t k = 0; k < b; ++k) {
        int exact = lower->mass[k] == upper->mass[k];
        for (int j = 0; j < 3; ++j) exact &= lower->com[3 * k + j] == upper->com[3 * k + j];
        for (int j = 0; j < 6; ++j) exact &= lower->inertia[6 * k + j] == upper->inertia[6 * k + j];
        if (!exact) uncertain[count++] = k;
    }
    return count;
}

static mr_status copy_finite(int32_t n, const double *from, double *to) {
    if (mr_check_vector(n, from)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < n; ++i) to[i] = from[i];
    return MR_OK;
}

mr_status mr_inverse_dynamics(const mr_model *model, const mr_parameters *parameters,
                              const double *q, const double *dq, const double *dq_a,
                              const double *ddq_a, int drives, double *workspace, double *tau) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_forward_recursion(model, &state, ws.links);
    mr_newton_euler(model, parameters, ws.links, ws.wrench.real, ws.mid);
    if (drives) mr_add_drives(model, parameters, state.dq, state.ddq_a, ws.mid);
    mr_lead(model, ws.mid);
    return copy_finite(model->n, ws.mid, tau);
}

/* ws.mid: nominal torque; ws.lo, ws.hi: bounds of the torque (ianea) or of its difference from
 * nominal (hull). */
static void torque_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                       const mr_state *state, int drives, mr_workspace *ws) {
    const double *dq = state->dq, *ddq_a = state->ddq_a;
    mr_newton_euler(model, &bounds->nominal, ws->links, ws->wrench.real, ws->mid);
    if (drives) mr_add_drives(model, &bounds->nominal, dq, ddq_a, ws->mid);
    if (method == MR_IANEA) {
        mr_ianea(model, &bounds->lower, &bounds->upper, ws->links, ws->wrench.box, ws->lo, ws->hi);
        if (drives) mr_add_drives_box(model, bounds, dq, ddq_a, ws->lo, ws->hi);
    } else {
        mr_hull_deviation(model, bounds, ws->links, ws->poses, ws->lo, ws->hi);
        if (drives) mr_add_drives_deviation(model, bounds, dq, ddq_a, ws->lo, ws->hi);
    }
    mr_lead(model, ws->mid);
    mr_lead_box(model, ws->lo, ws->hi);
}

mr_status mr_inverse_dynamics_bounds(const mr_model *model, const mr_bounds *bounds,
                                     mr_method method, const double *q, const double *dq,
                                     const double *dq_a, const double *ddq_a, int drives,
                                     double *workspace, double *tau_lo, double *tau_hi) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_forward_recursion(model, &state, ws.links);
    torque_box(model, bounds, method, &state, drives, &ws);
    if (method == MR_HULL) {
        for (int32_t i = 0; i < model->n; ++i) {
            ws.lo[i] += ws.mid[i];
            ws.hi[i] += ws.mid[i];
        }
    }
    if (mr_check_vector(model->n, ws.lo)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.hi, tau_hi)) return MR_NOT_FINITE;
    return copy_finite(model->n, ws.lo, tau_lo);
}

mr_status mr_perturbation_bounds(const mr_model *model, const mr_bounds *bounds, mr_method method,
                                 const double *q, const double *dq, const double *dq_a,
                                 const double *ddq_a, double *workspace, double *nominal,
                                 double *phi_lo, double *phi_hi) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, dq, dq_a, ddq_a, &state);
    if (status) return status;
    mr_forward_recursion(model, &state, ws.links);
    torque_box(model, bounds, method, &state, 1, &ws);
    for (int32_t i = 0; i < model->n; ++i) {
        const double u0 = method == MR_IANEA ? ws.mid[i] : 0.0;
        ws.lo[i] = ws.lo[i] - u0 - bounds->disturbance_hi[i];
        ws.hi[i] = ws.hi[i] - u0 - bounds->disturbance_lo[i];
    }
    if (mr_check_vector(model->n, ws.mid) || mr_check_vector(model->n, ws.lo)) return MR_NOT_FINITE;
    if (copy_finite(model->n, ws.hi, phi_hi)) return MR_NOT_FINITE;
    copy_finite(model->n, ws.mid, nominal);
    return copy_finite(model->n, ws.lo, phi_lo);
}
