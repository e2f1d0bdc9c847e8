/* A robot, its box, a state and gains from any bytes: what the kernel's fuzz target computes with.
 *
 * The shape always holds (parents before children, leaders that exist, ordered boxes, masses and
 * friction not negative), as the binding and the exported data promise it; the numbers are any.
 * kernel_seeds.py writes the same format. */
#ifndef KERNEL_INPUT_H
#define KERNEL_INPUT_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mr_kernel.h"

typedef struct {
    const uint8_t *at, *end;
} bytes;

/* Everything is an allocation of its exact size; freed as a chain. */
typedef struct block {
    struct block *next;
    void *memory;
} block;

typedef struct {
    mr_model model;
    mr_bounds bounds;
    mr_gains gains;
    const double *q, *dq, *dq_a, *ddq_a, *q_des;
    double t, elapsed;
    mr_sensor sensor;
    mr_disturbance disturbance;
    double late; /* in periods, as loop and controller have it */
    int drives, implicit, saturation;
    int usual; /* orthonormal rotations, lengths up to 1e6, finite box and speeds */
    block *blocks;
} fuzz_case;

static void *allocate(fuzz_case *c, size_t size) {
    block *b = malloc(sizeof *b);
    b->memory = malloc(size);
    b->next = c->blocks;
    c->blocks = b;
    return b->memory;
}

static void release(fuzz_case *c) {
    while (c->blocks) {
        block *b = c->blocks;
        c->blocks = b->next;
        free(b->memory);
        free(b);
    }
}

static uint8_t take_byte(bytes *in) { return in->at < in->end ? *in->at++ : 0; }

static double take_double(bytes *in) {
    static const double special[] = {0.0,     -0.0,    1.0,    -1.0,   INFINITY, -INFINITY, NAN,
                                     DBL_MAX, DBL_MIN, 5e-324, 1e-300, 1e300,    1e154,     1e5,
                                     -1e5,    1e-9,    1e6,    0.5,    1e100};
    static const double scale[] = {0x1p-4, 0x1p-14, 0x1p6, 0x1p-44};
    const uint8_t tag = take_byte(in);
    double x = 0.0;
    if (tag == 0) { /* any double, bit by bit */
        for (size_t k = 0; k < sizeof x; ++k) {
            const uint8_t byte = take_byte(in);
            memcpy((char *)&x + k, &byte, 1);
        }
        return x;
    }
    if (tag < 64) return special[(tag - 1) % (sizeof special / sizeof *special)];
    return (int8_t)take_byte(in) * scale[tag & 3];
}

static double *take_doubles(fuzz_case *c, bytes *in, int32_t count) {
    double *x = allocate(c, (size_t)count * sizeof *x);
    for (int32_t i = 0; i < count; ++i) x[i] = take_double(in);
    return x;
}

static void take_transform(fuzz_case *c, bytes *in, mr_transform *T) {
    const uint8_t kind = take_byte(in) & 3;
    memset(T, 0, sizeof *T);
    if (kind == 3) {
        for (int k = 0; k < 9; ++k) T->R[k] = take_double(in);
    } else { /* none, a quarter turn or any turn about x, y or z */
        const int x = take_byte(in) % 3, y = (x + 1) % 3, z = (x + 2) % 3;
        const double angle = kind == 2 ? take_double(in) : 0.0;
        const double turn = isfinite(angle) ? angle : 0.0;
        const double co = kind == 2 ? cos(turn) : kind == 1 ? 0.0 : 1.0;
        const double si = kind == 2 ? sin(turn) : kind == 1 ? 1.0 : 0.0;
        T->R[4 * x] = 1.0;
        T->R[4 * y] = T->R[4 * z] = co;
        T->R[3 * z + y] = si;
        T->R[3 * y + z] = -si;
    }
    for (int k = 0; k < 3; ++k) {
        T->p[k] = take_double(in);
        if (!(fabs(T->p[k]) <= 1e6)) c->usual = 0;
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double product = i == j ? -1.0 : 0.0;
            for (int k = 0; k < 3; ++k) product += T->R[3 * i + k] * T->R[3 * j + k];
            if (!(fabs(product) <= 0x1p-50)) c->usual = 0;
        }
}

static void swap_if_less(double *a, double *b) {
    if (*b < *a) {
        const double x = *a;
        *a = *b;
        *b = x;
    }
}

/* nominal, lower and upper, ordered; an exact value, any three, or a relative width. */
static void take_box(fuzz_case *c, bytes *in, int sign, double *nominal, double *lower,
                     double *upper) {
    const uint8_t kind = take_byte(in) % 3;
    double lo, x = take_double(in), hi;
    lo = hi = x;
    if (kind == 1) {
        lo = take_double(in);
        hi = take_double(in);
    } else if (kind == 2) {
        const double width = fabs(x * take_double(in));
        lo -= width;
        hi += width;
    }
    if (!sign) lo = fmax(lo, 0.0), x = fabs(x), hi = fabs(hi);
    swap_if_less(&lo, &x);
    swap_if_less(&x, &hi);
    swap_if_less(&lo, &x);
    swap_if_less(&lo, &hi); /* where x is not a number */
    *nominal = x;
    *lower = lo;
    *upper = hi;
}

static void take_boxes(fuzz_case *c, bytes *in, int32_t count, int sign, const double *nominal,
                       const double *lower, const double *upper) {
    for (int32_t i = 0; i < count; ++i)
        take_box(c, in, sign, (double *)nominal + i, (double *)lower + i, (double *)upper + i);
}

/* The arrays of one point are allocations of their own, not one packed vector. */
static mr_parameters allocate_point(fuzz_case *c, int32_t b, int32_t j) {
    const size_t bodies = (size_t)b * sizeof(double), joints = (size_t)j * sizeof(double);
    return (mr_parameters){allocate(c, bodies), allocate(c, 3 * bodies), allocate(c, 6 * bodies),
                           allocate(c, joints), allocate(c, joints),     allocate(c, joints)};
}

static void take_model(fuzz_case *c, bytes *in) {
    const int32_t n = 1 + take_byte(in) % 12, mimic_joints = take_byte(in) % 4;
    const int32_t j = n + mimic_joints, b = take_byte(in) % 16;
    int32_t *type = allocate(c, (size_t)j * 4), *parent = allocate(c, (size_t)j * 4);
    int32_t *moves = allocate(c, (size_t)j * 4), *joint = allocate(c, (size_t)b * 4);
    int32_t *leader = allocate(c, (size_t)mimic_joints * 4);
    mr_transform *before = allocate(c, (size_t)j * sizeof *before);
    mr_transform *after = allocate(c, (size_t)j * sizeof *after);
    mr_transform *placement = allocate(c, (size_t)b * sizeof *placement);
    int32_t *about = allocate(c, (size_t)b * 4);
    double *ratio = allocate(c, (size_t)j * 8), *speed = allocate(c, (size_t)j * 8);
    double *multiplier = allocate(c, (size_t)mimic_joints * 8);
    double *offset = allocate(c, (size_t)mimic_joints * 8);
    for (int32_t i = 0; i < j; ++i) {
        type[i] = take_byte(in) & 1;
        parent[i] = take_byte(in) % (i + 1) - 1;
        take_transform(c, in, before + i);
        take_transform(c, in, after + i);
        ratio[i] = take_double(in);
        speed[i] = take_double(in);
        if (!(speed[i] >= 0.0)) c->usual = 0;
    }
    for (int32_t i = 0, free = 0; i < j; ++i) { /* as many mimic as shall, any of them */
        const int mimics = (take_byte(in) & 1 && i - free < mimic_joints) || free == n;
        moves[mimics ? n + i - free : free] = i;
        free += !mimics;
    }
    for (int32_t i = 0; i < mimic_joints; ++i) {
        leader[i] = take_byte(in) % n;
        multiplier[i] = take_double(in);
        offset[i] = take_double(in);
    }
    for (int32_t k = 0; k < b; ++k) {
        joint[k] = take_byte(in) % (j + 1) - 1;
        about[k] = take_byte(in) & 1;
        take_transform(c, in, placement + k);
    }
    c->model = (mr_model){.n = n,
                          .j = j,
                          .b = b,
                          .joint_type = type,
                          .parent = parent,
                          .before = before,
                          .after = after,
                          .gear_ratio = ratio,
                          .coulomb_speed = speed,
                          .moves = moves,
                          .leader = leader,
                          .multiplier = multiplier,
                          .offset = offset,
                          .body_joint = joint,
                          .placement = placement,
                          .inertia_about = about};
    for (int k = 0; k < 3; ++k) c->model.gravity[k] = take_double(in);
    double *precomputed = allocate(c, mr_precomputed_size(&c->model) * sizeof *precomputed);
    mr_precompute_model(&c->model, precomputed);
    c->model.precomputed = precomputed;
}

static void take_bounds(fuzz_case *c, bytes *in) {
    const int32_t n = c->model.n, j = c->model.j, b = c->model.b;
    const mr_parameters x = allocate_point(c, b, j), lo = allocate_point(c, b, j),
                        hi = allocate_point(c, b, j);
    int32_t *uncertain = allocate(c, (size_t)b * sizeof *uncertain);
    double *d_lo = allocate(c, (size_t)n * 8), *d_hi = allocate(c, (size_t)n * 8), nominal;
    take_boxes(c, in, b, 0, x.mass, lo.mass, hi.mass);
    take_boxes(c, in, 3 * b, 1, x.com, lo.com, hi.com);
    take_boxes(c, in, 6 * b, 1, x.inertia, lo.inertia, hi.inertia);
    take_boxes(c, in, j, 0, x.rotor_inertia, lo.rotor_inertia, hi.rotor_inertia);
    take_boxes(c, in, j, 0, x.viscous, lo.viscous, hi.viscous);
    take_boxes(c, in, j, 0, x.coulomb, lo.coulomb, hi.coulomb);
    for (int32_t i = 0; i < n; ++i) take_box(c, in, 1, &nominal, d_lo + i, d_hi + i);
    const int32_t count = mr_find_uncertain(b, &lo, &hi, uncertain);
    c->bounds = (mr_bounds){.nominal = x,
                            .lower = lo,
                            .upper = hi,
                            .disturbance_lo = d_lo,
                            .disturbance_hi = d_hi,
                            .uncertain = uncertain,
                            .uncertain_count = count};
    double *prepared = allocate(c, mr_prepared_size(&c->model) * sizeof *prepared);
    mr_prepare(&c->model, &c->bounds, prepared);
    c->bounds.prepared = prepared;
}

static double within(double x, double lo, double hi) { return x > lo ? x < hi ? x : hi : lo; }

/* What the laws for a held command know of the loop; numbers that they compute with are any. */
static void take_held(fuzz_case *c, bytes *in) {
    mr_gains *gains = &c->gains;
    gains->kappa_max = take_double(in);
    gains->phi_max = take_double(in);
    gains->leak = take_double(in);
    gains->hold_aware = take_byte(in) & 1;
    gains->period = take_double(in);
    gains->delay = c->late = within(take_double(in), 0.0, 1.0);
    gains->G = take_double(in);
    gains->Lambda = take_double(in);
    gains->L_i = take_double(in);
    gains->blend = take_double(in);
    const uint8_t parts = take_byte(in);
    gains->integral = parts & 1;
    gains->predictor = parts >> 1 & 1;
    gains->vector_saturation = parts >> 2 & 1;
    double *limit = take_doubles(c, in, c->model.n);
    for (int32_t i = 0; i < c->model.n; ++i) limit[i] = fabs(limit[i]);
    gains->effort_limit = limit;
    gains->centre = c->bounds.nominal;
    gains->light = c->bounds.lower;
}

/* How the loop measures, and what disturbs it. */
static void take_drive(fuzz_case *c, bytes *in) {
    const int32_t n = c->model.n;
    const uint8_t kinds = take_byte(in);
    c->implicit = kinds & 1;
    c->saturation = kinds >> 1 & 1;
    c->sensor.worst = kinds >> 2 & 1;
    c->disturbance.kind = (mr_disturbance_kind)(kinds >> 3 & 3);
    c->sensor.noise_q = kinds & 32 ? take_doubles(c, in, n) : NULL;
    c->sensor.noise_dq = kinds & 32 ? take_doubles(c, in, n) : NULL;
    c->sensor.step_q = kinds & 64 ? take_doubles(c, in, n) : NULL;
    c->sensor.step_dq = kinds & 64 ? take_doubles(c, in, n) : NULL;
    c->sensor.filter = within(take_double(in), 0.0, 1.0);
    c->disturbance.frequency = within(take_double(in), 0.0, 1e9);
    c->disturbance.constant = c->bounds.disturbance_lo;
    c->sensor.random[0] = c->disturbance.random[0] = 1 + take_byte(in);
}

static void take_case(fuzz_case *c, const uint8_t *data, size_t size) {
    bytes in = {data, data + size};
    memset(c, 0, sizeof *c);
    c->usual = 1;
    take_model(c, &in);
    take_bounds(c, &in);
    const int32_t n = c->model.n;
    c->q = take_doubles(c, &in, n);
    c->dq = take_doubles(c, &in, n);
    c->dq_a = take_doubles(c, &in, n);
    c->ddq_a = take_doubles(c, &in, n);
    c->q_des = take_doubles(c, &in, n);
    c->drives = take_byte(&in) & 1;
    c->t = take_double(&in);
    c->elapsed = take_double(&in);
    c->gains.K_r = take_doubles(c, &in, n);
    c->gains.kappa_P = take_double(&in);
    c->gains.kappa_I = take_double(&in);
    c->gains.phi_P = take_double(&in);
    c->gains.phi_I = take_double(&in);
    c->gains.epsilon = take_double(&in);
    int32_t *wraps = allocate(c, (size_t)n * sizeof *wraps); /* older inputs end here */
    for (int32_t i = 0; i < n; ++i)
        wraps[i] = (take_byte(&in) & 1) && c->model.joint_type[i] == MR_REVOLUTE;
    c->model.wraps = wraps;
    take_held(c, &in);
    take_drive(c, &in);
}

#endif
