/* IANEA*: Algorithm 1 of the paper from A1:23 on, several bodies a link; A1:23 is line 23 there.
 *
 * Boxes are mid +- rad: what is linear, with real factors, takes mid as any vector and rad by the
 * factors' sizes, which is the same box as by lower and upper ends. All rounding, that of mid and of
 * the motion, the rotations and the levers, is put into rad, (27). */
#include "mr_internal.h"
#include "mr_rounding.h"

/* a (x) b by sizes: the radius of a cross product with a box of radius b */
#define ADD_CROSS_SIZES(a, b, out)                     \
    do {                                               \
        (out)[0] += (a)[1] * (b)[2] + (a)[2] * (b)[1]; \
        (out)[1] += (a)[2] * (b)[0] + (a)[0] * (b)[2]; \
        (out)[2] += (a)[0] * (b)[1] + (a)[1] * (b)[0]; \
    } while (0)

#define SIZES_3(ABS, x) {ABS((x)[0]), ABS((x)[1]), ABS((x)[2])}

/* A bound of the norm of every point of a box. */
#define BOX_NORM(ABS, mid, rad)                              \
    (((ABS((mid)[0]) + ABS((mid)[1])) + ABS((mid)[2])) +     \
     (((rad)[0] + (rad)[1]) + (rad)[2]))

/* out = R box, with `error` of every point's norm on top */
#define ROTATE_BOX(NUMBER, ABS, R, error, mid, rad, out_mid, out_rad)                      \
    do {                                                                                   \
        const NUMBER more_ = (error) * BOX_NORM(ABS, mid, rad) + MR_ETA;                   \
        mr_rotate(R, mid, out_mid);                                                        \
        for (int k_ = 0; k_ < 3; ++k_)                                                     \
            (out_rad)[k_] = ((ABS((R)[3 * k_]) * (rad)[0] + ABS((R)[3 * k_ + 1]) * (rad)[1]) + \
                             ABS((R)[3 * k_ + 2]) * (rad)[2]) + more_;                     \
    } while (0)

/* moment += lever (x) force, with `error` of every force's norm on top */
#define ADD_MOMENT(NUMBER, ABS, lever, error, f_mid, f_rad, n_mid, n_rad)                  \
    do {                                                                                   \
        const NUMBER long_[3] = SIZES_3(ABS, lever);                                       \
        const NUMBER more_ = (error) * BOX_NORM(ABS, f_mid, f_rad) + MR_ETA;               \
        mr_add_cross(lever, f_mid, n_mid);                                                 \
        ADD_CROSS_SIZES(long_, f_rad, n_rad);                                              \
        for (int k_ = 0; k_ < 3; ++k_) (n_rad)[k_] += more_;                               \
    } while (0)

/* The product of two intervals, exactly the range of its four corners. */
static inline void product(mr_lane x, mr_lane x_rad, mr_lane y, mr_lane y_rad, mr_lane *mid,
                           mr_lane *rad) {
    const mr_lane a = x_rad * y, b = x * y_rad, c = x_rad * y_rad;
    const mr_lane same = MR_LANE_ABS(a + b), other = MR_LANE_ABS(a - b);
    const mr_lane up_same = same + c, up_other = other - c;
    const mr_lane down_same = same - c, down_other = other + c;
    const mr_lane up = MR_LANE_SELECT(up_same > up_other, up_same, up_other);
    const mr_lane down = MR_LANE_SELECT(down_same > down_other, down_same, down_other);
    *mid = x * y + 0.5 * (up - down);
    *rad = 0.5 * (up + down);
}

/* The same where the first is a mass: none is negative. */
static inline void times_mass(mr_lane mass, mr_lane mass_rad, mr_lane x, mr_lane x_rad,
                              mr_lane *mid, mr_lane *rad) {
    const mr_lane above = MR_LANE_ABS(x + x_rad), below = MR_LANE_ABS(x - x_rad);
    *mid = mass * x + 0.5 * (mass_rad * (above - below));
    *rad = mass * x_rad + 0.5 * (mass_rad * (above + below));
}

/* m (c x a + |c|^2 (w x wa)), (16f), over the box of m and c: what stands in for c x F where the
 * tensor is about the body frame's origin. With c = middle + d it is linear in d but for |d|^2,
 * which lies in [0, |radius|^2]. */
static inline void moment_about_frame(const mr_lane w[3], const mr_lane wa[3], const mr_lane a[3],
                                      const mr_lane point[4], const mr_lane radius[4],
                                      mr_lane mid[3], mr_lane rad[3]) {
    const mr_lane *c = point + 1, *c_rad = radius + 1;
    const mr_lane square = mr_dot(c, c), half = 0.5 * mr_dot(c_rad, c_rad);
    mr_lane bent[3], x[3];
    mr_cross(w, wa, bent);
    mr_cross(c, a, x);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const mr_lane twice = 2.0 * bent[k];
        const mr_lane slope_k = twice * c[k], slope_i = twice * c[i] + a[j];
        const mr_lane slope_j = twice * c[j] - a[i];
        const mr_lane x_rad =
            ((MR_LANE_ABS(slope_k) * c_rad[k] + MR_LANE_ABS(slope_i) * c_rad[i]) +
             MR_LANE_ABS(slope_j) * c_rad[j]) +
            MR_LANE_ABS(bent[k]) * half;
        times_mass(point[0], radius[0], x[k] + bent[k] * (square + half), x_rad, &mid[k], &rad[k]);
    }
}

/* A rate with its second-order terms; infinite where the proof ends. */
static inline MR_REAL second_order(MR_REAL rate) {
    return MR_SELECT(rate <= MR_RATE_MAX, rate * MR_SECOND_ORDER, MR_SPLAT((double)INFINITY));
}

/* Force and moment of a register of bodies, in link axes about the link's origin. */
static inline void body_box(const mr_model *model, const mr_bounds *bounds,
                            const mr_motion_size *size, MR_REAL error, MR_REAL *bodies,
                            int32_t b) {
    const size_t stride = mr_body_stride(model);
    const double *box = mr_ranges(model, bounds);
    mr_lane from[MR_E], point[MR_POINT], radius[MR_POINT], sizes[3];
    for (size_t k = 0; k < MR_E; ++k) from[k] = MR_TAKE(bodies + k * stride, b);
    for (size_t k = 0; k < MR_POINT; ++k) {
        point[k] = MR_TAKE_CONSTANT(box + k * stride, b);
        radius[k] = MR_TAKE_CONSTANT(box + (MR_POINT + k) * stride, b);
    }
    for (size_t k = 0; k < 3; ++k)
        sizes[k] = MR_TAKE_CONSTANT(box + (2 * MR_POINT + k) * stride, b);
    const mr_lane *w = from + MR_W, *wa = from + MR_WA, *dw = from + MR_DW;
    const mr_lane *a = from + MR_A, *L = from + MR_L;
    const mr_lane mass = point[0], mass_rad = radius[0]; /* A1:5 */
    const mr_lane *c = point + 1, *c_rad = radius + 1, *I = point + 4, *I_rad = radius + 4;
    const mr_lane w_size[3] = SIZES_3(MR_LANE_ABS, w), wa_size[3] = SIZES_3(MR_LANE_ABS, wa);
    const mr_lane dw_size[3] = SIZES_3(MR_LANE_ABS, dw), zero = MR_LANE_SPLAT(0.0);
    mr_lane e[3], e_rad[3] = {zero, zero, zero}, rotated[3] = {zero, zero, zero};
    mr_lane F[3], F_rad[3], N[3], N_rad[3], Iw[3], Iw_rad[3], M[3], M_rad[3];

    mr_rotate(L, c, e); /* A1:23 */
    mr_add(a, e);
    ADD_CROSS_SIZES(dw_size, c_rad, e_rad);
    ADD_CROSS_SIZES(wa_size, c_rad, rotated);
    ADD_CROSS_SIZES(w_size, rotated, e_rad);
    for (int k = 0; k < 3; ++k) /* A1:27 */
        times_mass(mass, mass_rad, e[k], e_rad[k], &F[k], &F_rad[k]);
    mr_symmetric(I, dw, N); /* A1:30 */
    mr_symmetric(I_rad, dw_size, N_rad);
    mr_symmetric(I, w, Iw);
    mr_symmetric(I_rad, w_size, Iw_rad);
    mr_add_cross(wa, Iw, N);
    ADD_CROSS_SIZES(wa_size, Iw_rad, N_rad);
    for (int k = 0; k < 3; ++k) { /* A1:29 */
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        mr_lane first, first_rad, second, second_rad;
        product(c[i], c_rad[i], F[j], F_rad[j], &first, &first_rad);
        product(c[j], c_rad[j], F[i], F_rad[i], &second, &second_rad);
        M[k] = first - second;
        M_rad[k] = first_rad + second_rad;
    }
    if (mr_of_model(model)->framed != 0.0) {
        const mr_lane_mask framed = MR_TAKE_CONSTANT(mr_abouts(model), b) != 0.0;
        mr_lane own[3], own_rad[3];
        moment_about_frame(w, wa, a, point, radius, own, own_rad);
        for (int k = 0; k < 3; ++k) {
            M[k] = MR_LANE_SELECT(framed, own[k], M[k]);
            M_rad[k] = MR_LANE_SELECT(framed, own_rad[k], M_rad[k]);
        }
    }
    mr_add(M, N);
    mr_add(M_rad, N_rad);

    const mr_lane mass_max = mass + mass_rad, reach = sizes[0], lever = sizes[1],
                  inertia = sizes[2];
    const mr_lane distance = reach + size->prismatic_reach,
                  force = mass_max * (size->acceleration + size->rotation * distance);
    const mr_lane underflow =
        size->underflow * ((1.0 + distance) * (1.0 + distance)) * (1.0 + mass_max);
    const mr_lane F_more = error * force + underflow;
    const mr_lane N_more = error * (lever * force + size->rotation * inertia) +
                           (underflow * (1.0 + lever)) * (1.0 + inertia);
    for (int k = 0; k < 3; ++k) {
        F_rad[k] += F_more;
        N_rad[k] += N_more;
    }
    if (mr_of_model(model)->placements != MR_IDENTITY) {
        const double *T = mr_placements(model);
        mr_lane R[9], p[3], f[3], f_rad[3], n[3], n_rad[3];
        for (size_t k = 0; k < 9; ++k) R[k] = MR_TAKE_CONSTANT(T + k * stride, b);
        for (size_t k = 0; k < 3; ++k) p[k] = MR_TAKE_CONSTANT(T + (9 + k) * stride, b);
        const double turn = (MR_CONSTANT_ROTATION + MR_BOX_ROTATION) * MR_U;
        const mr_lane length = (MR_LANE_ABS(p[0]) + MR_LANE_ABS(p[1])) + MR_LANE_ABS(p[2]);
        const mr_lane moment =
            ((MR_CONSTANT_LEVER + MR_BOX_MOMENT) * MR_U) * length + MR_UNDERFLOW;
        ROTATE_BOX(mr_lane, MR_LANE_ABS, R, turn, F, F_rad, f, f_rad);
        ROTATE_BOX(mr_lane, MR_LANE_ABS, R, turn, N, N_rad, n, n_rad);
        ADD_MOMENT(mr_lane, MR_LANE_ABS, p, moment, f, f_rad, n, n_rad);
        mr_copy(f, F);
        mr_copy(f_rad, F_rad);
        mr_copy(n, N);
        mr_copy(n_rad, N_rad);
    }
    for (size_t k = 0; k < 3; ++k) {
        MR_PUT(F[k], bodies + (MR_BOX + k) * stride, b);
        MR_PUT(F_rad[k], bodies + (MR_BOX + 3 + k) * stride, b);
        MR_PUT(N[k], bodies + (MR_BOX + 6 + k) * stride, b);
        MR_PUT(N_rad[k], bodies + (MR_BOX + 9 + k) * stride, b);
    }
}

/* sum += x */
static inline void accumulate(const MR_REAL mid[3], const MR_REAL rad[3], MR_REAL sum_mid[3],
                              MR_REAL sum_rad[3]) {
    for (int k = 0; k < 3; ++k) {
        sum_mid[k] += mid[k];
        sum_rad[k] = (sum_rad[k] + rad[k]) + MR_PHI * MR_ABS(sum_mid[k]);
    }
}

static void add_box(const mr_wrench_box *x, mr_wrench_box *sum) {
    accumulate(x->f, x->f_rad, sum->f, sum->f_rad);
    accumulate(x->n, x->n_rad, sum->n, sum->n_rad);
}

static void sum_of_bodies(const mr_model *model, const mr_workspace *ws) {
    const size_t stride = mr_body_stride(model);
    mr_wrench_box *wrenches = ws->wrench.box;
    for (int32_t i = 0; i < model->j; ++i) /* A1:25 */
        for (int k = 0; k < 3; ++k)
            wrenches[i].f[k] = wrenches[i].f_rad[k] = wrenches[i].n[k] = wrenches[i].n_rad[k] =
                MR_SPLAT(0.0);
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        const MR_REAL *from = ws->bodies + MR_BOX * stride + b;
        mr_wrench_box own;
        for (size_t k = 0; k < 3; ++k) {
            own.f[k] = from[k * stride];
            own.f_rad[k] = from[(3 + k) * stride];
            own.n[k] = from[(6 + k) * stride];
            own.n_rad[k] = from[(9 + k) * stride];
        }
        add_box(&own, &wrenches[model->body_joint[b]]);
    }
}

void mr_ianea(const mr_model *model, const mr_bounds *bounds, const mr_motion_size *size,
              const mr_workspace *ws) {
    const double depth = mr_of_model(model)->depth, summed = model->b + model->j;
    const double defect = MR_DEFECTS * mr_of_model(model)->defect;
    const double body_rate = MR_MOTION_JOINT * depth + MR_MOTION_ONCE + MR_BOX_BODY;
    const MR_REAL body_error = second_order(defect + MR_U * (body_rate + 2.0 * size->mimic_angle));
    const MR_REAL turn_error =
        second_order(defect + MR_U * (MR_ROTATION + MR_BOX_ROTATION + size->mimic_angle));
    const double growth =
        1.0 + MR_U * (MR_RADIUS_JOINT * depth + MR_RADIUS_ONCE + MR_RADIUS_SUM * summed);
    mr_wrench_box *wrenches = ws->wrench.box;
    mr_wrench_box carried; /* to `parent` */
    int32_t parent = -1;
    for (int32_t b = 0; b < model->b; b += MR_BLOCK)
        body_box(model, bounds, size, body_error, ws->bodies, b);
    sum_of_bodies(model, ws);

    for (int32_t i = model->j - 1; i >= 0; --i) { /* A1:26 */
        const mr_link *link = &ws->links[i];
        const double *z = model->after[i].R + 6, *before = model->before[i].p;
        const mr_joint_constants *constants = &mr_of_joints(model)[i];
        const double z_size[3] = SIZES_3(fabs, z);
        MR_REAL length = MR_SPLAT(constants->lever_norm);
        if (parent >= 0 && parent != i) add_box(&carried, &wrenches[parent]); /* a branch */
        mr_wrench_box own = wrenches[i];
        if (parent == i) add_box(&carried, &own);
        if (model->joint_type[i] != MR_REVOLUTE) length += size->prismatic_reach;
        const MR_REAL lever_error = (MR_U * (MR_LEVER + MR_BOX_MOMENT)) * length + MR_UNDERFLOW;
        ADD_MOMENT(MR_REAL, MR_ABS, link->p, lever_error, own.f, own.f_rad, own.n,
                   own.n_rad); /* A1:30 */
        const int revolute = model->joint_type[i] == MR_REVOLUTE;
        const MR_REAL *along = revolute ? own.n : own.f;
        const MR_REAL *along_rad = revolute ? own.n_rad : own.f_rad;
        const MR_REAL mid = mr_dot(along, z); /* A1:32, A1:34 */
        const MR_REAL rad =
            mr_dot(along_rad, z_size) +
            (MR_U * (MR_CONSTANT_AXIS + MR_BOX_AXIS)) * BOX_NORM(MR_ABS, along, along_rad) +
            MR_ETA;
        ws->lo[i] = mr_down(mid - rad * growth);
        ws->hi[i] = mr_up(mid + rad * growth);
        parent = model->parent[i];
        if (parent < 0) continue;
        ROTATE_BOX(MR_REAL, MR_ABS, link->R, turn_error, own.f, own.f_rad, carried.f,
                   carried.f_rad); /* A1:28 */
        ROTATE_BOX(MR_REAL, MR_ABS, link->R, turn_error, own.n, own.n_rad, carried.n,
                   carried.n_rad); /* A1:29 */
        if (constants->before != MR_IDENTITY) {
            const double error =
                (MR_U * (MR_CONSTANT_LEVER + MR_BOX_MOMENT)) * constants->before_norm +
                MR_UNDERFLOW;
            MR_REAL lever[3];
            mr_splat(before, lever);
            ADD_MOMENT(MR_REAL, MR_ABS, lever, error, carried.f, carried.f_rad, carried.n,
                       carried.n_rad);
        }
    }
}

void mr_fold_mimic_box(const mr_model *model, MR_REAL *lo, MR_REAL *hi) {
    const int32_t n = model->n, *moves = model->moves;
    if (model->j == n) return;
    for (int32_t k = 0; k < model->j - n; ++k) {
        const int32_t leader = moves[model->leader[k]], own = moves[n + k];
        mr_interval share =
            mr_i_scale(MR_SPLAT(model->multiplier[k]), (mr_interval){lo[own], hi[own]});
        share = mr_i_widen(share, 2.0 * MR_U * mr_i_size(share)); /* as written in decimals */
        const mr_interval sum = mr_i_add((mr_interval){lo[leader], hi[leader]}, share);
        lo[leader] = sum.lo;
        hi[leader] = sum.hi;
    }
    for (int32_t i = 0; i < n; ++i) {
        lo[i] = lo[moves[i]];
        hi[i] = hi[moves[i]];
    }
}
