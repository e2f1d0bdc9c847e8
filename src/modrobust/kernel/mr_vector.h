/* Vectors of three, 3x3 matrices row by row, and intervals. Inline, internal to the kernel. */
#ifndef MR_VECTOR_H
#define MR_VECTOR_H

#include <math.h>

static inline double mr_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = a x b; out must not be a or b. */
static inline void mr_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void mr_add_cross(const double a[3], const double b[3], double out[3]) {
    out[0] += a[1] * b[2] - a[2] * b[1];
    out[1] += a[2] * b[0] - a[0] * b[2];
    out[2] += a[0] * b[1] - a[1] * b[0];
}

static inline void mr_add(const double a[3], double out[3]) {
    out[0] += a[0];
    out[1] += a[1];
    out[2] += a[2];
}

static inline void mr_add_scaled(double k, const double a[3], double out[3]) {
    out[0] += k * a[0];
    out[1] += k * a[1];
    out[2] += k * a[2];
}

static inline void mr_copy(const double a[3], double out[3]) {
    out[0] = a[0];
    out[1] = a[1];
    out[2] = a[2];
}

static inline void mr_rotate(const double R[9], const double x[3], double out[3]) {
    out[0] = R[0] * x[0] + R[1] * x[1] + R[2] * x[2];
    out[1] = R[3] * x[0] + R[4] * x[1] + R[5] * x[2];
    out[2] = R[6] * x[0] + R[7] * x[1] + R[8] * x[2];
}

/* out = R' x */
static inline void mr_unrotate(const double R[9], const double x[3], double out[3]) {
    out[0] = R[0] * x[0] + R[3] * x[1] + R[6] * x[2];
    out[1] = R[1] * x[0] + R[4] * x[1] + R[7] * x[2];
    out[2] = R[2] * x[0] + R[5] * x[1] + R[8] * x[2];
}

static inline void mr_multiply(const double A[9], const double B[9], double out[9]) {
    for (int i = 0; i < 9; i += 3) {
        out[i] = A[i] * B[0] + A[i + 1] * B[3] + A[i + 2] * B[6];
        out[i + 1] = A[i] * B[1] + A[i + 1] * B[4] + A[i + 2] * B[7];
        out[i + 2] = A[i] * B[2] + A[i + 1] * B[5] + A[i + 2] * B[8];
    }
}

/* All nine entries: a rotation by 1e-9 has exact ones on its diagonal. */
static inline int mr_is_identity(const double R[9]) {
    return R[0] == 1.0 && R[4] == 1.0 && R[8] == 1.0 && R[1] == 0.0 && R[2] == 0.0 &&
           R[3] == 0.0 && R[5] == 0.0 && R[6] == 0.0 && R[7] == 0.0;
}

/* out = S x for the symmetric S = xx xy xz yy yz zz */
static inline void mr_symmetric(const double S[6], const double x[3], double out[3]) {
    out[0] = S[0] * x[0] + S[1] * x[1] + S[2] * x[2];
    out[1] = S[1] * x[0] + S[3] * x[1] + S[4] * x[2];
    out[2] = S[2] * x[0] + S[4] * x[1] + S[5] * x[2];
}

/* L of (16): L c = dw x c + w x (wa x c), row by row. */
static inline void mr_acceleration_matrix(const double w[3], const double wa[3],
                                          const double dw[3], double L[9]) {
    const double d = mr_dot(w, wa); /* w x (wa x c) = wa (w . c) - (w . wa) c */
    L[0] = wa[0] * w[0] - d;
    L[1] = wa[0] * w[1] - dw[2];
    L[2] = wa[0] * w[2] + dw[1];
    L[3] = wa[1] * w[0] + dw[2];
    L[4] = wa[1] * w[1] - d;
    L[5] = wa[1] * w[2] - dw[0];
    L[6] = wa[2] * w[0] - dw[1];
    L[7] = wa[2] * w[1] + dw[0];
    L[8] = wa[2] * w[2] - d;
}

/* ---- Intervals: Definitions 4 to 6 of the paper. ---- */
typedef struct {
    double lo, hi;
} mr_interval;

static inline mr_interval mr_i_add(mr_interval x, mr_interval y) {
    return (mr_interval){x.lo + y.lo, x.hi + y.hi};
}

static inline mr_interval mr_i_sub(mr_interval x, mr_interval y) {
    return (mr_interval){x.lo - y.hi, x.hi - y.lo};
}

static inline mr_interval mr_i_scale(double k, mr_interval x) {
    return k >= 0.0 ? (mr_interval){k * x.lo, k * x.hi} : (mr_interval){k * x.hi, k * x.lo};
}

static inline mr_interval mr_i_mul(mr_interval x, mr_interval y) {
    const double a = x.lo * y.lo, b = x.lo * y.hi, c = x.hi * y.lo, d = x.hi * y.hi;
    const double ab_lo = a < b ? a : b, cd_lo = c < d ? c : d;
    const double ab_hi = a > b ? a : b, cd_hi = c > d ? c : d;
    return (mr_interval){ab_lo < cd_lo ? ab_lo : cd_lo, ab_hi > cd_hi ? ab_hi : cd_hi};
}

static inline mr_interval mr_i_dot(const double a[3], const mr_interval x[3]) {
    return mr_i_add(mr_i_add(mr_i_scale(a[0], x[0]), mr_i_scale(a[1], x[1])),
                    mr_i_scale(a[2], x[2]));
}

/* out = a (x) [x], a real */
static inline void mr_i_cross_real(const double a[3], const mr_interval x[3],
                                   mr_interval out[3]) {
    out[0] = mr_i_sub(mr_i_scale(a[1], x[2]), mr_i_scale(a[2], x[1]));
    out[1] = mr_i_sub(mr_i_scale(a[2], x[0]), mr_i_scale(a[0], x[2]));
    out[2] = mr_i_sub(mr_i_scale(a[0], x[1]), mr_i_scale(a[1], x[0]));
}

static inline void mr_i_cross(const mr_interval x[3], const mr_interval y[3],
                              mr_interval out[3]) {
    out[0] = mr_i_sub(mr_i_mul(x[1], y[2]), mr_i_mul(x[2], y[1]));
    out[1] = mr_i_sub(mr_i_mul(x[2], y[0]), mr_i_mul(x[0], y[2]));
    out[2] = mr_i_sub(mr_i_mul(x[0], y[1]), mr_i_mul(x[1], y[0]));
}

static inline void mr_i_accumulate(const mr_interval x[3], mr_interval out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = mr_i_add(out[k], x[k]);
}

static inline void mr_i_rotate(const double R[9], const mr_interval x[3], mr_interval out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = mr_i_dot(R + 3 * k, x);
}

#endif
