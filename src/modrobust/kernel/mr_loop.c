/* The closed loop of controller and plant, (23), and what is measured on it, (24). */
#include "mr_internal.h"

/* Memory of the loop beyond that of the command, in arrays of n. */
/* clang-format off */
enum { TAU, NOMINAL, V, PHI_LO, PHI_HI, RHO, W, W_ERROR, SPARE_LO, SPARE_HI,
       DQ_A, DDQ_A, DQ_A_SIZE, DDQ_A_SIZE, /* as mr_state_of_law fills them */
       Q_SEEN, DQ_SEEN, R, D, DRIVE, ARRAYS };
/* clang-format on */

size_t mr_loop_workspace_size(const mr_model *model) {
    return mr_command_workspace_size(model) + ARRAYS * (size_t)model->n +
           mr_plant_memory_size(model) + mr_controller_memory_size(model) +
           (size_t)model->j * sizeof(mr_slack_constants) / sizeof(double) + mr_slack_work(model);
}

static void store(int32_t n, int32_t row, const double *from, double *to) {
    for (int32_t i = 0; i < n; ++i) to[(size_t)row * (size_t)n + (size_t)i] = from[i];
}

static mr_status log_widths(const mr_model *model, const mr_bounds *bounds, const mr_state *at,
                            double *workspace, double *const *a, int32_t row, mr_loop_log *log) {
    static const mr_method method[2] = {MR_HULL, MR_IANEA};
    const int32_t n = model->n;
    double *const width[2] = {log->width_hull, log->width_ianea};
    double *lo = a[SPARE_LO], *hi = a[SPARE_HI];
    for (int k = 0; k < 2; ++k) {
        const mr_status status =
            mr_do_perturbation_bounds(model, bounds, method[k], at, workspace, a[W], lo, hi);
        if (status) return status;
        for (int32_t i = 0; i < n; ++i) hi[i] -= lo[i];
        store(n, row, hi, width[k]);
    }
    return MR_OK;
}

/* The robot as it is, and what rounding may change in its torque. */
typedef struct {
    const mr_parameters *parameters;
    mr_slack_factors factors;
    const mr_slack_constants *constants;
} mr_truth;

/* w of (6) by the true parameters, and whether it left [Phi], (24). */
static mr_status perturbation(const mr_model *model, const mr_truth *truth, const mr_state *at,
                              double *workspace, double *const *a, mr_loop *loop) {
    const int32_t n = model->n;
    double *w = a[W];
    const double *nominal = a[NOMINAL], *error = a[W_ERROR];
    const double *lo = a[PHI_LO], *hi = a[PHI_HI];
    double largest = 0.0;
    const mr_status status =
        mr_torque_with_error(model, truth->parameters, &truth->factors, truth->constants, at, 1,
                             workspace, w, a[W_ERROR]);
    if (status) return status;
    for (int32_t i = 0; i < n; ++i) {
        const double d = a[D][i];
        const double rounding = error[i] + 0x1p-52 * (fabs(w[i]) + fabs(nominal[i]) + fabs(d));
        w[i] = w[i] - nominal[i] - d;
        const double below = lo[i] - w[i], above = w[i] - hi[i];
        const double excess = (below > above ? below : above) - rounding;
        if (excess > largest) largest = excess;
    }
    if (largest > 0.0) {
        loop->violations += 1;
        if (largest > loop->violation_max) loop->violation_max = largest;
    }
    return MR_OK;
}

static void measure(const mr_model *model, const mr_gains *gains, double t, const double *q_des,
                    const double *tau, double rho_norm, mr_loop *loop) {
    double error = 0.0;
    for (int32_t i = 0; i < model->n; ++i) {
        const double e = mr_error_of(model, i, q_des, loop->q), size = fabs(tau[i]);
        error += e * e;
        if (loop->ticks > 0) loop->total_variation[i] += fabs(tau[i] - loop->tau_previous[i]);
        loop->tau_previous[i] = tau[i];
        if (size > loop->tau_max[i]) loop->tau_max[i] = size;
    }
    loop->error_last = sqrt(error);
    if (loop->error_last >= gains->epsilon) {
        loop->last_outside = t;
        loop->error_max_after = 0.0;
    } else if (loop->error_last > loop->error_max_after) {
        loop->error_max_after = loop->error_last;
    }
    loop->rho_sum += rho_norm;
    if (rho_norm > loop->rho_max) loop->rho_max = rho_norm;
}

/* r of (5), of the true state and the desired motion at the beginning of the tick. */
static void sliding_error(const mr_model *model, const mr_gains *gains, const mr_loop *loop,
                          const double *q_des, const double *dq_des, double *r) {
    for (int32_t i = 0; i < model->n; ++i) {
        const double gain = gains->law == MR_LAW_SAMPLED ? gains->Lambda : gains->K_r[i];
        r[i] = dq_des[i] - loop->dq[i] + gain * mr_error_of(model, i, q_des, loop->q);
    }
}

/* Cuts the command where the drive does, and counts what either of them has cut. */
static void saturate(const mr_model *model, const mr_gains *gains, double alpha, double *tau,
                     mr_loop *loop) {
    int limited = alpha < 1.0;
    for (int32_t i = 0; i < model->n; ++i) {
        const double limit = gains->effort_limit ? gains->effort_limit[i] : HUGE_VAL;
        if (!(fabs(tau[i]) >= limit)) continue;
        if (loop->saturation) tau[i] = copysign(limit, tau[i]);
        if (!loop->saturation && !gains->vector_saturation) continue; /* beyond it, but not cut */
        loop->ticks_at_limit[i] += 1.0;
        limited = 1;
    }
    loop->limited += limited;
}

/* The plant over one part of a tick under the torque `tau`. */
static mr_status move(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                      const mr_parameters *parameters, const double *tau, double span,
                      int32_t steps, double since_tick, const double *q_des, const double *dq_des,
                      const double *ddq_des, double *workspace, double *const *a, mr_loop *loop) {
    const int32_t n = model->n;
    double *memory = a[ARRAYS - 1] + n, *drive = a[DRIVE];
    const double h = span / steps;
    for (int32_t step = 0; step < steps; ++step) {
        if (loop->disturbance.kind == MR_WORST) {
            const double s = since_tick + step * h; /* the motion goes on within the tick */
            for (int32_t i = 0; i < n; ++i) {
                a[SPARE_LO][i] = q_des[i] + s * (dq_des[i] + 0.5 * s * ddq_des[i]);
                a[SPARE_HI][i] = dq_des[i] + s * ddq_des[i];
            }
            sliding_error(model, gains, loop, a[SPARE_LO], a[SPARE_HI], a[R]);
            mr_push_away(bounds, n, a[R], a[D]);
        }
        for (int32_t i = 0; i < n; ++i) drive[i] = tau[i] + a[D][i];
        const mr_status status =
            loop->plant      ? loop->plant(loop->context, h, drive, loop->q, loop->dq)
            : loop->implicit ? mr_implicit_step(model, parameters, h, drive, workspace, memory,
                                                loop->q, loop->dq)
                             : mr_explicit_step(model, parameters, h, drive, workspace, memory,
                                                loop->q, loop->dq);
        if (status) return status;
    }
    return MR_OK;
}

static int32_t steps_of(double share, int32_t substeps) {
    const double steps = ceil(share * substeps);
    return steps < 1.0 ? 1 : (int32_t)steps;
}

mr_status mr_do_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             const mr_parameters *true_parameters, int32_t count,
                             const double *q_des, const double *dq_des, const double *ddq_des,
                             int32_t log_every, double *workspace, mr_controller_state *state,
                             mr_loop *loop, mr_loop_log *log, int32_t *logged) {
    const int32_t n = model->n;
    const size_t memory_size = state->memory ? mr_controller_memory_size(model) : 0;
    double *a[ARRAYS];
    for (int k = 0; k < ARRAYS; ++k)
        a[k] = workspace + mr_command_workspace_size(model) + (size_t)k * (size_t)n;
    mr_command_out out = {a[TAU], a[NOMINAL], a[V], a[PHI_LO], a[PHI_HI],
                          a[RHO], 0.0,        0.0,  0.0,       1.0};
    double *kept = a[ARRAYS - 1] + n + mr_plant_memory_size(model);
    double *work = kept + mr_controller_memory_size(model);
    mr_slack_constants *constants = (mr_slack_constants *)(work + mr_slack_work(model));
    mr_truth truth = {true_parameters, {0.0, 0.0}, constants};
    mr_point_slack(model, true_parameters, work, &truth.factors, constants);
    *logged = 0;
    for (int32_t k = 0; k < count; ++k) {
        const double t = (double)loop->ticks * loop->dt;
        const size_t row_start = (size_t)k * (size_t)n;
        const double *qd = q_des + row_start, *dqd = dq_des + row_start;
        const double *ddqd = ddq_des + row_start;
        const mr_controller_state before = *state;
        for (size_t i = 0; i < memory_size; ++i) kept[i] = state->memory[i];
        sliding_error(model, gains, loop, qd, dqd, a[R]);
        mr_sense(n, &loop->sensor, loop->dt, a[R], loop->q, loop->dq, a[Q_SEEN], a[DQ_SEEN]);
        if (mr_do_command(model, bounds, gains, t, a[Q_SEEN], a[DQ_SEEN], qd, dqd, ddqd, workspace,
                          state, &out))
            return MR_DIVERGED;
        const mr_state at = mr_state_of_law(model, gains, state, t, a[Q_SEEN], a[DQ_SEEN], qd, dqd,
                                            ddqd, &a[DQ_A]);
        mr_draw_disturbance(bounds, n, &loop->disturbance, t, a[D]);
        if (loop->disturbance.kind == MR_WORST) mr_push_away(bounds, n, a[R], a[D]);
        const int keep = loop->ticks % log_every == 0;
        if ((keep && log_widths(model, bounds, &at, workspace, a, *logged, log)) ||
            perturbation(model, &truth, &at, workspace, a, loop)) {
            *state = before;
            for (size_t i = 0; i < memory_size; ++i) state->memory[i] = kept[i];
            return MR_DIVERGED;
        }
        saturate(model, gains, out.alpha, out.tau, loop);
        double *acting = a[V]; /* until this command does; the first stands from the beginning */
        for (int32_t i = 0; i < n; ++i)
            acting[i] = loop->ticks > 0 ? loop->tau_previous[i] : out.tau[i];
        measure(model, gains, t, qd, out.tau, out.rho_norm, loop);
        if (keep) {
            const int32_t row = (*logged)++;
            log->t[row] = t;
            store(n, row, loop->q, log->q);
            store(n, row, loop->dq, log->dq);
            store(n, row, qd, log->q_des);
            store(n, row, dqd, log->dq_des);
            store(n, row, ddqd, log->ddq_des);
            store(n, row, out.tau, log->tau);
            store(n, row, out.nominal, log->nominal);
            store(n, row, a[W], log->w);
            store(n, row, out.phi_lo, log->phi_lo);
            store(n, row, out.phi_hi, log->phi_hi);
            store(n, row, out.rho, log->rho);
            store(n, row, loop->total_variation, log->total_variation);
        }
        loop->ticks += 1;
        const double late = loop->delay * loop->dt;
        mr_status status = MR_OK;
        if (loop->delay > 0.0)
            status = move(model, bounds, gains, true_parameters, acting, late,
                          steps_of(loop->delay, loop->substeps), 0.0, qd, dqd, ddqd, workspace, a,
                          loop);
        if (!status && loop->delay < 1.0)
            status = move(model, bounds, gains, true_parameters, out.tau, loop->dt - late,
                          steps_of(1.0 - loop->delay, loop->substeps), late, qd, dqd, ddqd,
                          workspace, a, loop);
        if (status) return MR_DIVERGED;
    }
    return MR_OK;
}
