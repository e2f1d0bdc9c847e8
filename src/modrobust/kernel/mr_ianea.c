/* IANEA*: Algorithm 1 of the paper from line 23 on, several bodies a link. Line numbers at right.
 *
 * Every interval operation encloses its rounding. The motion, the rotations and the levers are
 * real numbers with an error of their own: boxes are widened by it, (27). */
#include "mr_internal.h"
#include "mr_rounding.h"

/* A rate with its second-order terms; infinite where the proof ends. */
static MR_REAL second_order(MR_REAL rate) {
    return MR_SELECT(rate <= MR_RATE_MAX, rate * MR_SECOND_ORDER, MR_SPLAT((double)INFINITY));
}

static void widen(MR_REAL radius, mr_interval x[3]) {
    for (int k = 0; k < 3; ++k) x[k] = mr_i_widen(x[k], radius);
}

/* out = R [x] for a rotation R that is known up to `error` in the Frobenius norm. */
static void rotate_box(const MR_REAL R[9], MR_REAL error, const mr_interval x[3],
                       mr_interval out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = mr_i_dot(R[3 * k], R[3 * k + 1], R[3 * k + 2], x);
    widen(error * mr_i_norm(x), out);
}

/* moment += lever (x) [force] for a lever that is known up to `error` and underflow. */
static void add_moment(MR_REAL l0, MR_REAL l1, MR_REAL l2, MR_REAL error,
                       const mr_interval force[3], mr_interval moment[3]) {
    mr_interval part[3];
    mr_i_cross_real(l0, l1, l2, force, part);
    widen((error + MR_UNDER) * mr_i_norm(force), part);
    mr_i_accumulate(part, moment);
}

static void add_body_box(const mr_model *model, const mr_bounds *bounds,
                         const mr_motion_size *size, MR_REAL motion_error, int32_t b,
                         const MR_REAL *bodies, mr_wrench_box *link) {
    const mr_parameters *lower = &bounds->lower, *upper = &bounds->upper;
    const mr_transform *T = &model->placement[b];
    const mr_body_sizes *own = &mr_sizes_of_bodies(model, bounds)[b];
    mr_interval c[3], I[6], F[3], N[3], part[3], turned[3];
    MR_REAL m[MR_MOTION];
    const MR_REAL *w = m + MR_W, *wa = m + MR_WA, *dw = m + MR_DW, *a = m + MR_A;
    for (size_t k = 0; k < MR_MOTION; ++k) m[k] = bodies[k * mr_body_stride(model) + (size_t)b];
    for (int k = 0; k < 3; ++k) /* 5 */
        c[k] = (mr_interval){MR_SPLAT(lower->com[3 * b + k]), MR_SPLAT(upper->com[3 * b + k])};
    for (int k = 0; k < 6; ++k)
        I[k] = (mr_interval){MR_SPLAT(lower->inertia[6 * b + k]),
                             MR_SPLAT(upper->inertia[6 * b + k])};

    for (int k = 0; k < 3; ++k) F[k] = (mr_interval){a[k], a[k]}; /* 23 */
    mr_i_cross_real(dw[0], dw[1], dw[2], c, part);
    mr_i_accumulate(part, F);
    mr_i_cross_real(wa[0], wa[1], wa[2], c, part);
    mr_i_cross_real(w[0], w[1], w[2], part, turned);
    mr_i_accumulate(turned, F);
    const MR_REAL way = own->reach + size->out;
    const MR_REAL under = size->under * (1.0 + way) * (1.0 + way);
    widen(motion_error * (size->a + size->k * way) + under, F);
    const mr_interval mass = {MR_SPLAT(lower->mass[b]), MR_SPLAT(upper->mass[b])};
    for (int k = 0; k < 3; ++k) F[k] = mr_i_mul(mass, F[k]); /* 27 */

    mr_i_cross(c, F, N);                                     /* 29 */
    const mr_interval rows[9] = {I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5]};
    for (int k = 0; k < 3; ++k)
        N[k] = mr_i_add(N[k], mr_i_dot(dw[0], dw[1], dw[2], rows + 3 * k)); /* 30 */
    for (int k = 0; k < 3; ++k) part[k] = mr_i_dot(w[0], w[1], w[2], rows + 3 * k);
    mr_i_cross_real(wa[0], wa[1], wa[2], part, turned);
    mr_i_accumulate(turned, N);
    widen(motion_error * size->k * own->inertia +
              under * (1.0 + own->inertia + upper->mass[b]), N);

    if (mr_of_model(model)->placements != MR_IDENTITY) {
        MR_REAL R[9];
        for (int k = 0; k < 9; ++k) R[k] = MR_SPLAT(T->R[k]);
        rotate_box(R, MR_SPLAT(MR_CONSTANT_ROTATION * MR_U), F, turned);
        rotate_box(R, MR_SPLAT(MR_CONSTANT_ROTATION * MR_U), N, part);
        for (int k = 0; k < 3; ++k) F[k] = turned[k], N[k] = part[k];
        const double length = fabs(T->p[0]) + fabs(T->p[1]) + fabs(T->p[2]);
        add_moment(MR_SPLAT(T->p[0]), MR_SPLAT(T->p[1]), MR_SPLAT(T->p[2]),
                   MR_SPLAT(MR_CONSTANT_LEVER * MR_U * length), F, N);
    }
    mr_i_accumulate(F, link->f);
    mr_i_accumulate(N, link->n);
}

void mr_ianea(const mr_model *model, const mr_bounds *bounds, const mr_motion_size *size,
              const mr_workspace *ws) {
    const double motion_rate = MR_MOTION_JOINT * mr_of_model(model)->depth + MR_MOTION_ONCE;
    const double defect = MR_DEFECTS * mr_of_model(model)->defect;
    const MR_REAL motion_error =
        second_order(defect + MR_U * (motion_rate + 2.0 * size->followed));
    const MR_REAL turn_error = second_order(defect + MR_U * (MR_ROTATION + size->followed));
    const mr_interval zero = {MR_SPLAT(0.0), MR_SPLAT(0.0)};
    mr_wrench_box *wrenches = ws->wrench.box;
    for (int32_t i = 0; i < model->j; ++i) /* 25 */
        for (int k = 0; k < 3; ++k) wrenches[i].f[k] = wrenches[i].n[k] = zero;
    for (int32_t b = 0; b < model->b; ++b)
        if (model->body_joint[b] >= 0)
            add_body_box(model, bounds, size, motion_error, b, ws->bodies,
                         &wrenches[model->body_joint[b]]);

    for (int32_t i = model->j - 1; i >= 0; --i) { /* 26 */
        const mr_link *link = &ws->links[i];
        const double *z = model->after[i].R + 6, *lever = model->before[i].p;
        const mr_joint_constants *constants = &mr_of_joints(model)[i];
        const MR_REAL z_error = MR_SPLAT(MR_CONSTANT_AXIS * MR_U);
        mr_wrench_box *own = &wrenches[i];
        mr_interval f[3], n[3];
        MR_REAL length = MR_SPLAT(constants->lever_norm);
        if (model->joint_type[i] != MR_REVOLUTE) length += size->out;
        add_moment(link->p[0], link->p[1], link->p[2], MR_LEVER * MR_U * length, own->f,
                   own->n); /* 30 */
        const mr_interval *along = model->joint_type[i] == MR_REVOLUTE ? own->n : own->f;
        const mr_interval u = mr_i_widen(
            mr_i_dot(MR_SPLAT(z[0]), MR_SPLAT(z[1]), MR_SPLAT(z[2]), along), /* 32, 34 */
            z_error * mr_i_norm(along));
        ws->lo[i] = u.lo;
        ws->hi[i] = u.hi;
        if (model->parent[i] < 0) continue;
        mr_wrench_box *parent = &wrenches[model->parent[i]];
        rotate_box(link->R, turn_error, own->f, f); /* 28 */
        rotate_box(link->R, turn_error, own->n, n); /* 29 */
        if (constants->before != MR_IDENTITY)
            add_moment(MR_SPLAT(lever[0]), MR_SPLAT(lever[1]), MR_SPLAT(lever[2]),
                       MR_SPLAT(MR_CONSTANT_LEVER * MR_U * constants->before_norm), f, n);
        mr_i_accumulate(f, parent->f);
        mr_i_accumulate(n, parent->n);
    }
}

void mr_lead_box(const mr_model *model, MR_REAL *lo, MR_REAL *hi) {
    for (int32_t k = 0; k < model->j - model->n; ++k) {
        const int32_t leader = model->leader[k], own = model->n + k;
        mr_interval share =
            mr_i_scale(MR_SPLAT(model->multiplier[k]), (mr_interval){lo[own], hi[own]});
        share = mr_i_widen(share, 2.0 * MR_U * mr_i_size(share)); /* as written in decimals */
        const mr_interval sum = mr_i_add((mr_interval){lo[leader], hi[leader]}, share);
        lo[leader] = sum.lo;
        hi[leader] = sum.hi;
    }
}
