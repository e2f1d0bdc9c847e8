/* Robust control law (3), (4), (7), (8) with the integrators of Section V. */
#include "mr_internal.h"

#define MR_TIME_ROUNDING 0x1p-50 /* how far time may seem to go back, relative to itself */

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

mr_status mr_do_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                        double t, const double *q, const double *dq, const double *q_des,
                        const double *dq_des, const double *ddq_des, double *workspace,
                        mr_controller_state *state, mr_command_out *out) {
    const int32_t n = model->n;
    const mr_workspace ws = mr_workspace_view(model, workspace);
    double error_squared = 0.0, rho_squared = 0.0;
    if (!isfinite(t)) return MR_NOT_FINITE; /* what is not finite in a signal is so in (4) too */
    const double back = state->started ? state->previous_time - t : 0.0;
    if (back > MR_TIME_ROUNDING * fabs(state->previous_time)) return MR_TIME;

    double *const auxiliary[4] = {ws.dq_a, ws.ddq_a, ws.dq_a_size, ws.ddq_a_size};
    const mr_state given = mr_auxiliary(model, gains, q, dq, q_des, dq_des, ddq_des, auxiliary);
    for (int32_t i = 0; i < n; ++i) {
        const double error = mr_error_of(model, i, q_des, q);
        error_squared += error * error;
    }
    const mr_status status = mr_perturbation_box(model, bounds, gains->method, &given, &ws);
    if (status) return status;
    if (mr_beyond_wrapping(model, q_des)) return MR_ANGLE_RANGE;
    for (int32_t i = 0; i < n; ++i) { /* (8) */
        const double a = fabs(ws.lo[i]), b = fabs(ws.hi[i]), rho = a > b ? a : b;
        rho_squared += rho * rho;
    }
    const double error = sqrt(error_squared);
    /* rounded up, underflow of the squares included */
    const double rho_norm = sqrt(rho_squared + 0x1p-1000) * (1.0 + (n + 4) * 0x1p-52);
    const double elapsed = state->started && back < 0.0 ? -back : 0.0;
    const double integral = state->integral + state->previous_f * elapsed;
    const double kappa = gains->kappa_P + gains->kappa_I * integral;
    const double phi = gains->phi_P + gains->phi_I * integral;
    const double gain = kappa * rho_norm + phi; /* (7) */
    if (!isfinite(gain) || !isfinite(error)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < n; ++i)
        if (!isfinite(ws.mid[i] + gain * (ws.dq_a[i] - dq[i]))) return MR_NOT_FINITE;

    for (int32_t i = 0; i < n; ++i) {
        const double a = fabs(ws.lo[i]), b = fabs(ws.hi[i]);
        out->rho[i] = a > b ? a : b;
        out->phi_lo[i] = ws.lo[i];
        out->phi_hi[i] = ws.hi[i];
        out->nominal[i] = ws.mid[i];
        out->v[i] = gain * (ws.dq_a[i] - dq[i]); /* r = dq_a - dq */
        out->tau[i] = out->nominal[i] + out->v[i];
    }
    out->rho_norm = rho_norm;
    out->kappa = kappa;
    out->phi = phi;
    state->integral = integral;
    state->previous_f = error < gains->epsilon ? 0.0 : error;
    if (!state->started || back < 0.0) state->previous_time = t;
    state->started = 1;
    return MR_OK;
}
