/* The number that a pass over the robot computes with.
 *
 * Files of the pass are written once, for MR_REAL: a double for one state, or a vector register of
 * states side by side where mr_batch.c includes them again. Each lane of a register has the bits
 * that a double would have: every operation is one of IEEE 754, rounded to nearest. */
#ifndef MR_NUMBER_H
#define MR_NUMBER_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* One register of doubles, as wide as the target has them. */
#if defined(__GNUC__) && !defined(MR_ONE_LANE)
#if defined(__AVX512F__)
#define MR_LANES 8
#elif defined(__AVX__)
#define MR_LANES 4
#else
#define MR_LANES 2
#endif
typedef double mr_lane __attribute__((vector_size(8 * MR_LANES)));
typedef int64_t mr_lane_mask __attribute__((vector_size(8 * MR_LANES)));
#define MR_LANE_SELECT(mask, a, b) \
    ((mr_lane)(((mask) & (mr_lane_mask)(a)) | (~(mask) & (mr_lane_mask)(b))))
#define MR_LANE_ABS(x) ((mr_lane)((mr_lane_mask)(x) & INT64_MAX))
#define MR_LANE_COPYSIGN(x, y) \
    ((mr_lane)(((mr_lane_mask)(x) & INT64_MAX) | ((mr_lane_mask)(y) & INT64_MIN)))
#define MR_LANE_BITS(x) ((mr_lane_mask)(x))
#else
#define MR_LANES 1
typedef double mr_lane;
typedef int64_t mr_lane_mask;
#define MR_LANE_SELECT(mask, a, b) ((mask) ? (a) : (b))
#define MR_LANE_ABS(x) fabs(x)
#define MR_LANE_COPYSIGN(x, y) copysign(x, y)
static inline int64_t mr_bits(double x) {
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
#define MR_LANE_BITS(x) mr_bits(x)
#endif

/* x - 0 is x for every x, the sign of a zero included. */
#define MR_LANE_SPLAT(x) ((x) - (mr_lane){0})

static inline mr_lane mr_lane_load(const double *from) {
    mr_lane x;
    memcpy(&x, from, sizeof x);
    return x;
}

static inline void mr_lane_store(mr_lane x, double *to) { memcpy(to, &x, sizeof x); }

static inline int mr_lane_any(mr_lane_mask mask) {
    int64_t lane[MR_LANES], any = 0;
    memcpy(lane, &mask, sizeof lane);
    for (int k = 0; k < MR_LANES; ++k) any |= lane[k];
    return any != 0;
}

static inline int mr_lane_all(mr_lane_mask mask) {
    int64_t lane[MR_LANES];
    int all = 1;
    memcpy(lane, &mask, sizeof lane);
    for (int k = 0; k < MR_LANES; ++k) all &= lane[k] != 0;
    return all;
}

#ifdef MR_BATCH
#define MR_ALL mr_lane_all
#define MR_REAL mr_lane
#define MR_MASK mr_lane_mask
#define MR_SELECT MR_LANE_SELECT
#define MR_ABS MR_LANE_ABS
#define MR_COPYSIGN MR_LANE_COPYSIGN
#define MR_SPLAT MR_LANE_SPLAT
#define MR_SQRT mr_lane_sqrt
#else
#define MR_ALL(mask) (mask)
#define MR_REAL double
#define MR_MASK int64_t
#define MR_SELECT(mask, a, b) ((mask) ? (a) : (b))
#define MR_ABS(x) fabs(x)
#define MR_COPYSIGN(x, y) copysign(x, y)
#define MR_SPLAT(x) (x)
#define MR_SQRT sqrt
#endif

static inline mr_lane mr_lane_sqrt(mr_lane x) {
    double lane[MR_LANES];
    mr_lane_store(x, lane);
    for (int k = 0; k < MR_LANES; ++k) lane[k] = sqrt(lane[k]);
    return mr_lane_load(lane);
}

/* What does not depend on one another, joints or bodies, goes through registers MR_BLOCK at a
 * time: side by side for one state, one by one in a batch, whose lanes are states. */
#ifdef MR_BATCH
#define MR_BLOCK 1
#define MR_TAKE(array, i) ((array)[i])
#define MR_TAKE_CONSTANT(array, i) MR_LANE_SPLAT((array)[i])
#define MR_PUT(x, array, i) ((array)[i] = (x))
#else
#define MR_BLOCK MR_LANES
#define MR_TAKE(array, i) mr_lane_load((array) + (i))
#define MR_TAKE_CONSTANT(array, i) mr_lane_load((array) + (i))
#define MR_PUT(x, array, i) mr_lane_store(x, (array) + (i))
#endif

/* The smaller and the larger; the second where one is not a number. */
#define MR_MIN(a, b) MR_SELECT((a) < (b), a, b)
#define MR_MAX(a, b) MR_SELECT((a) > (b), a, b)

#endif
