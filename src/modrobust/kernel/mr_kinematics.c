/* Forward recursion of Algorithm 1 on T_i = before_i J_i(q_i) after_i, (14). */
#include "mr_internal.h"

#define LINK_DOUBLES (sizeof(mr_link) / sizeof(double))
#define BOX_DOUBLES (sizeof(mr_wrench_box) / sizeof(double))
#define POSE_DOUBLES (sizeof(mr_pose) / sizeof(double))

size_t mr_workspace_size(const mr_model *model) {
    return (size_t)model->j * (LINK_DOUBLES + BOX_DOUBLES + POSE_DOUBLES + 9);
}

mr_workspace mr_workspace_view(const mr_model *model, double *memory) {
    mr_workspace view;
    const size_t count = (size_t)model->j;
    view.links = (mr_link *)memory;
    memory += count * LINK_DOUBLES;
    view.wrench.box = (mr_wrench_box *)memory;
    memory += count * BOX_DOUBLES;
    view.poses = (mr_pose *)memory;
    memory += count * POSE_DOUBLES;
    view.lo = memory;
    view.hi = memory + count;
    view.mid = memory + 2 * count;
    view.dq_a = memory + 3 * count;
    view.ddq_a = memory + 4 * count;
    for (size_t k = 0; k < 4; ++k) view.full[k] = memory + (5 + k) * count;
    return view;
}

mr_status mr_check_vector(int32_t n, const double *x) {
    for (int32_t i = 0; i < n; ++i)
        if (!isfinite(x[i])) return MR_NOT_FINITE;
    return MR_OK;
}

mr_status mr_full_state(const mr_model *model, const mr_workspace *ws, const double *q,
                        const double *dq, const double *dq_a, const double *ddq_a,
                        mr_state *state) {
    const int32_t n = model->n;
    const double *given[4] = {q, dq, dq_a, ddq_a};
    for (int v = 0; v < 4; ++v) {
        if (mr_check_vector(n, given[v])) return MR_NOT_FINITE;
        if (model->j == n) continue;
        double *full = ws->full[v];
        for (int32_t i = 0; i < n; ++i) full[i] = given[v][i];
        for (int32_t k = 0; k < model->j - n; ++k)
            full[n + k] = model->multiplier[k] * full[model->leader[k]] +
                          (v == 0 ? model->offset[k] : 0.0);
        if (mr_check_vector(model->j, full)) return MR_NOT_FINITE;
        given[v] = full;
    }
    for (int32_t i = 0; i < model->j; ++i)
        if (model->joint_type[i] == MR_REVOLUTE && fabs(given[0][i]) > MR_ANGLE_MAX)
            return MR_ANGLE_RANGE;
    *state = (mr_state){given[0], given[1], given[2], given[3]};
    return MR_OK;
}

void mr_lead(const mr_model *model, double *tau) {
    for (int32_t k = 0; k < model->j - model->n; ++k)
        tau[model->leader[k]] += model->multiplier[k] * tau[model->n + k];
}

void mr_lead_box(const mr_model *model, double *lo, double *hi) {
    for (int32_t k = 0; k < model->j - model->n; ++k) {
        const mr_interval own = {lo[model->n + k], hi[model->n + k]};
        const mr_interval share = mr_i_scale(model->multiplier[k], own);
        lo[model->leader[k]] += share.lo;
        hi[model->leader[k]] += share.hi;
    }
}

void mr_joint_geometry(const mr_model *model, int32_t i, double q, mr_link *link) {
    const double *A = model->after[i].R;
    mr_unrotate(A, model->after[i].p, link->p);
    for (int k = 0; k < 3; ++k) link->z[k] = A[6 + k];
    double turned[9];
    const double *joint_to_link = A;
    if (model->joint_type[i] == MR_REVOLUTE) {
        double s, c;
        mr_sincos(q, &s, &c);
        for (int k = 0; k < 3; ++k) {
            turned[k] = c * A[k] - s * A[3 + k];
            turned[3 + k] = s * A[k] + c * A[3 + k];
            turned[6 + k] = A[6 + k];
        }
        joint_to_link = turned;
    } else {
        mr_add_scaled(q, link->z, link->p);
    }
    if (mr_is_identity(model->before[i].R))
        for (int k = 0; k < 9; ++k) link->R[k] = joint_to_link[k];
    else
        mr_multiply(model->before[i].R, joint_to_link, link->R);
}

void mr_forward_recursion(const mr_model *model, const mr_state *state, mr_link *links) {
    static const double zero[3] = {0.0, 0.0, 0.0};
    const double *g = model->gravity, base_a[3] = {-g[0], -g[1], -g[2]}; /* line 3 */
    const double *dq = state->dq, *dq_a = state->dq_a, *ddq_a = state->ddq_a;
    for (int32_t i = 0; i < model->j; ++i) {
        mr_link *link = &links[i];
        const mr_link *parent = model->parent[i] < 0 ? NULL : &links[model->parent[i]];
        const double *lever = model->before[i].p;
        double a[3], cross[3];
        mr_joint_geometry(model, i, state->q[i], link);

        /* The joint frame's origin, carried by the parent: zero lever along a D-H chain. */
        mr_copy(parent ? parent->a : base_a, a);
        if (parent) {
            mr_add_cross(parent->dw, lever, a);
            mr_cross(parent->wa, lever, cross);
            mr_add_cross(parent->w, cross, a);
        }
        mr_unrotate(link->R, parent ? parent->w : zero, link->w);
        mr_unrotate(link->R, parent ? parent->wa : zero, link->wa);
        mr_unrotate(link->R, parent ? parent->dw : zero, link->dw);
        mr_unrotate(link->R, a, link->a);

        if (model->joint_type[i] == MR_REVOLUTE) {
            mr_cross(link->wa, link->z, cross);
            mr_add_scaled(ddq_a[i], link->z, link->dw); /* line 15 */
            mr_add_scaled(dq[i], cross, link->dw);
            mr_add_scaled(dq[i], link->z, link->w);    /* line 13 */
            mr_add_scaled(dq_a[i], link->z, link->wa); /* line 14 */
        } else { /* the three terms at the end of line 21 */
            mr_cross(link->wa, link->z, cross);
            mr_add_scaled(dq[i], cross, link->a);
            mr_cross(link->w, link->z, cross);
            mr_add_scaled(dq_a[i], cross, link->a);
            mr_add_scaled(ddq_a[i], link->z, link->a);
        }
        mr_add_cross(link->dw, link->p, link->a); /* lines 16 and 21 */
        mr_cross(link->wa, link->p, cross);
        mr_add_cross(link->w, cross, link->a);
    }
}

void mr_body_motion(const mr_model *model, const mr_link *links, int32_t k, mr_motion *motion) {
    const mr_link *link = &links[model->body_joint[k]];
    const mr_transform *T = &model->placement[k];
    double a[3], cross[3];
    mr_copy(link->a, a);
    mr_add_cross(link->dw, T->p, a);
    mr_cross(link->wa, T->p, cross);
    mr_add_cross(link->w, cross, a);
    if (mr_is_identity(T->R)) {
        mr_copy(link->w, motion->w);
        mr_copy(link->wa, motion->wa);
        mr_copy(link->dw, motion->dw);
        mr_copy(a, motion->a);
    } else {
        mr_unrotate(T->R, link->w, motion->w);
        mr_unrotate(T->R, link->wa, motion->wa);
        mr_unrotate(T->R, link->dw, motion->dw);
        mr_unrotate(T->R, a, motion->a);
    }
}

mr_status mr_forward_kinematics(const mr_model *model, const double *q, double *workspace,
                                mr_transform *frames) {
    mr_workspace ws = mr_workspace_view(model, workspace);
    mr_state state;
    const mr_status status = mr_full_state(model, &ws, q, q, q, q, &state);
    if (status) return status;
    for (int32_t i = 0; i < model->j; ++i) {
        mr_link *link = &ws.links[i];
        double position[3];
        mr_joint_geometry(model, i, state.q[i], link);
        mr_rotate(link->R, link->p, position);
        mr_add(model->before[i].p, position);
        if (model->parent[i] < 0) {
            for (int k = 0; k < 9; ++k) frames[i].R[k] = link->R[k];
            mr_copy(position, frames[i].p);
        } else {
            const mr_transform *parent = &frames[model->parent[i]];
            mr_multiply(parent->R, link->R, frames[i].R);
            mr_rotate(parent->R, position, frames[i].p);
            mr_add(parent->p, frames[i].p);
        }
    }
    return MR_OK;
}
