/* The exact range of the torque over the box of parameters, body by body: (17) to (19).
 *
 * Everything is a difference from the nominal point, so that exact parameters cost nothing.
 * Rounding is to nearest here; mr_hull_slack bounds it. One text for both uses of a register: for
 * one state its lanes are joints, in a batch they are states. */
#include "mr_internal.h"
#include "mr_quadratic.h"

/* Links in the base frame; axes: per joint the axis as it turns (zero if prismatic), the axis as
 * it shifts (zero if revolute), and the joint frame's origin. */
static void forward_poses(const mr_model *model, const mr_link *links, mr_pose *poses,
                          MR_REAL *axes) {
    const size_t stride = mr_padded(model);
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_link *link = &links[i];
        const double *lever = model->before[i].p, *B = model->before[i].R;
        const int revolute = model->joint_type[i] == MR_REVOLUTE;
        mr_pose *pose = &poses[i];
        MR_REAL axis[3], point[3];
        if (model->parent[i] < 0) {
            for (int k = 0; k < 9; ++k) pose->R[k] = link->R[k];
            for (int k = 0; k < 3; ++k) axis[k] = MR_SPLAT(B[3 * k + 2]);
            mr_splat(lever, point);
        } else {
            const mr_pose *parent = &poses[model->parent[i]];
            const double kind = mr_of_joints(model)[i].before;
            mr_multiply(parent->R, link->R, pose->R);
            mr_copy(parent->origin, point);
            if (kind != MR_IDENTITY) {
                MR_REAL arm[3];
                mr_rotate(parent->R, lever, arm);
                mr_add(arm, point);
            }
            if (kind == MR_GENERAL) { /* the third column of parent->R B */
                const double column[3] = {B[2], B[5], B[8]};
                mr_rotate(parent->R, column, axis);
            } else {
                for (int k = 0; k < 3; ++k) axis[k] = parent->R[3 * k + 2];
            }
        }
        mr_rotate(pose->R, link->p, pose->origin);
        mr_add(point, pose->origin);
        for (size_t k = 0; k < 3; ++k) {
            axes[k * stride + (size_t)i] = revolute ? axis[k] : MR_SPLAT(0.0);
            axes[(3 + k) * stride + (size_t)i] = revolute ? MR_SPLAT(0.0) : axis[k];
            axes[(6 + k) * stride + (size_t)i] = point[k];
        }
    }
}

/* What one uncertain body has in common for all joints that carry it; lanes. */
typedef struct {
    mr_lane w[3], wa[3], dw[3], L[9];
    mr_lane e[3];   /* acceleration of the nominal COM, body axes */
    mr_lane R[9];   /* body to base */
    mr_lane com[3]; /* nominal COM from the base origin, base axes */
} mr_uncertain_body;

#ifdef MR_BATCH
#define TO_LANES(x) (x)
#else
#define TO_LANES(x) MR_LANE_SPLAT(x)
#endif

static void uncertain_body(const mr_model *model, const mr_bounds *bounds, const mr_motion *m,
                           const mr_pose *pose, int32_t b, mr_uncertain_body *body) {
    const mr_transform *T = &model->placement[b];
    const double *com = bounds->nominal.com + 3 * b;
    const double kind = mr_of_bodies(model)[b].placement;
    MR_REAL R[9], arm[3], e[3], position[3];
    if (kind == MR_GENERAL)
        mr_multiply(pose->R, T->R, R);
    else
        for (int k = 0; k < 9; ++k) R[k] = pose->R[k];
    mr_copy(pose->origin, position);
    if (kind != MR_IDENTITY) {
        mr_rotate(pose->R, T->p, arm);
        mr_add(arm, position);
    }
    mr_rotate(R, com, arm);
    mr_add(arm, position);
    mr_rotate(m->L, com, e);
    mr_add(m->a, e);
    for (int k = 0; k < 3; ++k) {
        body->w[k] = TO_LANES(m->w[k]);
        body->wa[k] = TO_LANES(m->wa[k]);
        body->dw[k] = TO_LANES(m->dw[k]);
        body->e[k] = TO_LANES(e[k]);
        body->com[k] = TO_LANES(position[k]);
    }
    for (int k = 0; k < 9; ++k) {
        body->L[k] = TO_LANES(m->L[k]);
        body->R[k] = TO_LANES(R[k]);
    }
}

/* Range of one body's torque on the joint of each lane, less the nominal, (18). */
static inline void deviation(const mr_uncertain_body *body, const mr_body_box *box,
                             int prismatic, const mr_lane axis[9], mr_lane_mask active,
                             mr_lane *lo, mr_lane *hi) {
    const mr_lane *L = body->L, *e = body->e, *w = body->w, *dw = body->dw;
    const mr_lane *point = axis + 6;
    mr_lane s[3], arm[3], x[3], v[3], swa[3];
    mr_quadratic f;
    for (int k = 0; k < 3; ++k) arm[k] = body->com[k] - point[k];
    mr_unrotate(body->R, axis, s);
    mr_unrotate(body->R, arm, x);
    mr_cross(s, x, v);
    if (prismatic) {
        mr_lane along[3];
        mr_unrotate(body->R, axis + 3, along);
        mr_add(along, v);
    }
    mr_lane f0 = mr_dot(v, e);
    mr_unrotate(L, v, f.g);
    mr_add_cross(e, s, f.g);
    /* sym([s]x' L): row i of [s]x' L is column i of [s]x, crossed into the columns of L */
    f.Q[0] = s[2] * L[3] - s[1] * L[6];
    f.Q[1] = 0.5 * ((s[2] * L[4] - s[1] * L[7]) + (s[0] * L[6] - s[2] * L[0]));
    f.Q[2] = 0.5 * ((s[2] * L[5] - s[1] * L[8]) + (s[1] * L[0] - s[0] * L[3]));
    f.Q[3] = s[0] * L[7] - s[2] * L[1];
    f.Q[4] = 0.5 * ((s[0] * L[8] - s[2] * L[2]) + (s[1] * L[1] - s[0] * L[4]));
    f.Q[5] = s[1] * L[2] - s[0] * L[5];
    /* < sym(s dw' + (s x wa) w'), I >: off-diagonal entries count twice */
    mr_cross(s, body->wa, swa);
    const mr_lane W[6] = {
        s[0] * dw[0] + swa[0] * w[0],
        (s[0] * dw[1] + s[1] * dw[0]) + (swa[0] * w[1] + swa[1] * w[0]),
        (s[0] * dw[2] + s[2] * dw[0]) + (swa[0] * w[2] + swa[2] * w[0]),
        s[1] * dw[1] + swa[1] * w[1],
        (s[1] * dw[2] + s[2] * dw[1]) + (swa[1] * w[2] + swa[2] * w[1]),
        s[2] * dw[2] + swa[2] * w[2],
    };
    mr_lane spread = MR_LANE_ABS(W[0]) * box->inertia_radius[0];
    for (int k = 1; k < 6; ++k) spread += MR_LANE_ABS(W[k]) * box->inertia_radius[k];

    const mr_lane r[3] = {MR_LANE_SPLAT(box->com_radius[0]), MR_LANE_SPLAT(box->com_radius[1]),
                          MR_LANE_SPLAT(box->com_radius[2])};
    mr_lane shift = MR_LANE_SPLAT(0.0), least, most;
    if (box->off_centre != 0.0) { /* to the middle of the box of COMs */
        const double *h = box->com_shift;
        mr_lane Qh[3], middle[3];
        mr_symmetric(f.Q, h, Qh);
        for (int k = 0; k < 3; ++k) middle[k] = f.g[k] + Qh[k];
        shift = mr_dot(middle, h);
        for (int k = 0; k < 3; ++k) f.g[k] = middle[k] + Qh[k];
    }
    mr_quadratic_range(&f, r, active, &least, &most);
    least += shift;
    most += shift;
    const mr_lane spread_lo = MR_LANE_ABS(f0 + least) * box->mass_radius + spread;
    const mr_lane spread_hi = MR_LANE_ABS(f0 + most) * box->mass_radius + spread;
    *lo = box->mass_middle * least - spread_lo;
    *hi = box->mass_middle * most + spread_hi;
    if (box->off_centre != 0.0) {
        mr_lane moved = box->mass_shift * f0;
        for (int k = 0; k < 6; ++k) moved += W[k] * box->inertia_shift[k];
        *lo += moved;
        *hi += moved;
    }
}

#ifdef MR_BATCH

static void add_to_joints(const mr_model *model, const mr_uncertain_body *body,
                          const mr_body_box *box, int32_t b, const MR_REAL *axes, MR_REAL *lo,
                          MR_REAL *hi) {
    const size_t stride = mr_padded(model);
    const int prismatic = mr_of_model(model)->prismatic != 0.0;
    const mr_lane_mask all = MR_LANE_SPLAT(0.0) == 0.0;
    for (int32_t i = model->body_joint[b]; i >= 0; i = model->parent[i]) {
        mr_lane axis[9], least, most;
        for (size_t k = 0; k < 9; ++k) axis[k] = axes[k * stride + (size_t)i];
        deviation(body, box, prismatic, axis, all, &least, &most);
        lo[i] += least;
        hi[i] += most;
    }
}

#else

/* Whether joint `ancestor` carries the link of `joint`. */
static int carries(const mr_model *model, int32_t ancestor, int32_t joint) {
    while (joint > ancestor) joint = model->parent[joint];
    return joint == ancestor;
}

static void add_to_joints(const mr_model *model, const mr_uncertain_body *body,
                          const mr_body_box *box, int32_t b, const MR_REAL *axes, MR_REAL *lo,
                          MR_REAL *hi) {
    const size_t stride = mr_padded(model);
    const int prismatic = mr_of_model(model)->prismatic != 0.0;
    const int serial = mr_of_model(model)->serial != 0.0;
    const int32_t last = model->body_joint[b];
    for (int32_t first = 0; first <= last; first += MR_LANES) {
        double on[MR_LANES], count = 0.0;
        mr_lane axis[9], least, most;
        for (int32_t l = 0; l < MR_LANES; ++l) {
            const int32_t i = first + l;
            on[l] = i <= last && (serial || carries(model, i, last)) ? 1.0 : 0.0;
            count += on[l];
        }
        if (count == 0.0) continue;
        const mr_lane_mask active = mr_lane_load(on) == 1.0;
        for (size_t k = 0; k < 9; ++k) axis[k] = mr_lane_load(axes + k * stride + first);
        deviation(body, box, prismatic, axis, active, &least, &most);
        const mr_lane zero = MR_LANE_SPLAT(0.0);
        mr_lane_store(mr_lane_load(lo + first) + MR_LANE_SELECT(active, least, zero), lo + first);
        mr_lane_store(mr_lane_load(hi + first) + MR_LANE_SELECT(active, most, zero), hi + first);
    }
}

#endif

void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_link *links,
                       const mr_motion *motions, mr_pose *poses, MR_REAL *axes, MR_REAL *lo,
                       MR_REAL *hi) {
    const mr_body_box *boxes = mr_boxes(model, bounds);
    for (size_t i = 0; i < mr_padded(model); ++i) lo[i] = hi[i] = MR_SPLAT(0.0);
    if (bounds->uncertain_count == 0) return;
    for (size_t i = (size_t)model->j; i < mr_padded(model); ++i)
        for (size_t k = 0; k < 9; ++k) axes[k * mr_padded(model) + i] = MR_SPLAT(0.0);
    forward_poses(model, links, poses, axes);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k) {
        const int32_t b = bounds->uncertain[k];
        mr_uncertain_body body;
        if (model->body_joint[b] < 0) continue;
        uncertain_body(model, bounds, &motions[b], &poses[model->body_joint[b]], b, &body);
        add_to_joints(model, &body, &boxes[k], b, axes, lo, hi);
    }
}
