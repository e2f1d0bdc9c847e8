/* The plant (23) between two commands, how it is measured and what disturbs it, (28). */
#include "mr_internal.h"

/* xorshift128+ of Vigna: a number in [-1, 1). */
static double drawn(uint64_t s[2]) {
    uint64_t a = s[0];
    const uint64_t b = s[1];
    s[0] = b;
    a ^= a << 23;
    s[1] = a ^ b ^ (a >> 17) ^ (b >> 26);
    return (double)((s[1] + b) >> 11) * 0x1p-52 - 1.0;
}

static double to_step(double x, double step) {
    return step > 0.0 ? step * floor(x / step + 0.5) : x;
}

/* What the sensor says of x; a positive r is hidden by an x that looks larger. */
static double sensed(mr_sensor *sensor, const double *noise, const double *step, int32_t i,
                     double x, double r) {
    if (noise) {
        const double sign = r > 0.0 ? 1.0 : r < 0.0 ? -1.0 : 0.0;
        x += noise[i] * (sensor->worst ? sign : drawn(sensor->random));
    }
    return step ? to_step(x, step[i]) : x;
}

void mr_sense(int32_t n, mr_sensor *sensor, double dt, const double *r, const double *q,
              const double *dq, double *q_seen, double *dq_seen) {
    for (int32_t i = 0; i < n; ++i)
        q_seen[i] = sensed(sensor, sensor->noise_q, sensor->step_q, i, q[i], r[i]);
    for (int32_t i = 0; i < n; ++i) {
        if (sensor->filter > 0.0) {
            if (!sensor->started) {
                sensor->rate[i] = dq[i];
            } else {
                const double slope = (q_seen[i] - sensor->previous_q[i]) / dt;
                sensor->rate[i] += sensor->filter * (slope - sensor->rate[i]);
            }
            sensor->previous_q[i] = q_seen[i];
            dq_seen[i] = sensor->rate[i];
        } else {
            dq_seen[i] = sensed(sensor, sensor->noise_dq, sensor->step_dq, i, dq[i], r[i]);
        }
    }
    sensor->started = 1;
}

void mr_draw_disturbance(const mr_bounds *bounds, int32_t n, mr_disturbance *disturbance, double t,
                         double *d) {
    const double *lo = bounds->disturbance_lo, *hi = bounds->disturbance_hi;
    for (int32_t i = 0; i < n; ++i) {
        const double middle = 0.5 * (lo[i] + hi[i]), radius = 0.5 * (hi[i] - lo[i]);
        double share = 0.0;
        if (disturbance->kind == MR_CONSTANT || disturbance->kind == MR_WORST) {
            d[i] = disturbance->constant[i];
            continue;
        }
        if (disturbance->kind == MR_RANDOM) {
            share = drawn(disturbance->random);
        } else { /* the joints out of step, by the golden section of a turn */
            double cosine, turns = disturbance->frequency * t + 0.6180339887498949 * (i + 1);
            turns -= floor(turns);
            mr_do_sincos(6.283185307179586 * turns, &share, &cosine);
        }
        const double at = middle + radius * share;
        d[i] = at < lo[i] ? lo[i] : at > hi[i] ? hi[i] : at;
    }
}

void mr_push_away(const mr_bounds *bounds, int32_t n, const double *r, double *d) {
    for (int32_t i = 0; i < n; ++i)
        if (r[i] != 0.0) d[i] = r[i] > 0.0 ? bounds->disturbance_lo[i] : bounds->disturbance_hi[i];
}

/* Memory of a step, in arrays of n. */
enum { Q0, DQ0, Q1, DQ1, K_DQ, K_DDQ, SUM_DQ, SUM_DDQ, FAST, ARRAYS };

size_t mr_plant_memory_size(const mr_model *model) {
    return ARRAYS * (size_t)model->n + 2 * (size_t)model->j * (size_t)model->j;
}

mr_status mr_explicit_step(const mr_model *model, const mr_parameters *parameters, double h,
                           const double *drive, double *workspace, double *memory, double *q,
                           double *dq) {
    static const double node[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const int32_t n = model->n;
    double *a[ARRAYS];
    for (size_t k = 0; k < ARRAYS; ++k) a[k] = memory + k * (size_t)n;
    double *q0 = a[Q0], *dq0 = a[DQ0];
    double *q1 = a[Q1], *dq1 = a[DQ1];
    double *k_dq = a[K_DQ], *k_ddq = a[K_DDQ];
    double *sum_dq = a[SUM_DQ], *sum_ddq = a[SUM_DDQ];
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

/* Of friction (20) along the n free joints, with what mimics them: the slope F_v + F_c / sqrt(dq^2 +
 * v_c^2), by which it is linear in dq, and its derivative; returns the energy that it comes from. */
static double friction_at(const mr_model *model, const mr_parameters *parameters, const double *dq,
                          double *slope, double *derivative) {
    const int32_t n = model->n, mimic = model->j - model->n;
    double energy = 0.0;
    for (int32_t i = 0; i < n; ++i) slope[i] = derivative[i] = 0.0;
    for (int32_t k = 0; k < n + mimic; ++k) {
        const int32_t joint = mimic ? model->moves[k] : k;
        const int32_t entry = k < n ? k : model->leader[k - n];
        const double ratio = k < n ? 1.0 : model->multiplier[k - n], square = ratio * ratio;
        const double rate = ratio * dq[entry], speed = model->coulomb_speed[joint];
        const double viscous = parameters->viscous[joint], coulomb = parameters->coulomb[joint];
        slope[entry] += square * viscous;
        derivative[entry] += square * viscous;
        energy += 0.5 * viscous * rate * rate;
        if (coulomb == 0.0) continue;
        const double root = sqrt(rate * rate + speed * speed), share = speed / root;
        slope[entry] += square * (coulomb / root);
        derivative[entry] += square * (coulomb / root * share * share);
        energy += coulomb * root;
    }
    return energy;
}

/* Least Coulomb speed of a joint that has such friction; 0 where none has. */
static double least_speed(const mr_model *model, const mr_parameters *parameters) {
    double least = HUGE_VAL;
    for (int32_t k = 0; k < model->j; ++k)
        if (parameters->coulomb[k] != 0.0 && model->coulomb_speed[k] < least)
            least = model->coulomb_speed[k];
    return least < HUGE_VAL ? least : 0.0;
}

/* 1/2 x' M x - fixed' x. */
static double quadratic(int32_t n, const double *M, const double *fixed, const double *x) {
    double sum = 0.0;
    for (int32_t i = 0; i < n; ++i) {
        double row = 0.0;
        for (int32_t k = 0; k < n; ++k) row += M[i * n + k] * x[k];
        sum += x[i] * (0.5 * row - fixed[i]);
    }
    return sum;
}

/* Solves (M + g diag(d)) x = x in place. */
static mr_status solve_with(int32_t n, const double *M, double g, const double *d, double *factors,
                            double *x) {
    for (int32_t i = 0; i < n * n; ++i) factors[i] = M[i];
    for (int32_t i = 0; i < n; ++i) factors[i * n + i] += g * d[i];
    return mr_cholesky_solve(n, factors, x);
}

#define PASSES 2    /* over geometry and bias, which friction does not make stiff */
#define SOLUTIONS 60 /* of the friction in one pass, at most */
#define CLOSE 1e-10 /* of largest speed and least Coulomb speed together, between two solutions */

/* Solves M x + g friction(x) = fixed from a first guess of x. Friction is a slope times the velocity:
 * repeating this with the slope at the last x goes down a convex function, wherever it starts, but
 * slowly where a light link breaks loose; Newton's step is taken where it goes down further. */
static mr_status friction_stage(const mr_model *model, const mr_parameters *parameters, double g,
                                const double *M, const double *fixed, double *factors,
                                double *const *a, double *x) {
    const int32_t n = model->n;
    double *slope = a[K_DQ], *derivative = a[SUM_DDQ], *safe = a[K_DDQ], *fast = a[FAST];
    double *spare = a[Q1]; /* of no more use in this pass */
    const double close = least_speed(model, parameters);
    for (int solution = 0; solution < SOLUTIONS; ++solution) {
        double change = 0.0, largest = 0.0;
        friction_at(model, parameters, x, slope, derivative);
        for (int32_t i = 0; i < n; ++i) {
            safe[i] = fast[i] = fixed[i];
            for (int32_t k = 0; k < n; ++k) fast[i] -= M[i * n + k] * x[k];
            fast[i] -= g * slope[i] * x[i];
        }
        const mr_status status = solve_with(n, M, g, slope, factors, safe);
        if (status) return status;
        if (!mr_all_finite(n, safe)) return MR_NOT_FINITE;
        const double *next = safe;
        if (!solve_with(n, M, g, derivative, factors, fast)) {
            for (int32_t i = 0; i < n; ++i) fast[i] += x[i];
            const double e_safe = quadratic(n, M, fixed, safe) +
                                  g * friction_at(model, parameters, safe, slope, spare);
            const double e_fast = quadratic(n, M, fixed, fast) +
                                  g * friction_at(model, parameters, fast, slope, spare);
            if (e_fast <= e_safe + 0x1p-50 * fabs(e_safe) && mr_all_finite(n, fast)) next = fast;
        }
        for (int32_t i = 0; i < n; ++i) {
            const double step = fabs(next[i] - x[i]), size = fabs(next[i]);
            if (step > change) change = step;
            if (size > largest) largest = size;
            x[i] = next[i];
        }
        if (change <= CLOSE * (largest + close)) break;
    }
    return MR_OK;
}

/* Solves dq1 = dq0 + g ddq(q0 + g dq1, dq1), the implicit stage: M dq1 + g friction(dq1) =
 * M dq0 + g (drive - bias), M and bias at the last dq1. */
static mr_status implicit_stage(const mr_model *model, const mr_parameters *parameters, double g,
                                const double *drive, double *workspace, double *const *a,
                                double *M, const double *q0, const double *dq0, double *dq1) {
    const int32_t n = model->n;
    double *q1 = a[Q1], *fixed = a[SUM_DQ];
    const mr_workspace ws = mr_workspace_view(model, workspace);
    for (int pass = 0; pass < PASSES; ++pass) {
        for (int32_t i = 0; i < n; ++i) {
            q1[i] = q0[i] + g * dq1[i];
            ws.ddq_a[i] = 0.0;
        }
        const mr_state given = {q1, dq1, dq1, ws.ddq_a, NULL, NULL};
        mr_state state;
        mr_status status = mr_full_state(model, &ws, &given, &state);
        if (status) return status;
        mr_point_of(model, parameters, ws.point);
        mr_newton_euler(model, ws.point, &state, &ws, ws.mid);
        mr_fold_mimic_torque(model, ws.mid);
        mr_mass_here(model, parameters, workspace, M);
        for (int32_t i = 0; i < n; ++i) {
            fixed[i] = g * (drive[i] - ws.mid[i]);
            for (int32_t k = 0; k < n; ++k) fixed[i] += M[i * n + k] * dq0[k];
        }
        double *factors = M + (size_t)model->j * (size_t)model->j;
        status = friction_stage(model, parameters, g, M, fixed, factors, a, dq1);
        if (status) return status;
    }
    return MR_OK;
}

/* The two-stage method of Alexander, of second order and L-stable. */
mr_status mr_implicit_step(const mr_model *model, const mr_parameters *parameters, double h,
                           const double *drive, double *workspace, double *memory, double *q,
                           double *dq) {
    static const double share = 0.29289321881345254; /* 1 - sqrt(1/2) */
    const int32_t n = model->n;
    const double g = share * h, before = (1.0 - share) / share;
    double *a[ARRAYS];
    for (size_t k = 0; k < ARRAYS; ++k) a[k] = memory + k * (size_t)n;
    double *M = memory + ARRAYS * (size_t)n, *q0 = a[Q0], *dq0 = a[DQ0], *dq1 = a[DQ1];
    for (int32_t i = 0; i < n; ++i) dq1[i] = dq[i];
    mr_status status = implicit_stage(model, parameters, g, drive, workspace, a, M, q, dq, dq1);
    if (status) return status;
    for (int32_t i = 0; i < n; ++i) { /* (1 - share) h times the first stage's slopes */
        q0[i] = q[i] + before * g * dq1[i];
        dq0[i] = dq[i] + before * (dq1[i] - dq[i]);
    }
    status = implicit_stage(model, parameters, g, drive, workspace, a, M, q0, dq0, dq1);
    if (status) return status;
    for (int32_t i = 0; i < n; ++i) {
        q[i] = q0[i] + g * dq1[i];
        dq[i] = dq1[i];
    }
    return MR_OK;
}
