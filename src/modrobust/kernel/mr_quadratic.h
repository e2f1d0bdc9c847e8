/* The exact range of g . x + x' Q x over the box |x_k| <= r_k, in each lane of a register, (19).
 *
 * Every lane's result depends on that lane alone: which of the three branches below it takes is
 * selected at the end, so that it has the same bits whatever its neighbours hold. */
#ifndef MR_QUADRATIC_H
#define MR_QUADRATIC_H

#include "mr_vector.h"

typedef struct {
    mr_lane g[3];
    mr_lane Q[6]; /* xx xy xz yy yz zz */
} mr_quadratic;

static inline mr_lane mr_quadratic_value(const mr_quadratic *f, const mr_lane x[3]) {
    const mr_lane *Q = f->Q;
    const mr_lane pure = Q[0] * x[0] * x[0] + Q[3] * x[1] * x[1] + Q[5] * x[2] * x[2];
    const mr_lane mixed = Q[1] * x[0] * x[1] + Q[2] * x[0] * x[2] + Q[4] * x[1] * x[2];
    return mr_dot(f->g, x) + (pure + 2.0 * mixed);
}

/* Index of Q's entry for rows j and k. */
static const int MR_ROW[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/* The best t in |t| <= r for h t + q t^2. */
static inline mr_lane mr_best_on_edge(mr_lane h, mr_lane q, mr_lane r) {
    const mr_lane end = MR_LANE_COPYSIGN(r, h);
    const mr_lane peak = h / (-2.0 * q); /* not a number, or infinite, where q is zero */
    const mr_lane_mask inside = (q < 0.0) & (MR_LANE_ABS(peak) <= r);
    return MR_LANE_SELECT(inside, peak, end);
}

#define MR_CLAMP(t, r) MR_LANE_SELECT((t) > (r), r, MR_LANE_SELECT((t) < -(r), -(r), t))
#define MR_KEEP_BEST(ok, value) \
    best = MR_LANE_SELECT((ok) & ((value) > best), value, best)

/* Largest value by all faces: the 12 edges with their ends, the 6 sides, the inside. A stationary
 * point counts only where all pivots of -Q on the face are positive, and is moved into the box,
 * where any point's value is a lower bound of the maximum. */
static mr_lane mr_max_by_faces(const mr_quadratic *f, const mr_lane r[3]) {
    const mr_lane *g = f->g, *Q = f->Q;
    mr_lane x[3] = {-r[0], -r[1], -r[2]};
    mr_lane best = mr_quadratic_value(f, x);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const mr_lane qk = Q[MR_ROW[k][k]], qi = Q[MR_ROW[i][i]], qj = Q[MR_ROW[j][j]];
        const mr_lane qki = Q[MR_ROW[k][i]], qkj = Q[MR_ROW[k][j]], qij = Q[MR_ROW[i][j]];
        for (int corner = 0; corner < 4; ++corner) { /* edges along k */
            x[i] = corner & 1 ? r[i] : -r[i];
            x[j] = corner & 2 ? r[j] : -r[j];
            x[k] = mr_best_on_edge(g[k] + 2.0 * (qki * x[i] + qkj * x[j]), qk, r[k]);
            const mr_lane value = mr_quadratic_value(f, x);
            MR_KEEP_BEST(value == value, value);
        }
        for (int end = 0; end < 2; ++end) { /* sides on which k is fixed */
            x[k] = end ? r[k] : -r[k];
            const mr_lane right_i = 0.5 * g[i] + qki * x[k], right_j = 0.5 * g[j] + qkj * x[k];
            const mr_lane ratio = qij / qi;
            const mr_lane pivot = qij * ratio - qj;
            const mr_lane_mask concave = (qi < 0.0) & (pivot > 0.0);
            x[j] = (right_j - ratio * right_i) / pivot;
            x[j] = MR_CLAMP(x[j], r[j]);
            x[i] = (right_i + qij * x[j]) / -qi;
            x[i] = MR_CLAMP(x[i], r[i]);
            const mr_lane value = mr_quadratic_value(f, x);
            MR_KEEP_BEST(concave, value);
        }
    }
    const mr_lane a = -Q[0], b = Q[1] / Q[0], c = Q[2] / Q[0]; /* elimination in -Q x = g / 2 */
    const mr_lane d = Q[1] * b - Q[3], e = Q[2] * b - Q[4], h = Q[2] * c - Q[5];
    const mr_lane ratio = e / d, pivot = h - e * ratio;
    const mr_lane right_1 = 0.5 * (g[1] - b * g[0]), right_2 = 0.5 * (g[2] - c * g[0]);
    const mr_lane_mask concave = (a > 0.0) & (d > 0.0) & (pivot > 0.0);
    x[2] = (right_2 - ratio * right_1) / pivot;
    x[2] = MR_CLAMP(x[2], r[2]);
    x[1] = (right_1 - e * x[2]) / d;
    x[1] = MR_CLAMP(x[1], r[1]);
    x[0] = (0.5 * g[0] + Q[1] * x[1] + Q[2] * x[2]) / a;
    x[0] = MR_CLAMP(x[0], r[0]);
    const mr_lane value = mr_quadratic_value(f, x);
    MR_KEEP_BEST(concave, value);
    return best;
}

/* lo, hi <- the range; lanes outside `active` cost no extra time and hold anything. */
static inline void mr_quadratic_range(const mr_quadratic *f, const double radius[3],
                                      mr_lane_mask active, mr_lane *lo, mr_lane *hi) {
    const mr_lane *Q = f->Q, *g = f->g;
    const mr_lane r[3] = {MR_LANE_SPLAT(radius[0]), MR_LANE_SPLAT(radius[1]),
                          MR_LANE_SPLAT(radius[2])};
    const mr_lane xy = MR_LANE_ABS(Q[1]), xz = MR_LANE_ABS(Q[2]), yz = MR_LANE_ABS(Q[4]);
    const mr_lane bend[3] = {MR_LANE_ABS(Q[0]) * r[0] + xy * r[1] + xz * r[2],
                             xy * r[0] + MR_LANE_ABS(Q[3]) * r[1] + yz * r[2],
                             xz * r[0] + yz * r[1] + MR_LANE_ABS(Q[5]) * r[2]};
    mr_lane_mask open[3];
    mr_lane x[3];
    for (int k = 0; k < 3; ++k) {
        open[k] = (MR_LANE_ABS(g[k]) < 2.0 * bend[k]) & active;
        x[k] = MR_LANE_COPYSIGN(r[k], g[k]);
    }
    /* Monotonic: the largest value at x and the smallest at -x, where the slopes change their sign
     * and the products do not. */
    const mr_lane slope[3] = {g[0] * x[0], g[1] * x[1], g[2] * x[2]};
    const mr_lane pure[3] = {Q[0] * x[0] * x[0], Q[3] * x[1] * x[1], Q[5] * x[2] * x[2]};
    const mr_lane mixed[3] = {2.0 * (Q[4] * x[1] * x[2]), 2.0 * (Q[2] * x[0] * x[2]),
                              2.0 * (Q[1] * x[0] * x[1])}; /* without x, y, z */
    const mr_lane slopes = slope[0] + slope[1] + slope[2];
    const mr_lane square = (pure[0] + pure[1] + pure[2]) + (mixed[0] + mixed[1] + mixed[2]);
    *hi = square + slopes;
    *lo = square - slopes;
    const mr_lane_mask some = open[0] | open[1] | open[2];
    if (!mr_lane_any(some)) return;

    /* Open in one direction t: the others stay at their ends, and along t the function is
     * h t + q t^2 with h = s + c at the upper end and h = s - c at the lower one. */
#define MR_OF_OPEN(a, b, c) MR_LANE_SELECT(open[0], a, MR_LANE_SELECT(open[1], b, c))
    const mr_lane rest = MR_OF_OPEN(slope[1] + slope[2], slope[0] + slope[2], slope[0] + slope[1]);
    const mr_lane curved = MR_OF_OPEN(pure[1] + pure[2] + mixed[0], pure[0] + pure[2] + mixed[1],
                                      pure[0] + pure[1] + mixed[2]);
    const mr_lane c = 2.0 * MR_OF_OPEN(Q[1] * x[1] + Q[2] * x[2], Q[1] * x[0] + Q[4] * x[2],
                                       Q[2] * x[0] + Q[4] * x[1]);
    const mr_lane s = MR_OF_OPEN(g[0], g[1], g[2]), q = MR_OF_OPEN(Q[0], Q[3], Q[5]);
    const mr_lane end = MR_OF_OPEN(r[0], r[1], r[2]), above = s + c, below = s - c;
    const mr_lane peak_slope =
        MR_LANE_SELECT(q < 0.0, above, below); /* q tells which has a peak */
    const mr_lane peak = peak_slope / (-2.0 * q), peak_value = 0.5 * (peak_slope * peak);
    const mr_lane_mask inside = MR_LANE_ABS(peak) <= end;
    const mr_lane at_end = q * end * end;
    const mr_lane most =
        MR_LANE_SELECT((q < 0.0) & inside, peak_value, at_end + MR_LANE_ABS(above) * end);
    const mr_lane least =
        MR_LANE_SELECT((q > 0.0) & inside, peak_value, at_end - MR_LANE_ABS(below) * end);
    *hi = MR_LANE_SELECT(some, (curved + rest) + most, *hi);
    *lo = MR_LANE_SELECT(some, (curved - rest) + least, *lo);
    const mr_lane_mask several = (open[0] & open[1]) | (open[0] & open[2]) | (open[1] & open[2]);
    if (!mr_lane_any(several)) return;

    mr_quadratic negative;
    for (int k = 0; k < 3; ++k) negative.g[k] = -g[k];
    for (int k = 0; k < 6; ++k) negative.Q[k] = -Q[k];
    const mr_lane highest = mr_max_by_faces(f, r), lowest = -mr_max_by_faces(&negative, r);
    *hi = MR_LANE_SELECT(several, highest, *hi);
    *lo = MR_LANE_SELECT(several, lowest, *lo);
}

/* lo, hi <- the exact range of g . x - k x . x over the box |x - shift| <= r, (18f): one parabola a
 * component. */
static inline void mr_separable_range(const mr_lane g[3], mr_lane k, const double shift[3],
                                      const double radius[3], mr_lane *lo, mr_lane *hi) {
    const mr_lane zero = MR_LANE_SPLAT(0.0);
    *lo = *hi = zero;
    for (int i = 0; i < 3; ++i) {
        const mr_lane bend = k * radius[i], bent = bend * radius[i];
        const mr_lane middle = g[i] - k * shift[i], slope = middle - k * shift[i];
        const mr_lane size = MR_LANE_ABS(slope), reach = size * radius[i];
        const mr_lane at_middle = middle * shift[i];
        const mr_lane_mask inside = size < 2.0 * MR_LANE_ABS(bend);
        mr_lane least = -reach - bent, most = reach - bent;
        if (mr_lane_any(inside)) {
            const mr_lane peak = 0.5 * (slope * (slope / (2.0 * k)));
            least = MR_LANE_SELECT(inside & (k < 0.0), peak, least);
            most = MR_LANE_SELECT(inside & (k > 0.0), peak, most);
        }
        *lo += at_middle + least;
        *hi += at_middle + most;
    }
}

#endif
