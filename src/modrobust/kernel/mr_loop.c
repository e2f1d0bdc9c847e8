/* The closed loop of controller and plant, (23), and what is measured on it, (24). */
#include "mr_internal.h"

/* Memory of the loop beyond that of the dynamics, in arrays of n. */
/* clang-format off */
enum { TAU, NOMINAL, V, PHI_LO, PHI_HI, RHO, W, W_ERROR, SPARE_LO, SPARE_HI,
       DQ_A, DDQ_A, DQ_A_SIZE, DDQ_A_SIZE, /* as mr_auxiliary fills them */
       DRIVE, Q0, DQ0, Q1, DQ1, K_DQ, K_DDQ, SUM_DQ, SUM_DDQ, ARRAYS };
/* clang-format on */

size_t mr_loop_workspace_size(const mr_model *model) {
    return mr_dynamics_workspace_size(model) + (size_t)ARRAYS * (size_t)model->n +
           (size_t)model->j * sizeof(mr_slack_constants) / sizeof(double) + mr_slack_work(model);
}

/* One Runge-Kutta step of fourth order under a constant torque. */
static mr_status plant_step(const mr_model *model, const mr_parameters *parameters, double h,
                            double *workspace, double *const *a, double *q, double *dq) {
    static const double node[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const int32_t n = model->n;
    double *q0 = a[Q0], *dq0 = a[DQ0];
    double *q1 = a[Q1], *dq1 = a[DQ1];
    double *k_dq = a[K_DQ], *k_ddq = a[K_DDQ];
    double *sum_dq = a[SUM_DQ], *sum_ddq = a[SUM_DDQ];
    const double *drive = a[DRIVE];
    for (int32_t i = 0; i < n; ++i) {
        q0[i] = q[i];
        dq0[i] = dq[i];
        k_dq[i] = k_ddq[i] = sum_dq[i] = sum_ddq[i] = 0.0;
    }
    for (int stage = 0; stage < 4; ++stage) {
        for (int32_t i = 0; i < n; ++i) {
            q1[i] = q0[i] + node[stage] * h * k_dq[i];
            dq1[i] = dq0[i] + node[stage] * h * k_ddq[i];
        }
        const mr_status status =
            mr_do_forward_dynamics(model, parameters, q1, dq1, drive, 1, workspace, k_ddq);
        if (status) return status;
        for (int32_t i = 0; i < n; ++i) {
            k_dq[i] = dq1[i];
            sum_dq[i] += weight[stage] * k_dq[i];
            sum_ddq[i] += weight[stage] * k_ddq[i];
        }
    }
    for (int32_t i = 0; i < n; ++i) {
        q[i] = q0[i] + h / 6.0 * sum_dq[i];
        dq[i] = dq0[i] + h / 6.0 * sum_ddq[i];
    }
    return MR_OK;
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
    const double *disturbance;
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
        const double d = truth->disturbance[i];
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

mr_status mr_do_loop_advance(const mr_model *model, const mr_bounds *bounds, const mr_gains *gains,
                             const mr_parameters *true_parameters, const double *true_disturbance,
                             int32_t count, const double *q_des, const double *dq_des,
                             const double *ddq_des, int32_t log_every, double *workspace,
                             mr_controller_state *state, mr_loop *loop, mr_loop_log *log,
                             int32_t *logged) {
    const int32_t n = model->n;
    double *a[ARRAYS];
    for (int k = 0; k < ARRAYS; ++k)
        a[k] = workspace + mr_dynamics_workspace_size(model) + (size_t)k * (size_t)n;
    mr_command_out out = {a[TAU], a[NOMINAL], a[V], a[PHI_LO], a[PHI_HI], a[RHO], 0.0, 0.0, 0.0};
    double *work = a[ARRAYS - 1] + n;
    mr_slack_constants *constants = (mr_slack_constants *)(work + mr_slack_work(model));
    mr_truth truth = {true_parameters, true_disturbance, {0.0, 0.0}, constants};
    mr_point_slack(model, true_parameters, work, &truth.factors, constants);
    *logged = 0;
    for (int32_t k = 0; k < count; ++k) {
        const double t = (double)loop->ticks * loop->dt;
        const size_t row_start = (size_t)k * (size_t)n;
        const double *qd = q_des + row_start, *dqd = dq_des + row_start;
        const double *ddqd = ddq_des + row_start;
        const mr_controller_state before = *state;
        if (mr_do_command(model, bounds, gains, t, loop->q, loop->dq, qd, dqd, ddqd, workspace,
                          state, &out))
            return MR_DIVERGED;
        const mr_state at = mr_auxiliary(model, gains, loop->q, loop->dq, qd, dqd, ddqd, &a[DQ_A]);
        for (int32_t i = 0; i < n; ++i) a[DRIVE][i] = out.tau[i] + true_disturbance[i];
        const int keep = loop->ticks % log_every == 0;
        if (keep && log_widths(model, bounds, &at, workspace, a, *logged, log)) {
            *state = before;
            return MR_DIVERGED;
        }
        if (perturbation(model, &truth, &at, workspace, a, loop)) {
            *state = before;
            return MR_DIVERGED;
        }
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
            store(n, row, a[W], log->w);
            store(n, row, out.phi_lo, log->phi_lo);
            store(n, row, out.phi_hi, log->phi_hi);
            store(n, row, out.rho, log->rho);
            store(n, row, loop->total_variation, log->total_variation);
        }
        loop->ticks += 1;
        for (int32_t step = 0; step < loop->substeps; ++step)
            if (plant_step(model, true_parameters, loop->dt / loop->substeps, workspace, a,
                           loop->q, loop->dq))
                return MR_DIVERGED;
    }
    return MR_OK;
}
