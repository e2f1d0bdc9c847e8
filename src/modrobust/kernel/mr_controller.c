/* Robust control laws: (3), (4), (7), (8) with the integrators of Section V, and (29). */
#include "mr_internal.h"

#define MR_TIME_ROUNDING 0x1p-50 /* how far time may seem to go back, relative to itself */

size_t mr_command_workspace_size(const mr_model *model) {
    const size_t j = (size_t)model->j;
    return mr_dynamics_workspace_size(model) + j * j + MR_COMMAND_ARRAYS * (size_t)model->n;
}

mr_status mr_elapsed(const mr_controller_state *state, double t, double *elapsed) {
    if (!isfinite(t)) return MR_NOT_FINITE;
    const double back = state->started > 0 ? state->previous_time - t : 0.0;
    if (back > MR_TIME_ROUNDING * fabs(state->previous_time)) return MR_TIME;
    *elapsed = back < 0.0 ? -back : 0.0;
    return MR_OK;
}

mr_state mr_auxiliary(const mr_model *model, const mr_gains *gains, const double *q,
                      const double *dq, const double *q_des, const double *dq_des,
                      const double *ddq_des, double *const a[4]) {
    for (int32_t i = 0; i < model->n; ++i) {
        const double q_term = gains->K_r[i] * (q_des[i] - q[i]);
        const double dq_term = gains->K_r[i] * (dq_des[i] - dq[i]);
        a[0][i] = dq_des[i] + q_term;
        a[1][i] = ddq_des[i] + dq_term;
        a[2][i] = fabs(dq_des[i]) + fabs(q_term);
        a[3][i] = fabs(ddq_des[i]) + fabs(dq_term);
    }
    if (model->wraps)
        for (int32_t i = 0; i < model->n; ++i) {
            if (!model->wraps[i]) continue;
            const mr_error error = mr_wrapped_error(q_des[i], q[i]);
            a[0][i] = dq_des[i] + gains->K_r[i] * error.e;
            a[2][i] = fabs(dq_des[i]) + fabs(gains->K_r[i] * error.size);
        }
    return (mr_state){q, dq, a[0], a[1], a[2], a[3]};
}

mr_state mr_state_of_law(const mr_model *model, const mr_gains *gains,
                         const mr_controller_state *state, double t, const double *q,
                         const double *dq, const double *q_des, const double *dq_des,
                         const double *ddq_des, double *const a[4]) {
    if (gains->law != MR_LAW_SAMPLED)
        return mr_auxiliary(model, gains, q, dq, q_des, dq_des, ddq_des, a);
    const size_t n = (size_t)model->n;
    mr_motion_ahead(model, gains, t - state->start_time, state->memory + MR_START * n,
                    state->memory + MR_START_RATE * n, q_des, dq_des, ddq_des, a[0], a[1], a[2]);
    return (mr_state){a[0], a[1], a[1], a[2], NULL, NULL};
}

double mr_worst_norm(int32_t n, const double *lo, const double *hi) {
    double squared = 0.0;
    for (int32_t i = 0; i < n; ++i) {
        const double rho = mr_worst_case(lo[i], hi[i]);
        squared += rho * rho;
    }
    /* rounded up, underflow of the squares included */
    return sqrt(squared + 0x1p-1000) * (1.0 + (n + 4) * 0x1p-52);
}

/* (29): v = (K^-1 + T M^-1)^-1 r by the solution of (K + M / T) x = M r / T, v = K x. K is in v. */
static mr_status allow_for_hold(const mr_model *model, const mr_gains *gains, const double *r,
                                double *workspace, double *v) {
    const int32_t n = model->n;
    double *M = workspace + mr_dynamics_workspace_size(model);
    double *x = M + (size_t)model->j * (size_t)model->j;
    /* between half a period and one and a half after the measurement where it acts a tick late */
    const double hold = gains->period * (1.0 + 2.0 * gains->delay);
    mr_mass_here(model, &gains->light, workspace, M);
    for (int32_t i = 0; i < n; ++i) {
        x[i] = 0.0;
        for (int32_t k = 0; k < n; ++k) {
            M[i * n + k] /= hold;
            x[i] += M[i * n + k] * r[k];
        }
    }
    for (int32_t i = 0; i < n; ++i) M[i * n + i] += v[i];
    const mr_status status = mr_cholesky_solve(n, M, x);
    if (status) return status;
    for (int32_t i = 0; i < n; ++i) v[i] *= x[i];
    return MR_OK;
}

/* kappa or phi, not above its ceiling where it has one. */
static double under(double value, double ceiling) {
    return ceiling > 0.0 && value > ceiling ? ceiling : value;
}

mr_status mr_do_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                        double t, const double *q, const double *dq, const double *q_des,
                        const double *dq_des, const double *ddq_des, double *workspace,
                        mr_controller_state *state, mr_command_out *out) {
    if (gains->law == MR_LAW_SAMPLED)
        return mr_sampled_command(model, bounds, gains, t, q, dq, q_des, dq_des, ddq_des,
                                  workspace, state, out);
    const int32_t n = model->n;
    const mr_workspace ws = mr_workspace_view(model, workspace);
    double error_squared = 0.0, elapsed = 0.0;
    mr_status status = mr_elapsed(state, t, &elapsed);
    if (status) return status; /* what is not finite in a signal is so in (4) too */

    double *const auxiliary[4] = {ws.dq_a, ws.ddq_a, ws.dq_a_size, ws.ddq_a_size};
    const mr_state given = mr_auxiliary(model, gains, q, dq, q_des, dq_des, ddq_des, auxiliary);
    for (int32_t i = 0; i < n; ++i) {
        const double error = mr_error_of(model, i, q_des, q);
        error_squared += error * error;
    }
    status = mr_perturbation_box(model, bounds, gains->method, &given, &ws);
    if (status) return status;
    if (mr_beyond_wrapping(model, q_des)) return MR_ANGLE_RANGE;
    const double error = sqrt(error_squared);
    const double rho_norm = mr_worst_norm(n, ws.lo, ws.hi);
    const double lost = gains->leak * elapsed;
    const double decayed = lost < 1.0 ? state->integral * (1.0 - lost) : 0.0;
    const double integral = decayed + state->previous_f * elapsed;
    const double kappa = under(gains->kappa_P + gains->kappa_I * integral, gains->kappa_max);
    const double phi = under(gains->phi_P + gains->phi_I * integral, gains->phi_max);
    const double gain = kappa * rho_norm + phi; /* (7) */
    if (!isfinite(gain) || !isfinite(error)) return MR_NOT_FINITE;
    double *r = ws.dq_a_size, *v = ws.ddq_a_size; /* of no more use */
    if (gains->law == MR_LAW_NORM && !gains->hold_aware) { /* in one go: the quickest law */
        for (int32_t i = 0; i < n; ++i) {
            v[i] = gain * (ws.dq_a[i] - dq[i]);
            if (!isfinite(ws.mid[i] + v[i])) return MR_NOT_FINITE;
        }
    } else {
        for (int32_t i = 0; i < n; ++i) {
            const double rho = mr_worst_case(ws.lo[i], ws.hi[i]);
            r[i] = ws.dq_a[i] - dq[i];
            v[i] = gains->law == MR_LAW_COMPONENTWISE ? kappa * rho + phi : gain;
            if (!gains->hold_aware) v[i] *= r[i];
        }
        status = gains->hold_aware ? allow_for_hold(model, gains, r, workspace, v) : MR_OK;
        if (status) return status;
        for (int32_t i = 0; i < n; ++i)
            if (!isfinite(ws.mid[i] + v[i])) return MR_NOT_FINITE;
    }

    for (int32_t i = 0; i < n; ++i) {
        out->rho[i] = mr_worst_case(ws.lo[i], ws.hi[i]);
        out->phi_lo[i] = ws.lo[i];
        out->phi_hi[i] = ws.hi[i];
        out->nominal[i] = ws.mid[i];
        out->v[i] = v[i];
        out->tau[i] = out->nominal[i] + out->v[i];
    }
    out->rho_norm = rho_norm;
    out->kappa = kappa;
    out->phi = phi;
    out->alpha = 1.0;
    state->integral = integral;
    state->previous_f = error < gains->epsilon ? 0.0 : error;
    if (!state->started || elapsed > 0.0) state->previous_time = t;
    if (!state->started) state->start_time = t;
    state->started = 1;
    return MR_OK;
}
