/* Forward recursion of Algorithm 1 on T_i = before_i J_i(q_i) after_i, (14). */
#include "mr_internal.h"

#define LINK_DOUBLES (sizeof(mr_link) / sizeof(double))
#define BOX_DOUBLES (sizeof(mr_wrench_box) / sizeof(double))
#define POSE_DOUBLES (sizeof(mr_pose) / sizeof(double))

size_t mr_workspace_size(int32_t n, int32_t b) {
    (void)b; /* bodies need no memory of their own */
    return (size_t)n * (LINK_DOUBLES + BOX_DOUBLES + POSE_DOUBLES + 5);
}

mr_workspace mr_workspace_view(int32_t n, double *memory) {
    mr_workspace view;
    const size_t count = (size_t)n;
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
    return view;
}

mr_status mr_check_vector(int32_t n, const double *x) {
    for (int32_t i = 0; i < n; ++i)
        if (!isfinite(x[i])) return MR_NOT_FINITE;
    return MR_OK;
}

mr_status mr_check_state(const mr_model *model, const double *q, const double *dq,
                         const double *dq_a, const double *ddq_a) {
    const double *vectors[4] = {q, dq, dq_a, ddq_a};
    for (int k = 0; k < 4; ++k)
        if (mr_check_vector(model->n, vectors[k])) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->n; ++i)
        if (model->joint_type[i] == MR_REVOLUTE && fabs(q[i]) > MR_ANGLE_MAX)
            return MR_ANGLE_RANGE;
    return MR_OK;
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

void mr_forward_recursion(const mr_model *model, const double gravity[3], const double *q,
                          const double *dq, const double *dq_a, const double *ddq_a,
                          mr_link *links) {
    static const double zero[3] = {0.0, 0.0, 0.0};
    const double base_a[3] = {-gravity[0], -gravity[1], -gravity[2]}; /* line 3 */
    for (int32_t i = 0; i < model->n; ++i) {
        mr_link *link = &links[i];
        const mr_link *parent = model->parent[i] < 0 ? NULL : &links[model->parent[i]];
        const double *lever = model->before[i].p;
        double a[3], cross[3];
        mr_joint_geometry(model, i, q[i], link);

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
    mr_workspace ws = mr_workspace_view(model->n, workspace);
    const mr_status status = mr_check_state(model, q, q, q, q);
    if (status) return status;
    for (int32_t i = 0; i < model->n; ++i) {
        mr_link *link = &ws.links[i];
        double position[3];
        mr_joint_geometry(model, i, q[i], link);
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
