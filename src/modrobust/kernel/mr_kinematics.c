/* Forward recursion of Algorithm 1 on T_i = before_i J_i(q_i) after_i, (14). */
#include "mr_internal.h"

void mr_follow(const mr_model *model, mr_state *state, MR_REAL *const full[4]) {
    const int32_t n = model->n;
    const MR_REAL *given[4] = {state->q, state->dq, state->dq_a, state->ddq_a};
    for (int v = 0; v < 4; ++v) {
        for (int32_t i = 0; i < n; ++i) full[v][i] = given[v][i];
        for (int32_t k = 0; k < model->j - n; ++k) {
            full[v][n + k] = model->multiplier[k] * given[v][model->leader[k]];
            if (v == 0) full[v][n + k] += model->offset[k];
        }
    }
    *state = (mr_state){full[0], full[1], full[2], full[3]};
}

void mr_lead(const mr_model *model, MR_REAL *tau) {
    for (int32_t k = 0; k < model->j - model->n; ++k)
        tau[model->leader[k]] += model->multiplier[k] * tau[model->n + k];
}

void mr_joint_geometry(const mr_model *model, int32_t i, MR_REAL q, mr_link *link) {
    const mr_joint_constants *constants = &mr_of_joints(model)[i];
    const double *A = model->after[i].R;
    mr_splat(constants->lever, link->p);
    MR_REAL turned[9];
    MR_REAL *joint_to_link = constants->before == MR_GENERAL ? turned : link->R;
    for (int k = 0; k < 3; ++k) joint_to_link[6 + k] = MR_SPLAT(A[6 + k]);
    if (model->joint_type[i] == MR_REVOLUTE) {
        MR_REAL s, c;
        mr_sine_cosine(q, &s, &c);
        for (int k = 0; k < 3; ++k) {
            joint_to_link[k] = c * A[k] - s * A[3 + k];
            joint_to_link[3 + k] = s * A[k] + c * A[3 + k];
        }
    } else {
        mr_add_scaled(q, A + 6, link->p);
        for (int k = 0; k < 6; ++k) joint_to_link[k] = MR_SPLAT(A[k]);
    }
    if (constants->before == MR_GENERAL)
        mr_multiply(model->before[i].R, turned, link->R);
}

void mr_forward_recursion(const mr_model *model, const mr_state *state, mr_link *links) {
    const double *g = model->gravity;
    const MR_REAL *dq = state->dq, *dq_a = state->dq_a, *ddq_a = state->ddq_a;
    for (int32_t i = 0; i < model->j; ++i) {
        mr_link *link = &links[i];
        const double *lever = model->before[i].p, *z = model->after[i].R + 6; /* line 8 */
        MR_REAL cross[3];
        mr_joint_geometry(model, i, state->q[i], link);

        if (model->parent[i] < 0) {
            const double base_a[3] = {-g[0], -g[1], -g[2]}; /* line 3 */
            mr_unrotate(link->R, base_a, link->a);
            for (int k = 0; k < 3; ++k) link->w[k] = link->wa[k] = link->dw[k] = MR_SPLAT(0.0);
        } else {
            const mr_link *parent = &links[model->parent[i]];
            mr_unrotate(link->R, parent->w, link->w);
            mr_unrotate(link->R, parent->wa, link->wa);
            mr_unrotate(link->R, parent->dw, link->dw);
            if (mr_of_joints(model)[i].before == MR_IDENTITY) {
                mr_unrotate(link->R, parent->a, link->a);
            } else { /* the joint frame's origin, carried by the parent */
                MR_REAL a[3];
                mr_copy(parent->a, a);
                mr_add_cross(parent->dw, lever, a);
                mr_cross(parent->wa, lever, cross);
                mr_add_cross(parent->w, cross, a);
                mr_unrotate(link->R, a, link->a);
            }
        }

        if (model->joint_type[i] == MR_REVOLUTE) {
            mr_cross(link->wa, z, cross);
            mr_add_scaled(ddq_a[i], z, link->dw); /* line 15 */
            mr_add_scaled(dq[i], cross, link->dw);
            mr_add_scaled(dq[i], z, link->w);    /* line 13 */
            mr_add_scaled(dq_a[i], z, link->wa); /* line 14 */
        } else { /* the three terms at the end of line 21 */
            mr_cross(link->wa, z, cross);
            mr_add_scaled(dq[i], cross, link->a);
            mr_cross(link->w, z, cross);
            mr_add_scaled(dq_a[i], cross, link->a);
            mr_add_scaled(ddq_a[i], z, link->a);
        }
        mr_add_cross(link->dw, link->p, link->a); /* lines 16 and 21 */
        mr_cross(link->wa, link->p, cross);
        mr_add_cross(link->w, cross, link->a);
    }
}

/* L of (16): L c = dw x c + w x (wa x c), row by row. */
static void acceleration_matrix(const MR_REAL w[3], const MR_REAL wa[3], const MR_REAL dw[3],
                                MR_REAL L[9]) {
    const MR_REAL d = mr_dot(w, wa); /* w x (wa x c) = wa (w . c) - (w . wa) c */
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

void mr_body_motions(const mr_model *model, const mr_link *links, mr_motion *motions) {
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        const mr_link *link = &links[model->body_joint[b]];
        const mr_transform *T = &model->placement[b];
        mr_motion *m = &motions[b];
        const double kind = mr_of_bodies(model)[b].placement;
        MR_REAL a[3];
        mr_copy(link->a, a);
        if (kind != MR_IDENTITY) {
            MR_REAL cross[3];
            mr_add_cross(link->dw, T->p, a);
            mr_cross(link->wa, T->p, cross);
            mr_add_cross(link->w, cross, a);
        }
        if (kind != MR_GENERAL) {
            mr_copy(link->w, m->w);
            mr_copy(link->wa, m->wa);
            mr_copy(link->dw, m->dw);
            mr_copy(a, m->a);
        } else {
            mr_unrotate(T->R, link->w, m->w);
            mr_unrotate(T->R, link->wa, m->wa);
            mr_unrotate(T->R, link->dw, m->dw);
            mr_unrotate(T->R, a, m->a);
        }
        acceleration_matrix(m->w, m->wa, m->dw, m->L);
    }
}
