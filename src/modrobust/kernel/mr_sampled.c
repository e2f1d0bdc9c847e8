/* The law `sampled`, made for a command that is held and comes late: (31) to (34). */
#include "mr_internal.h"

#define MR_LEAST_SHARE 0.02 /* of the feedback, however little room the limits leave */

size_t mr_controller_memory_size(const mr_model *model) { return MR_MEMORY * (size_t)model->n; }

/* The way from the state at the start to the motion, (34): a quintic with the offsets o and do at
 * 0 and none at `blend`. Adds position, velocity and acceleration; any of them may be NULL. */
static void add_blend(int32_t n, double blend, double since_start, const double *o,
                      const double *d_o, double *q, double *dq, double *ddq) {
    const double x = since_start / blend;
    if (!(x < 1.0)) return; /* done, or no blend at all */
    const double xx = x * x, xxx = xx * x;
    const double h0 = 1.0 - xxx * (10.0 - x * (15.0 - 6.0 * x));
    const double h1 = x - xxx * (6.0 - x * (8.0 - 3.0 * x));
    const double d_h0 = -30.0 * xx * (1.0 - x * (2.0 - x));
    const double d_h1 = 1.0 - xx * (18.0 - x * (32.0 - 15.0 * x));
    const double dd_h0 = -60.0 * x * (1.0 - x * (3.0 - 2.0 * x));
    const double dd_h1 = -x * (36.0 - x * (96.0 - 60.0 * x));
    for (int32_t i = 0; i < n; ++i) {
        q[i] += o[i] * h0 + d_o[i] * blend * h1;
        dq[i] += o[i] * d_h0 / blend + d_o[i] * d_h1;
        if (ddq) ddq[i] += o[i] * dd_h0 / (blend * blend) + d_o[i] * dd_h1 / blend;
    }
}

void mr_motion_ahead(const mr_model *model, const mr_gains *gains, double since_start,
                     const double *start, const double *start_rate, const double *q_des,
                     const double *dq_des, const double *ddq_des, double *q, double *dq,
                     double *ddq) {
    const double ahead = (gains->delay + 0.5) * gains->period;
    for (int32_t i = 0; i < model->n; ++i) {
        q[i] = q_des[i] + ahead * (dq_des[i] + 0.5 * ahead * ddq_des[i]);
        dq[i] = dq_des[i] + ahead * ddq_des[i];
        ddq[i] = ddq_des[i];
    }
    add_blend(model->n, gains->blend, since_start + ahead, start, start_rate, q, dq, ddq);
}

/* NE at D_c and [Phi] about it, (32) and (12): ws->lo, ws->hi, and `nominal`. */
static mr_status feed_forward(const mr_model *model, const mr_bounds *bounds,
                              const mr_gains *gains, const mr_state *given, double *workspace,
                              double *nominal) {
    const mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    if (!mr_is_sound(bounds)) return MR_NOT_FINITE;
    const mr_status status = mr_full_state(model, &ws, given, &state);
    if (status) return status;
    mr_torque_box(model, bounds, gains->method, &state, 1, &ws);
    mr_total_bounds(model, gains->method, &ws);
    mr_point_of(model, &gains->centre, ws.point); /* the links move as they did for the box */
    mr_body_pass(model, ws.point, &ws);
    mr_backward_recursion(model, &ws, ws.mid);
    mr_add_drives(model, &gains->centre, &state, ws.mid);
    mr_fold_mimic_torque(model, ws.mid);
    for (int32_t i = 0; i < model->n; ++i) nominal[i] = ws.mid[i];
    for (int32_t i = 0; i < model->n; ++i) {
        const mr_interval d = {bounds->disturbance_lo[i], bounds->disturbance_hi[i]};
        const mr_interval tau = {ws.lo[i], ws.hi[i]}, u0 = {nominal[i], nominal[i]};
        const mr_interval w = mr_i_sub(mr_i_sub(tau, u0), d);
        ws.lo[i] = w.lo;
        ws.hi[i] = w.hi;
    }
    const int finite = mr_all_finite(model->n, nominal) & mr_all_finite(model->n, ws.lo) &
                       mr_all_finite(model->n, ws.hi);
    return finite ? MR_OK : MR_NOT_FINITE;
}

static void times(int32_t n, const double *M, const double *x, double *y) {
    for (int32_t i = 0; i < n; ++i) {
        y[i] = 0.0;
        for (int32_t k = 0; k < n; ++k) y[i] += M[i * n + k] * x[k];
    }
}

/* Whether a measured angle is beyond what can be reduced; the dynamics are not asked about it. */
static int beyond_range(const mr_model *model, const double *q) {
    int beyond = 0;
    for (int32_t i = 0; i < model->n; ++i) {
        const int32_t joint = model->j > model->n ? model->moves[i] : i;
        beyond |= (model->joint_type[joint] == MR_REVOLUTE) & (fabs(q[i]) > MR_ANGLE_MAX);
    }
    return beyond;
}

static double limited(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

/* alpha of (32): the largest share of the feedback for which every torque has room. */
static double share_with_room(int32_t n, const double *limit, const double *base,
                              const double *feedback) {
    double share = 1.0;
    for (int32_t i = 0; i < n; ++i) {
        const double size = fabs(feedback[i]);
        const double room = limit[i] - (feedback[i] > 0.0 ? base[i] : -base[i]);
        if (size > 0.0 && size * share > room) share = room > 0.0 ? room / size : 0.0;
    }
    return share > MR_LEAST_SHARE ? share : MR_LEAST_SHARE;
}

mr_status mr_sampled_command(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             double t, const double *q, const double *dq, const double *q_des,
                             const double *dq_des, const double *ddq_des, double *workspace,
                             mr_controller_state *state, mr_command_out *out) {
    const int32_t n = model->n;
    const size_t rows = (size_t)n, joints = (size_t)model->j;
    const mr_workspace ws = mr_workspace_view(model, workspace);
    double *M = workspace + mr_dynamics_workspace_size(model), *a[MR_COMMAND_ARRAYS];
    for (size_t k = 0; k < MR_COMMAND_ARRAYS; ++k) a[k] = M + joints * joints + k * rows;
    double *e = a[MR_ERROR], *de = a[MR_RATE], *nominal = a[MR_NOMINAL];
    double *feedback = a[MR_FEEDBACK], *pull = a[MR_PULL], *acceleration = a[MR_ACCELERATION];
    double *start = a[MR_OFFSET], *start_rate = a[MR_OFFSET_RATE], *memory = state->memory;
    double elapsed = 0.0;
    mr_status status = mr_elapsed(state, t, &elapsed);
    if (status) return status;
    if (!(mr_all_finite(n, q) & mr_all_finite(n, dq) & mr_all_finite(n, q_des) &
          mr_all_finite(n, dq_des) & mr_all_finite(n, ddq_des)))
        return MR_NOT_FINITE;
    if (mr_beyond_wrapping(model, q_des) | beyond_range(model, q)) return MR_ANGLE_RANGE;
    const int started = state->started > 0;
    const double *from = state->started < 0 ? memory + MR_START * rows : q;
    for (int32_t i = 0; i < n; ++i) {
        e[i] = mr_error_of(model, i, q_des, q);
        de[i] = dq_des[i] - dq[i];
        start[i] =
            started ? memory[MR_START * rows + (size_t)i] : -mr_error_of(model, i, q_des, from);
        start_rate[i] = started ? memory[MR_START_RATE * rows + (size_t)i] : -de[i];
    }
    const double since_start = started ? t - state->start_time : 0.0;
    add_blend(n, gains->blend, since_start, start, start_rate, e, de, NULL);
    if (gains->predictor && started) { /* (31) */
        const double lag = gains->delay * gains->period;
        for (int32_t i = 0; i < n; ++i) {
            const double past = memory[MR_PAST * rows + (size_t)i];
            e[i] += lag * (de[i] - 0.5 * lag * past);
            de[i] -= lag * past;
        }
    }
    double *ahead[3] = {a[MR_AHEAD_Q], a[MR_AHEAD_DQ], a[MR_AHEAD_DDQ]};
    mr_motion_ahead(model, gains, since_start, start, start_rate, q_des, dq_des, ddq_des, ahead[0],
                    ahead[1], ahead[2]);
    const mr_state at = {ahead[0], ahead[1], ahead[1], ahead[2], NULL, NULL};
    status = feed_forward(model, bounds, gains, &at, workspace, nominal);
    if (status) return status;

    mr_mass_here(model, &gains->light, workspace, M);
    double *r = acceleration, *y = e; /* of no more use */
    for (int32_t i = 0; i < n; ++i) {
        r[i] = de[i] + gains->Lambda * e[i];
        y[i] = gains->G * r[i] + gains->Lambda * de[i];
    }
    times(n, M, r, pull);
    times(n, M, y, feedback);

    double *sigma = y, *base = de;
    for (int32_t i = 0; i < n; ++i) {
        sigma[i] = started && gains->integral ? memory[MR_SIGMA * rows + (size_t)i] : 0.0;
        base[i] = nominal[i] + sigma[i];
    }
    const double alpha =
        gains->vector_saturation ? share_with_room(n, gains->effort_limit, base, feedback) : 1.0;
    for (int32_t i = 0; i < n; ++i) {
        if (gains->integral) { /* (33) */
            if (alpha == 1.0) sigma[i] += gains->period * gains->L_i * pull[i];
            sigma[i] = limited(sigma[i], ws.lo[i], ws.hi[i]);
        }
        feedback[i] *= alpha;
        acceleration[i] = feedback[i];
    }
    if (gains->predictor && gains->delay > 0.0) {
        mr_mass_here(model, &gains->centre, workspace, M);
        status = mr_cholesky_solve(n, M, acceleration);
        if (status) return status;
    }
    for (int32_t i = 0; i < n; ++i) {
        if (!isfinite(nominal[i] + (feedback[i] + sigma[i])) || !isfinite(acceleration[i]))
            return MR_NOT_FINITE;
    }
    const double rho_norm = mr_worst_norm(n, ws.lo, ws.hi);
    if (!isfinite(rho_norm)) return MR_NOT_FINITE;

    for (int32_t i = 0; i < n; ++i) {
        out->rho[i] = mr_worst_case(ws.lo[i], ws.hi[i]);
        out->phi_lo[i] = ws.lo[i];
        out->phi_hi[i] = ws.hi[i];
        out->nominal[i] = nominal[i];
        out->v[i] = feedback[i] + sigma[i];
        out->tau[i] = nominal[i] + out->v[i];
        if (gains->vector_saturation)
            out->tau[i] = limited(out->tau[i], -gains->effort_limit[i], gains->effort_limit[i]);
        memory[MR_SIGMA * rows + (size_t)i] = sigma[i];
        memory[MR_PAST * rows + (size_t)i] = acceleration[i];
        memory[MR_START * rows + (size_t)i] = start[i];
        memory[MR_START_RATE * rows + (size_t)i] = start_rate[i];
    }
    out->rho_norm = rho_norm;
    out->kappa = out->phi = 0.0;
    out->alpha = alpha;
    state->integral = state->previous_f = 0.0;
    if (!started || elapsed > 0.0) state->previous_time = t;
    if (!started) state->start_time = t;
    state->started = 1;
    return MR_OK;
}
