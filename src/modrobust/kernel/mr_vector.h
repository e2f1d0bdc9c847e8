/* Vectors of three, 3x3 matrices row by row, and intervals with their rounding enclosed.
 *
 * The operations on vectors are macros, because an operand may be a constant of the robot, a
 * double, or a number of the pass. Arguments are evaluated more than once; out must not be an
 * operand. */
#ifndef MR_VECTOR_H
#define MR_VECTOR_H

#include "mr_number.h"

#define mr_dot(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

/* Component k of a x b, and its neighbours in turn. */
#define MR_CROSS_0(a, b) ((a)[1] * (b)[2] - (a)[2] * (b)[1])
#define MR_CROSS_1(a, b) ((a)[2] * (b)[0] - (a)[0] * (b)[2])
#define MR_CROSS_2(a, b) ((a)[0] * (b)[1] - (a)[1] * (b)[0])

#define mr_cross(a, b, out)            \
    do {                               \
        (out)[0] = MR_CROSS_0(a, b);   \
        (out)[1] = MR_CROSS_1(a, b);   \
        (out)[2] = MR_CROSS_2(a, b);   \
    } while (0)

#define mr_add_cross(a, b, out)        \
    do {                               \
        (out)[0] += MR_CROSS_0(a, b);  \
        (out)[1] += MR_CROSS_1(a, b);  \
        (out)[2] += MR_CROSS_2(a, b);  \
    } while (0)

#define mr_add(a, out)                 \
    do {                               \
        (out)[0] += (a)[0];            \
        (out)[1] += (a)[1];            \
        (out)[2] += (a)[2];            \
    } while (0)

#define mr_add_scaled(k, a, out)       \
    do {                               \
        (out)[0] += (k) * (a)[0];      \
        (out)[1] += (k) * (a)[1];      \
        (out)[2] += (k) * (a)[2];      \
    } while (0)

#define mr_copy(a, out)                \
    do {                               \
        (out)[0] = (a)[0];             \
        (out)[1] = (a)[1];             \
        (out)[2] = (a)[2];             \
    } while (0)

/* A constant becomes a number of the pass. */
#define mr_splat(a, out)               \
    do {                               \
        (out)[0] = MR_SPLAT((a)[0]);   \
        (out)[1] = MR_SPLAT((a)[1]);   \
        (out)[2] = MR_SPLAT((a)[2]);   \
    } while (0)

#define mr_rotate(R, x, out)           \
    do {                               \
        (out)[0] = mr_dot(R, x);       \
        (out)[1] = mr_dot((R) + 3, x); \
        (out)[2] = mr_dot((R) + 6, x); \
    } while (0)

/* out = R' x */
#define mr_unrotate(R, x, out)                                             \
    do {                                                                   \
        (out)[0] = (R)[0] * (x)[0] + (R)[3] * (x)[1] + (R)[6] * (x)[2];    \
        (out)[1] = (R)[1] * (x)[0] + (R)[4] * (x)[1] + (R)[7] * (x)[2];    \
        (out)[2] = (R)[2] * (x)[0] + (R)[5] * (x)[1] + (R)[8] * (x)[2];    \
    } while (0)

#define MR_TIMES_COLUMN(A, B, c) ((A)[0] * (B)[c] + (A)[1] * (B)[(c) + 3] + (A)[2] * (B)[(c) + 6])

#define mr_multiply(A, B, out)                            \
    do {                                                  \
        for (int row_ = 0; row_ < 9; row_ += 3) {         \
            (out)[row_] = MR_TIMES_COLUMN((A) + row_, B, 0);     \
            (out)[row_ + 1] = MR_TIMES_COLUMN((A) + row_, B, 1); \
            (out)[row_ + 2] = MR_TIMES_COLUMN((A) + row_, B, 2); \
        }                                                 \
    } while (0)

/* out = S x for the symmetric S = xx xy xz yy yz zz */
#define mr_symmetric(S, x, out)                                            \
    do {                                                                   \
        (out)[0] = (S)[0] * (x)[0] + (S)[1] * (x)[1] + (S)[2] * (x)[2];    \
        (out)[1] = (S)[1] * (x)[0] + (S)[3] * (x)[1] + (S)[4] * (x)[2];    \
        (out)[2] = (S)[2] * (x)[0] + (S)[4] * (x)[1] + (S)[5] * (x)[2];    \
    } while (0)

/* ---- Intervals: Definitions 4 to 6 of the paper. Every result contains the exact one. ---- */
typedef struct {
    MR_REAL lo, hi;
} mr_interval;

/* Half a unit in the last place, a little more; and what a product or a sum may lose below it. */
#define MR_PHI 0x1.0000000000002p-53
#define MR_ETA 0x1p-1022

static inline MR_REAL mr_down(MR_REAL x) { return x - (MR_ABS(x) * MR_PHI + MR_ETA); }
static inline MR_REAL mr_up(MR_REAL x) { return x + (MR_ABS(x) * MR_PHI + MR_ETA); }

static inline mr_interval mr_i_add(mr_interval x, mr_interval y) {
    return (mr_interval){mr_down(x.lo + y.lo), mr_up(x.hi + y.hi)};
}

static inline mr_interval mr_i_sub(mr_interval x, mr_interval y) {
    return (mr_interval){mr_down(x.lo - y.hi), mr_up(x.hi - y.lo)};
}

/* The two products in order, rounded to nearest. */
#define MR_SCALE(k, x)                                            \
    ((mr_interval){MR_SELECT((k) >= 0.0, (k) * (x).lo, (k) * (x).hi), \
                   MR_SELECT((k) >= 0.0, (k) * (x).hi, (k) * (x).lo)})

static inline mr_interval mr_i_scale(MR_REAL k, mr_interval x) {
    const mr_interval near = MR_SCALE(k, x);
    return (mr_interval){mr_down(near.lo), mr_up(near.hi)};
}

static inline mr_interval mr_i_mul(mr_interval x, mr_interval y) {
    const MR_REAL a = x.lo * y.lo, b = x.lo * y.hi, c = x.hi * y.lo, d = x.hi * y.hi;
    const MR_REAL ab_lo = MR_MIN(a, b), cd_lo = MR_MIN(c, d);
    const MR_REAL ab_hi = MR_MAX(a, b), cd_hi = MR_MAX(c, d);
    return (mr_interval){mr_down(MR_MIN(ab_lo, cd_lo)), mr_up(MR_MAX(ab_hi, cd_hi))};
}

/* x with its ends moved apart by radius >= 0. */
static inline mr_interval mr_i_widen(mr_interval x, MR_REAL radius) {
    return (mr_interval){mr_down(x.lo - radius), mr_up(x.hi + radius)};
}

/* The larger of the ends' sizes. */
static inline MR_REAL mr_i_size(mr_interval x) {
    const MR_REAL lo = MR_ABS(x.lo), hi = MR_ABS(x.hi);
    return MR_MAX(lo, hi);
}

#endif
