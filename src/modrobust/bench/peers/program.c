/* Times the kernel, and another library beside it if it is linked, on a job read from stdin.
 *
 * Interleaved: one round runs every subject in turn, because machines change their speed. The job
 * is written by native.py in the order in which it is read here; numbers are hex floats, so that
 * both sides get the very same doubles. Out come lines of a name and numbers, times in seconds. */
#define _POSIX_C_SOURCE 199309L
#include "peer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef enum { PEER, SINCOS, NOMINAL, BOUNDS, COMMAND, BATCH } kind;

typedef struct {
    kind kind;
    mr_bounds bounds;
    mr_gains gains;
    mr_controller_state state;
    double time;
} subject;

typedef struct {
    mr_model model;
    int32_t states;
    double *q, *dq, *q_des, *dq_des, *ddq_des;
    double *workspace, *rows, *lo, *hi;
    double sink; /* what was computed is used, or the compiler might leave it out */
} program;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void require(int ok, const char *what) {
    if (ok) return;
    fprintf(stderr, "program: %s\n", what);
    exit(1);
}

static void *memory(size_t count, size_t size) {
    void *found = calloc(count + 1, size);
    require(found != NULL, "out of memory");
    return found;
}

static int32_t integer(void) {
    int value;
    require(scanf("%d", &value) == 1, "expected an integer");
    return value;
}

static int32_t *integers(int32_t count) {
    int32_t *out = memory((size_t)count, sizeof *out);
    for (int32_t k = 0; k < count; ++k) out[k] = integer();
    return out;
}

static double *doubles(size_t count) {
    double *out = memory(count, sizeof *out);
    for (size_t k = 0; k < count; ++k) require(scanf("%la", &out[k]) == 1, "expected a number");
    return out;
}

static mr_transform *transforms(int32_t count) {
    double *numbers = doubles(12 * (size_t)count);
    mr_transform *out = memory((size_t)count, sizeof *out);
    for (int32_t i = 0; i < count; ++i) {
        memcpy(out[i].R, numbers + 12 * i, sizeof out[i].R);
        memcpy(out[i].p, numbers + 12 * i + 9, sizeof out[i].p);
    }
    free(numbers);
    return out;
}

static mr_model read_model(void) {
    mr_model m = {0};
    m.n = integer();
    m.j = integer();
    m.b = integer();
    m.joint_type = integers(m.j);
    m.parent = integers(m.j);
    m.before = transforms(m.j);
    m.after = transforms(m.j);
    m.gear_ratio = doubles((size_t)m.j);
    m.coulomb_speed = doubles((size_t)m.j);
    m.moves = integers(m.j);
    m.leader = integers(m.j - m.n);
    m.multiplier = doubles((size_t)(m.j - m.n));
    m.offset = doubles((size_t)(m.j - m.n));
    m.body_joint = integers(m.b);
    m.placement = transforms(m.b);
    m.inertia_about = integers(m.b);
    double *gravity = doubles(3);
    memcpy(m.gravity, gravity, sizeof m.gravity);
    free(gravity);
    double *precomputed = memory(mr_precomputed_size(&m), sizeof *precomputed);
    mr_precompute_model(&m, precomputed);
    m.precomputed = precomputed;
    return m;
}

static mr_bounds read_bounds(const mr_model *model) {
    const size_t size = mr_parameters_size(model);
    mr_bounds b = {0};
    b.nominal = mr_parameters_view(model, doubles(size));
    b.lower = mr_parameters_view(model, doubles(size));
    b.upper = mr_parameters_view(model, doubles(size));
    b.disturbance_lo = doubles((size_t)model->n);
    b.disturbance_hi = doubles((size_t)model->n);
    int32_t *uncertain = memory((size_t)model->b, sizeof *uncertain);
    b.uncertain_count = mr_find_uncertain(model->b, &b.lower, &b.upper, uncertain);
    b.uncertain = uncertain;
    double *prepared = memory(mr_prepared_size(model), sizeof *prepared);
    mr_prepare(model, &b, prepared);
    b.prepared = prepared;
    return b;
}

static mr_gains read_gains(const mr_model *model) {
    mr_gains g = {0};
    g.K_r = doubles((size_t)model->n);
    double *five = doubles(5);
    g.kappa_P = five[0];
    g.kappa_I = five[1];
    g.phi_P = five[2];
    g.phi_I = five[3];
    g.epsilon = five[4];
    g.law = MR_LAW_NORM;
    free(five);
    return g;
}

static double *row(const program *p, int k) { return p->rows + k * p->model.n; }

/* One state of a subject that is ours. */
static mr_status run_one(program *p, subject *s, int32_t k) {
    const size_t at = (size_t)k * (size_t)p->model.n;
    const double *q = p->q + at, *dq = p->dq + at, *q_des = p->q_des + at;
    const double *dq_des = p->dq_des + at, *ddq_des = p->ddq_des + at;
    mr_command_out out = {row(p, 0), row(p, 1), row(p, 2), row(p, 3), row(p, 4),
                          row(p, 5), 0.0,       0.0,       0.0};
    switch (s->kind) {
    case SINCOS:
        for (int32_t i = 0; i < p->model.n; ++i) {
            mr_sincos(q[i], row(p, 0), row(p, 1));
            p->sink += *row(p, 0) + *row(p, 1);
        }
        return MR_OK;
    case NOMINAL:
        return mr_inverse_dynamics(&p->model, &s->bounds.nominal, q, dq, dq, ddq_des, 0,
                                   p->workspace, row(p, 0));
    case BOUNDS:
        return mr_inverse_dynamics_bounds(&p->model, &s->bounds, s->gains.method, q, dq, dq_des,
                                          ddq_des, 1, p->workspace, row(p, 0), row(p, 1));
    case COMMAND:
        s->time += 1e-3; /* the clock of the job: commands at 1 kHz */
        return mr_command(&p->model, &s->bounds, &s->gains, s->time, q, dq, q_des, dq_des, ddq_des,
                          p->workspace, &s->state, &out);
    default: return MR_NOT_FINITE; /* those that take all states at once */
    }
}

static double pass(program *p, subject *s) {
    const double begin = now();
    if (s->kind == PEER) {
#ifdef WITH_PEER
        p->sink += peer_pass();
#else
        require(0, "no other library is linked");
#endif
    } else if (s->kind == BATCH) {
        int64_t at;
        require(mr_inverse_dynamics_bounds_batch(&p->model, &s->bounds, s->gains.method, p->states,
                                                 p->q, p->dq, p->dq_des, p->ddq_des, 1,
                                                 p->workspace, p->lo, p->hi, &at) == MR_OK,
                "the kernel refuses a state");
        p->sink += *p->lo;
    } else {
        for (int32_t k = 0; k < p->states; ++k) {
            require(run_one(p, s, k) == MR_OK, "the kernel refuses a state");
            p->sink += *row(p, 0);
        }
    }
    return (now() - begin) / p->states;
}

#ifdef WITH_PEER
/* Largest difference of NE* without drives from the peer's torques, over the largest torque. */
static double disagreement(program *p, const mr_parameters *nominal) {
    double difference = 0.0, scale = 0.0;
    subject plain = {0};
    plain.kind = NOMINAL;
    plain.bounds.nominal = *nominal;
    for (int32_t k = 0; k < p->states; ++k) {
        require(run_one(p, &plain, k) == MR_OK, "the kernel refuses a state");
        peer_torque(k, row(p, 1));
        for (int32_t i = 0; i < p->model.n; ++i) {
            const double ours = row(p, 0)[i], theirs = row(p, 1)[i];
            difference = fmax(difference, fabs(ours - theirs));
            scale = fmax(scale, fabs(theirs));
        }
    }
    return difference / scale;
}
#endif

static void print(const char *name, int32_t which, const double *values, size_t count) {
    printf("%s %d", name, which);
    for (size_t k = 0; k < count; ++k) printf(" %a", values[k]);
    printf("\n");
}

int main(void) {
    program p = {0};
    require(mr_self_test() == MR_OK, "this machine does not round as the kernel needs it");
    p.model = read_model();
    int32_t *order = integers(p.model.j);
    const int32_t boxes = integer();
    mr_bounds *bounds = memory((size_t)boxes, sizeof *bounds);
    for (int32_t k = 0; k < boxes; ++k) bounds[k] = read_bounds(&p.model);
    const mr_gains gains = read_gains(&p.model);
    p.states = integer();
    const size_t size = (size_t)p.states * (size_t)p.model.n;
    p.q = doubles(size);
    p.dq = doubles(size);
    p.q_des = doubles(size);
    p.dq_des = doubles(size);
    p.ddq_des = doubles(size);
    const size_t single = mr_workspace_size(&p.model), batch = mr_batch_workspace_size(&p.model);
    p.workspace = memory(single > batch ? single : batch, sizeof(double));
    p.lo = memory(size, sizeof(double));
    p.hi = memory(size, sizeof(double));
    p.rows = memory(6 * (size_t)p.model.n, sizeof(double));
    const int32_t count = integer();
    subject *subjects = memory((size_t)count, sizeof *subjects);
    for (int32_t k = 0; k < count; ++k) {
        subjects[k].kind = (kind)integer();
        subjects[k].bounds = bounds[integer()];
        subjects[k].gains = gains;
        subjects[k].gains.method = (mr_method)integer();
    }
    const int32_t rounds = integer(), singles = integer();
    char more;
    require(scanf(" %c", &more) == EOF, "the job is longer than expected");

#ifdef WITH_PEER
    peer_load(&p.model, &bounds[0].nominal, order);
    for (int32_t k = 0; k < p.states; ++k) {
        const size_t at = (size_t)k * (size_t)p.model.n;
        peer_state(p.q + at, p.dq + at, p.ddq_des + at);
    }
    const double differs = disagreement(&p, &bounds[0].nominal);
    print("disagreement", 0, &differs, 1);
#endif
    free(order);

    double *times = memory((size_t)(count * rounds), sizeof *times);
    for (int32_t s = 0; s < count; ++s) pass(&p, &subjects[s]); /* warms up */
    for (int32_t r = 0; r < rounds; ++r)
        for (int32_t s = 0; s < count; ++s) times[s * rounds + r] = pass(&p, &subjects[s]);
    for (int32_t s = 0; s < count; ++s) print("rounds", s, times + s * rounds, (size_t)rounds);

    /* Each command by itself, singles times every state; the clock's own cost is in the times. */
    double *alone = memory((size_t)(singles * p.states), sizeof *alone);
    for (int32_t s = 0; s < count; ++s) {
        if (subjects[s].kind == PEER || subjects[s].kind == BATCH) continue;
        for (int32_t r = 0; r < singles; ++r)
            for (int32_t k = 0; k < p.states; ++k) {
                const double begin = now();
                require(run_one(&p, &subjects[s], k) == MR_OK, "the kernel refuses a state");
                alone[r * p.states + k] = now() - begin;
            }
        print("singles", s, alone, (size_t)(singles * p.states));
    }
    for (int32_t k = 0; k < singles * p.states; ++k) {
        const double begin = now();
        alone[k] = now() - begin;
    }
    print("clock", 0, alone, (size_t)(singles * p.states));
    return p.sink != p.sink; /* never; keeps the sums */
}
