/* Any robot, box and state through every entry of the kernel, under sanitizers.
 *
 * What must hold: a status or finite numbers; bounds in order; outputs and the controller's state
 * untouched on an error; rows of the batch equal to single calls; the torque at nominal, give or
 * take its rounding, inside both bounds. Run by test_kernel_fuzz.py and `make fuzz`. */
#include "kernel_input.h"

#include <stdio.h>

#define CHECK(condition)                                                            \
    do {                                                                            \
        if (!(condition)) {                                                         \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
            abort();                                                                \
        }                                                                           \
    } while (0)

enum { ROWS = 11, TICKS = 3 };
static const double UNTOUCHED = 12345.678;

static double *outputs(fuzz_case *c, size_t count) {
    double *x = allocate(c, count * sizeof *x);
    for (size_t i = 0; i < count; ++i) x[i] = UNTOUCHED;
    return x;
}

static double *memory(fuzz_case *c, size_t count) {
    double *x = allocate(c, count * sizeof *x);
    memset(x, 0xff, count * sizeof *x); /* not a number, until somebody writes to it */
    return x;
}

static int all_finite(size_t count, const double *x) {
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(x[i])) return 0;
    return 1;
}

/* Finite numbers, or a status and nothing written. */
static void check_output(mr_status status, size_t count, const double *x) {
    CHECK(status >= MR_OK && status <= MR_PLATFORM);
    for (size_t i = 0; i < count; ++i) CHECK(status ? x[i] == UNTOUCHED : isfinite(x[i]));
}

static void check_order(size_t count, const double *lo, const double *hi) {
    for (size_t i = 0; i < count; ++i) CHECK(lo[i] <= hi[i]);
}

static void check_torques(fuzz_case *c) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n;
    const mr_parameters *nominal = &c->bounds.nominal;
    double *tau = outputs(c, n), *again = outputs(c, n), *error = outputs(c, n);
    double *lo[2] = {outputs(c, n), outputs(c, n)}, *hi[2] = {outputs(c, n), outputs(c, n)};
    double *slack = outputs(c, n), *work = memory(c, mr_workspace_size(model));
    const mr_status plain =
        mr_inverse_dynamics(model, nominal, c->q, c->dq, c->dq_a, c->ddq_a, c->drives, work, tau);
    const mr_status rounded = mr_inverse_dynamics_rounding(
        model, nominal, c->q, c->dq, c->dq_a, c->ddq_a, c->drives, work, again, error);
    check_output(plain, n, tau);
    check_output(rounded, n, again);
    check_output(rounded, n, error);
    if (!rounded) CHECK(!plain && memcmp(tau, again, n * sizeof *tau) == 0);
    check_output(
        mr_bounds_slack(model, &c->bounds, c->q, c->dq, c->dq_a, c->ddq_a, c->drives, work, slack),
        n, slack);
    for (int m = MR_HULL; m <= MR_IANEA; ++m) {
        const mr_status status =
            mr_inverse_dynamics_bounds(model, &c->bounds, (mr_method)m, c->q, c->dq, c->dq_a,
                                       c->ddq_a, c->drives, work, lo[m], hi[m]);
        check_output(status, n, lo[m]);
        check_output(status, n, hi[m]);
        if (status) continue;
        check_order(n, lo[m], hi[m]);
        if (rounded || !c->usual) continue;
        for (size_t i = 0; i < n; ++i)
            CHECK(lo[m][i] <= tau[i] + error[i] && tau[i] - error[i] <= hi[m][i]);
    }
}

static void check_batch(fuzz_case *c) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n;
    double *lo = outputs(c, n), *hi = outputs(c, n), *work = memory(c, mr_workspace_size(model));
    double *los = outputs(c, ROWS * n), *his = outputs(c, ROWS * n);
    double *works = memory(c, mr_batch_workspace_size(model));
    const double *given[4] = {c->q, c->dq, c->dq_a, c->ddq_a};
    double *rows[4];
    for (int v = 0; v < 4; ++v) { /* row k is the state turned round by k joints */
        rows[v] = outputs(c, ROWS * n);
        for (size_t k = 0; k < ROWS; ++k)
            for (size_t i = 0; i < n; ++i) rows[v][k * n + i] = given[v][(i + k) % n];
    }
    for (int m = MR_HULL; m <= MR_IANEA; ++m) {
        int64_t row = -1;
        const mr_status whole = mr_inverse_dynamics_bounds_batch(
            model, &c->bounds, (mr_method)m, ROWS, rows[0], rows[1], rows[2], rows[3], c->drives,
            works, los, his, &row);
        CHECK(row >= 0 && row <= ROWS && (whole || row == ROWS));
        for (size_t k = 0; k < ROWS; ++k) {
            const mr_status status = mr_inverse_dynamics_bounds(
                model, &c->bounds, (mr_method)m, rows[0] + k * n, rows[1] + k * n, rows[2] + k * n,
                rows[3] + k * n, c->drives, work, lo, hi);
            if ((int64_t)k == row) CHECK(status == whole);
            if (whole) continue;
            CHECK(status == MR_OK);
            CHECK(memcmp(lo, los + k * n, n * sizeof *lo) == 0);
            CHECK(memcmp(hi, his + k * n, n * sizeof *hi) == 0);
        }
    }
}

static void check_plant(fuzz_case *c) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n, j = (size_t)model->j;
    const mr_parameters *nominal = &c->bounds.nominal;
    double *work = memory(c, mr_dynamics_workspace_size(model));
    double *M = outputs(c, n * n), *ddq = outputs(c, n);
    mr_transform *frames = allocate(c, j * sizeof *frames);
    check_output(mr_mass_matrix(model, nominal, c->q, c->drives, work, M), n * n, M);
    check_output(mr_forward_dynamics(model, nominal, c->q, c->dq, c->ddq_a, c->drives, work, ddq),
                 n, ddq);
    double *small = memory(c, mr_workspace_size(model));
    if (!mr_forward_kinematics(model, c->q, small, frames))
        for (size_t i = 0; i < j; ++i)
            CHECK(all_finite(9, frames[i].R) && all_finite(3, frames[i].p));
}

/* A few commands of one law: numbers and a state that moves on, or a status and nothing new. */
static void check_law(fuzz_case *c, mr_law law, double *work) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n, size = mr_controller_memory_size(model);
    double *kept = allocate(c, size * sizeof *kept);
    c->gains.law = law;
    mr_controller_state state = {.memory = memory(c, size)};
    for (int tick = 0; tick < TICKS; ++tick) {
        mr_command_out out = {.tau = outputs(c, n),
                              .nominal = outputs(c, n),
                              .v = outputs(c, n),
                              .phi_lo = outputs(c, n),
                              .phi_hi = outputs(c, n),
                              .rho = outputs(c, n),
                              .rho_norm = UNTOUCHED,
                              .kappa = UNTOUCHED,
                              .phi = UNTOUCHED,
                              .alpha = UNTOUCHED};
        const mr_controller_state before = state;
        memcpy(kept, state.memory, size * sizeof *kept);
        const mr_status status =
            mr_command(model, &c->bounds, &c->gains, c->t + tick * c->elapsed, c->q, c->dq,
                       c->q_des, c->dq_a, c->ddq_a, work, &state, &out);
        const double *const vectors[6] = {out.tau,    out.nominal, out.v,
                                          out.phi_lo, out.phi_hi,  out.rho};
        for (int k = 0; k < 6; ++k) check_output(status, n, vectors[k]);
        check_output(status, 1, &out.rho_norm);
        check_output(status, 1, &out.kappa);
        check_output(status, 1, &out.phi);
        check_output(status, 1, &out.alpha);
        if (status) {
            CHECK(memcmp(&before, &state, sizeof state) == 0);
            CHECK(memcmp(kept, state.memory, size * sizeof *kept) == 0);
            continue;
        }
        check_order(n, out.phi_lo, out.phi_hi);
        CHECK(out.alpha > 0.0 && out.alpha <= 1.0);
        if (law != MR_LAW_SAMPLED) continue;
        CHECK(all_finite(size, state.memory));
        if (!c->gains.integral) continue;
        for (size_t i = 0; i < n; ++i) /* sigma, which comes first */
            CHECK(out.phi_lo[i] <= state.memory[i] && state.memory[i] <= out.phi_hi[i]);
    }
}

static void check_commands(fuzz_case *c) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n;
    double *work = memory(c, mr_workspace_size(model)), *u0 = outputs(c, n);
    double *more = memory(c, mr_command_workspace_size(model));
    for (int m = MR_HULL; m <= MR_IANEA; ++m) {
        double *lo = outputs(c, n), *hi = outputs(c, n);
        const mr_status set = mr_perturbation_bounds(model, &c->bounds, (mr_method)m, c->q, c->dq,
                                                     c->dq_a, c->ddq_a, work, u0, lo, hi);
        check_output(set, n, lo);
        check_output(set, n, hi);
        if (!set) check_order(n, lo, hi);
        c->gains.method = (mr_method)m;
        for (int law = MR_LAW_NORM; law <= MR_LAW_SAMPLED; ++law) check_law(c, (mr_law)law, more);
    }
}

/* The loop of one law with the plant, the sensor and the disturbance of the input. */
static void check_loop(fuzz_case *c, mr_law law) {
    const mr_model *model = &c->model;
    const size_t n = (size_t)model->n;
    double *work = memory(c, mr_loop_workspace_size(model));
    double *reference[3] = {outputs(c, TICKS * n), outputs(c, TICKS * n), outputs(c, TICKS * n)};
    double *rows[15], *own[8];
    for (int k = 0; k < 15; ++k) rows[k] = outputs(c, TICKS * (k ? n : 1));
    for (int k = 0; k < 8; ++k) own[k] = memset(outputs(c, n), 0, n * sizeof(double));
    for (size_t k = 0; k < TICKS * n; ++k) {
        reference[0][k] = c->q_des[k % n];
        reference[1][k] = c->dq_a[k % n];
        reference[2][k] = c->ddq_a[k % n];
    }
    memcpy(own[0], c->q, n * sizeof(double));
    memcpy(own[1], c->dq, n * sizeof(double));
    c->gains.law = law;
    mr_loop loop = {.dt = c->elapsed,
                    .substeps = 2,
                    .implicit = c->implicit,
                    .delay = c->late,
                    .saturation = c->saturation,
                    .sensor = c->sensor,
                    .disturbance = c->disturbance,
                    .q = own[0],
                    .dq = own[1],
                    .tau_previous = own[2],
                    .tau_max = own[3],
                    .total_variation = own[4],
                    .ticks_at_limit = own[5]};
    loop.sensor.previous_q = own[6];
    loop.sensor.rate = own[7];
    mr_loop_log log = {rows[0], rows[1], rows[2],  rows[3],  rows[4],  rows[5],  rows[6], rows[7],
                       rows[8], rows[9], rows[10], rows[11], rows[12], rows[13], rows[14]};
    mr_controller_state state = {.memory = memory(c, mr_controller_memory_size(model))};
    int32_t logged = -1;
    const mr_status status =
        mr_loop_advance(model, &c->bounds, &c->gains, &c->bounds.nominal, TICKS, reference[0],
                        reference[1], reference[2], 1, work, &state, &loop, &log, &logged);
    CHECK(logged >= 0 && logged <= TICKS && loop.ticks >= 0 && loop.ticks <= TICKS);
    CHECK(status || loop.ticks == TICKS);
    CHECK(loop.limited >= 0 && loop.limited <= loop.ticks);
    for (int k = 0; k < 15; ++k) CHECK(all_finite((size_t)logged * (k ? n : 1), rows[k]));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_case c;
    take_case(&c, data, size);
    check_torques(&c);
    check_batch(&c);
    check_plant(&c);
    check_commands(&c);
    for (int law = MR_LAW_NORM; law <= MR_LAW_SAMPLED; ++law) check_loop(&c, (mr_law)law);
    release(&c);
    return 0;
}
