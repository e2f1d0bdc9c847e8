/* NE*: Algorithm 1 with real parameters, several bodies a link. */
#include "mr_internal.h"

/* Component of the motion of the links that carry bodies b, b + 1, ... */
static inline mr_lane motion_of(const mr_model *model, const MR_REAL *component, int32_t b) {
#ifdef MR_BATCH
    return component[model->body_joint[b] < 0 ? 0 : model->body_joint[b]];
#else
    if (mr_of_model(model)->aligned != 0.0) return mr_lane_load(component + b);
    double lane[MR_LANES];
    for (int32_t l = 0; l < MR_LANES; ++l) {
        const int32_t body = b + l < model->b ? b + l : b;
        const int32_t joint = model->body_joint[body]; /* base-fixed ones are not read later */
        lane[l] = component[joint < 0 ? 0 : joint];
    }
    return mr_lane_load(lane);
#endif
}

/* L of (16): L c = dw x c + w x (wa x c), row by row. */
static inline void acceleration_matrix(const mr_lane w[3], const mr_lane wa[3],
                                       const mr_lane dw[3], mr_lane L[9]) {
    const mr_lane d = mr_dot(w, wa); /* w x (wa x c) = wa (w . c) - (w . wa) c */
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

/* One register of bodies. */
static inline void body_block(const mr_model *model, const double *point, const MR_REAL *links,
                              MR_REAL *bodies, int32_t b) {
    const size_t joint_stride = mr_joint_stride(model), stride = mr_body_stride(model);
    const int moved = mr_of_model(model)->placements != MR_IDENTITY;
    mr_lane motion[MR_MOTION], R[9], p[3];
    for (size_t k = 0; k < MR_MOTION; ++k)
        motion[k] = motion_of(model, links + k * joint_stride, b);
    mr_lane *w = motion + MR_W, *wa = motion + MR_WA, *dw = motion + MR_DW, *a = motion + MR_A;
    if (moved) {
        const double *T = mr_placements(model);
        mr_lane carried[3];
        for (size_t k = 0; k < 9; ++k) R[k] = MR_TAKE_CONSTANT(T + k * stride, b);
        for (size_t k = 0; k < 3; ++k) p[k] = MR_TAKE_CONSTANT(T + (9 + k) * stride, b);
        mr_cross(wa, p, carried);
        mr_add_cross(dw, p, a);
        mr_add_cross(w, carried, a);
        for (size_t v = 0; v < MR_MOTION; v += 3) {
            mr_lane rotated[3];
            mr_unrotate(R, motion + v, rotated);
            mr_copy(rotated, motion + v);
        }
    }
    mr_lane c[3], I[6], L[9], e[3], F[3], N[3], Iw[3];
    const mr_lane mass = MR_TAKE_CONSTANT(point, b);
    for (size_t k = 0; k < 3; ++k) c[k] = MR_TAKE_CONSTANT(point + (1 + k) * stride, b);
    for (size_t k = 0; k < 6; ++k) I[k] = MR_TAKE_CONSTANT(point + (4 + k) * stride, b);
    acceleration_matrix(w, wa, dw, L);
    mr_rotate(L, c, e);
    mr_add(a, e); /* A1:23 */
    for (int k = 0; k < 3; ++k) F[k] = mass * e[k]; /* A1:27 */
    mr_symmetric(I, dw, N);                                  /* A1:30 */
    mr_symmetric(I, w, Iw);
    mr_add_cross(wa, Iw, N);
    mr_add_cross(c, F, N); /* A1:29 */
    if (moved) {
        mr_lane f[3], n[3];
        mr_rotate(R, F, f);
        mr_rotate(R, N, n);
        mr_add_cross(p, f, n);
        mr_copy(f, F);
        mr_copy(n, N);
    }
    for (size_t k = 0; k < MR_MOTION; ++k) MR_PUT(motion[k], bodies + k * stride, b);
    for (size_t k = 0; k < 9; ++k) MR_PUT(L[k], bodies + (MR_L + k) * stride, b);
    for (size_t k = 0; k < 3; ++k) {
        MR_PUT(e[k], bodies + (MR_E + k) * stride, b);
        MR_PUT(F[k], bodies + (MR_F + k) * stride, b);
        MR_PUT(N[k], bodies + (MR_N + k) * stride, b);
    }
}

void mr_body_pass(const mr_model *model, const double *point, const mr_workspace *ws) {
    for (int32_t b = 0; b < model->b; b += MR_BLOCK)
        body_block(model, point, ws->motion, ws->bodies, b);
}

void mr_backward_recursion(const mr_model *model, const mr_workspace *ws, MR_REAL *tau) {
    const size_t stride = mr_body_stride(model);
    const MR_REAL zero = MR_SPLAT(0.0);
    mr_wrench *wrenches = ws->wrench.real;
    MR_REAL f[3] = {zero, zero, zero}, n[3] = {zero, zero, zero}; /* carried to `parent` */
    int32_t parent = -1;
    for (int32_t i = 0; i < model->j; ++i)
        for (int k = 0; k < 3; ++k) wrenches[i].f[k] = wrenches[i].n[k] = zero;
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        mr_wrench *link = &wrenches[model->body_joint[b]];
        for (size_t k = 0; k < 3; ++k) {
            link->f[k] += ws->bodies[(MR_F + k) * stride + (size_t)b];
            link->n[k] += ws->bodies[(MR_N + k) * stride + (size_t)b];
        }
    }
    for (int32_t i = model->j - 1; i >= 0; --i) {
        const mr_link *link = &ws->links[i];
        const double *z = model->after[i].R + 6;
        MR_REAL own_f[3], own_n[3];
        if (parent != i && parent >= 0) { /* a branch: put down for later */
            mr_add(f, wrenches[parent].f); /* A1:28 */
            mr_add(n, wrenches[parent].n); /* A1:29 */
        }
        mr_copy(wrenches[i].f, own_f);
        mr_copy(wrenches[i].n, own_n);
        if (parent == i) { /* a chain: out of the registers */
            mr_add(f, own_f);
            mr_add(n, own_n);
        }
        mr_add_cross(link->p, own_f, own_n); /* A1:30: moment about the joint frame's origin */
        if (model->joint_type[i] == MR_REVOLUTE)
            tau[i] = mr_dot(own_n, z);
        else
            tau[i] = mr_dot(own_f, z);
        parent = model->parent[i];
        if (parent < 0) continue;
        mr_rotate(link->R, own_f, f);
        mr_rotate(link->R, own_n, n);
        if (mr_of_joints(model)[i].before != MR_IDENTITY) mr_add_cross(model->before[i].p, f, n);
    }
}

void mr_newton_euler(const mr_model *model, const double *point, const mr_state *state,
                     const mr_workspace *ws, MR_REAL *tau) {
    mr_forward_recursion(model, state, ws);
    mr_body_pass(model, point, ws);
    mr_backward_recursion(model, ws, tau);
}
