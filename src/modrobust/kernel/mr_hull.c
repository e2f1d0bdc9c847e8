/* The exact range of the torque over the box of parameters, body by body: (17) to (19), (18f).
 *
 * Everything is a difference from the nominal point, so that exact parameters cost nothing.
 * Rounding is to nearest here; mr_rounding_slack bounds it. One text for both uses of a register:
 * for one state its lanes are joints, in a batch they are states. */
#include "mr_internal.h"
#include "mr_quadratic.h"

/* Links from their first joint, in base axes; axes: per joint the axis as it turns (zero if
 * prismatic), the axis as it shifts (zero if revolute), and the joint frame's origin. */
static void forward_poses(const mr_model *model, int32_t last, const mr_workspace *ws) {
    const size_t stride = mr_joint_stride(model);
    for (int32_t i = 0; i <= last; ++i) {
        const mr_link *link = &ws->links[i];
        const double *lever = model->before[i].p, *B = model->before[i].R;
        const MR_REAL zero = MR_SPLAT(0.0);
        mr_pose *pose = &ws->poses[i];
        MR_REAL axis[3], point[3];
        if (model->parent[i] < 0) {
            for (int k = 0; k < 9; ++k) pose->R[k] = link->R[k];
            for (int k = 0; k < 3; ++k) axis[k] = MR_SPLAT(B[3 * k + 2]);
            for (int k = 0; k < 3; ++k) point[k] = zero; /* distances start at the first joint */
        } else {
            const mr_pose *parent = &ws->poses[model->parent[i]];
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
        const int revolute = model->joint_type[i] == MR_REVOLUTE;
        for (size_t k = 0; k < 3; ++k) {
            ws->axes[k * stride + (size_t)i] = revolute ? axis[k] : zero;
            ws->axes[(3 + k) * stride + (size_t)i] = revolute ? zero : axis[k];
            ws->axes[(6 + k) * stride + (size_t)i] = point[k];
        }
    }
}

/* What one uncertain body has in common for all joints that carry it. Its point is the nominal COM,
 * or its frame's origin where that is what its tensor is about. */
typedef struct {
    MR_REAL w[3], wa[3], dw[3], L[9];
    MR_REAL e[3];     /* acceleration of the point, body axes */
    MR_REAL R[9];     /* body to base */
    MR_REAL point[3]; /* from the first joint, base axes */
} mr_uncertain_body;

static void uncertain_body(const mr_model *model, const mr_bounds *bounds, int32_t b,
                           const mr_workspace *ws, mr_uncertain_body *body) {
    const size_t stride = mr_body_stride(model);
    const MR_REAL *from = ws->bodies + b;
    const mr_pose *pose = &ws->poses[model->body_joint[b]];
    const mr_transform *T = &model->placement[b];
    const double *com = bounds->nominal.com + 3 * b;
    const int framed = model->inertia_about[b] == MR_ABOUT_FRAME;
    const size_t at = framed ? MR_A : MR_E;
    MR_REAL arm[3];
    for (size_t k = 0; k < 3; ++k) {
        body->w[k] = from[(MR_W + k) * stride];
        body->wa[k] = from[(MR_WA + k) * stride];
        body->dw[k] = from[(MR_DW + k) * stride];
        body->e[k] = from[(at + k) * stride];
    }
    for (size_t k = 0; k < 9; ++k) body->L[k] = from[(MR_L + k) * stride];
    mr_copy(pose->origin, body->point);
    if (mr_of_model(model)->placements == MR_IDENTITY) {
        for (int k = 0; k < 9; ++k) body->R[k] = pose->R[k];
    } else {
        mr_multiply(pose->R, T->R, body->R);
        mr_rotate(pose->R, T->p, arm);
        mr_add(arm, body->point);
    }
    if (framed) return;
    mr_rotate(body->R, com, arm);
    mr_add(arm, body->point);
}

/* s: the axis of each lane's joint in body axes, zero for a prismatic joint; v: how the body's point
 * with the joint. */
static inline void move_of(const mr_uncertain_body *body, int prismatic, const mr_lane axis[9],
                           mr_lane s[3], mr_lane v[3]) {
    const MR_REAL *R = body->R;
    const mr_lane *from = axis + 6;
    mr_lane arm[3], x[3];
    for (int k = 0; k < 3; ++k) arm[k] = body->point[k] - from[k];
    mr_unrotate(R, axis, s);
    mr_unrotate(R, arm, x);
    mr_cross(s, x, v);
    if (prismatic) {
        mr_lane along[3];
        mr_unrotate(R, axis + 3, along);
        mr_add(along, v);
    }
}

/* W = sym(s dw' + (s x wa) w'), off-diagonal entries twice; t = s x wa */
static inline void weights_of(const mr_uncertain_body *body, const mr_lane s[3],
                              const mr_lane t[3], mr_lane W[6]) {
    const MR_REAL *w = body->w, *dw = body->dw;
    W[0] = s[0] * dw[0] + t[0] * w[0];
    W[1] = (s[0] * dw[1] + s[1] * dw[0]) + (t[0] * w[1] + t[1] * w[0]);
    W[2] = (s[0] * dw[2] + s[2] * dw[0]) + (t[0] * w[2] + t[2] * w[0]);
    W[3] = s[1] * dw[1] + t[1] * w[1];
    W[4] = (s[1] * dw[2] + s[2] * dw[1]) + (t[1] * w[2] + t[2] * w[1]);
    W[5] = s[2] * dw[2] + t[2] * w[2];
}

/* What the box of the tensor adds by W: its middle and its radius. */
static inline void tensor_share(const mr_body_box *box, const mr_lane W[6], mr_lane *moved,
                                mr_lane *spread) {
    *spread = MR_LANE_ABS(W[0]) * box->inertia_radius[0];
    for (int k = 1; k < 6; ++k) *spread += MR_LANE_ABS(W[k]) * box->inertia_radius[k];
    if (box->off_centre != 0.0)
        for (int k = 0; k < 6; ++k) *moved += W[k] * box->inertia_shift[k];
}

/* (m - m_0) f_0 + m [least, most], and the share of the tensor. */
static inline void ends_of(const mr_body_box *box, mr_lane f0, mr_lane least, mr_lane most,
                           mr_lane moved, mr_lane spread, mr_lane *lo, mr_lane *hi) {
    const mr_lane spread_lo = MR_LANE_ABS(f0 + least) * box->mass_radius + spread;
    const mr_lane spread_hi = MR_LANE_ABS(f0 + most) * box->mass_radius + spread;
    *lo = moved + (box->mass_middle * least - spread_lo);
    *hi = moved + (box->mass_middle * most + spread_hi);
}

/* Range of one body's torque on the joint of each lane, less the nominal, (18). */
static inline void deviation(const mr_uncertain_body *body, const mr_body_box *box, int prismatic,
                             const mr_lane axis[9], mr_lane_mask active, mr_lane *lo,
                             mr_lane *hi) {
    const MR_REAL *e = body->e;
    mr_lane s[3], v[3];
    move_of(body, prismatic, axis, s, v);
    const mr_lane f0 = mr_dot(v, e);
    const mr_lane zero = MR_LANE_SPLAT(0.0);
    mr_lane least = zero, most = zero, moved = box->mass_shift * f0, spread = zero, W[6];

    if (box->com_uncertain != 0.0 || box->inertia_uncertain != 0.0) {
        mr_lane t[3];
        mr_cross(s, body->wa, t);
        weights_of(body, s, t, W);
    }
    if (box->inertia_uncertain != 0.0) tensor_share(box, W, &moved, &spread);
    if (box->com_uncertain != 0.0) {
        mr_quadratic f;
        const mr_lane trace = mr_dot(s, body->dw);
        mr_unrotate(body->L, v, f.g);
        mr_add_cross(e, s, f.g);
        f.Q[0] = trace - W[0]; /* sym([s]x' L) = (s . dw) 1 - W */
        f.Q[1] = -0.5 * W[1];
        f.Q[2] = -0.5 * W[2];
        f.Q[3] = trace - W[3];
        f.Q[4] = -0.5 * W[4];
        f.Q[5] = trace - W[5];
        mr_lane shift = zero;
        if (box->off_centre != 0.0) { /* to the middle of the box of COMs */
            const double *h = box->com_shift;
            mr_lane Qh[3], middle[3];
            mr_symmetric(f.Q, h, Qh);
            for (int k = 0; k < 3; ++k) middle[k] = f.g[k] + Qh[k];
            shift = mr_dot(middle, h);
            for (int k = 0; k < 3; ++k) f.g[k] = middle[k] + Qh[k];
        }
        mr_quadratic_range(&f, box->com_radius, active, &least, &most);
        least += shift;
        most += shift;
    }
    ends_of(box, f0, least, most, moved, spread, lo, hi);
}

/* The same where the tensor is about the body frame's origin, (18f). */
static inline void deviation_about_frame(const mr_uncertain_body *body, const mr_body_box *box,
                                         const double com[3], int prismatic, const mr_lane axis[9],
                                         mr_lane *lo, mr_lane *hi) {
    mr_lane s[3], v[3], t[3], h[3], g[3];
    move_of(body, prismatic, axis, s, v);
    mr_cross(s, body->wa, t);
    const mr_lane k = mr_dot(t, body->w);
    mr_unrotate(body->L, v, h);
    mr_add_cross(body->e, s, h);
    for (int i = 0; i < 3; ++i) h[i] -= k * com[i];
    const mr_lane f0 = mr_dot(v, body->e) + mr_dot(h, com);
    const mr_lane zero = MR_LANE_SPLAT(0.0);
    mr_lane least = zero, most = zero, moved = box->mass_shift * f0, spread = zero;

    if (box->inertia_uncertain != 0.0) {
        mr_lane W[6];
        weights_of(body, s, t, W);
        tensor_share(box, W, &moved, &spread);
    }
    if (box->com_uncertain != 0.0) {
        for (int i = 0; i < 3; ++i) g[i] = h[i] - k * com[i];
        mr_separable_range(g, k, box->com_shift, box->com_radius, &least, &most);
    }
    ends_of(box, f0, least, most, moved, spread, lo, hi);
}

/* Whether joint `ancestor` carries the link of `joint`. */
static int carries(const mr_model *model, int32_t ancestor, int32_t joint) {
    if (mr_of_model(model)->serial != 0.0) return ancestor <= joint;
    while (joint > ancestor) joint = model->parent[joint];
    return joint == ancestor;
}

/* Lanes of a block of joints that carry link `last`. */
static inline mr_lane_mask carrying(const mr_model *model, int32_t first, int32_t last, int *any) {
    static const int64_t indices[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    int64_t on[MR_LANES];
    mr_lane_mask index, mask;
    memcpy(&index, indices, sizeof index);
    *any = carries(model, first, last);
    if (MR_BLOCK == 1) return index >= 0; /* the lanes of a batch are states */
    if (mr_of_model(model)->serial != 0.0) return index <= (int64_t)(last - first);
    for (int32_t l = 0; l < MR_LANES; ++l) {
        const int32_t i = first + l;
        on[l] = i <= last && carries(model, i, last) ? -1 : 0;
        *any |= on[l] != 0;
    }
    memcpy(&mask, on, sizeof mask);
    return mask;
}

void mr_hull_deviation(const mr_model *model, const mr_bounds *bounds, const mr_workspace *ws) {
    const mr_body_box *boxes = mr_boxes(model, bounds);
    const size_t stride = mr_joint_stride(model);
    const int prismatic = mr_of_model(model)->prismatic != 0.0;
    const mr_lane zero = MR_LANE_SPLAT(0.0);
    int32_t highest = -1;
    for (size_t i = 0; i < stride; ++i) ws->lo[i] = ws->hi[i] = MR_SPLAT(0.0);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k) {
        const int32_t i = model->body_joint[bounds->uncertain[k]];
        if (i > highest) highest = i;
    }
    forward_poses(model, highest, ws);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k) {
        const int32_t b = bounds->uncertain[k], last = model->body_joint[b];
        mr_uncertain_body body;
        if (last < 0) continue;
        uncertain_body(model, bounds, b, ws, &body);
        for (int32_t first = 0; first <= last; first += MR_BLOCK) {
            int any;
            const mr_lane_mask active = carrying(model, first, last, &any);
            mr_lane axis[9], least, most;
            if (!any) continue;
            for (size_t c = 0; c < 9; ++c) axis[c] = MR_TAKE(ws->axes + c * stride, first);
            if (model->inertia_about[b] == MR_ABOUT_FRAME)
                deviation_about_frame(&body, &boxes[k], bounds->nominal.com + 3 * b, prismatic,
                                      axis, &least, &most);
            else
                deviation(&body, &boxes[k], prismatic, axis, active, &least, &most);
            least = MR_TAKE(ws->lo, first) + MR_LANE_SELECT(active, least, zero);
            most = MR_TAKE(ws->hi, first) + MR_LANE_SELECT(active, most, zero);
            MR_PUT(least, ws->lo, first);
            MR_PUT(most, ws->hi, first);
        }
    }
}
