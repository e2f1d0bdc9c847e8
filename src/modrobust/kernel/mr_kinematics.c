/* Forward recursion of Algorithm 1 on T_i = before_i J_i(q_i) after_i, (14). */
#include "mr_internal.h"

void mr_expand_mimic(const mr_model *model, mr_state *state, MR_REAL *const full[6]) {
    const int32_t n = model->n;
    const MR_REAL *given[6] = {state->q,     state->dq,        state->dq_a,
                               state->ddq_a, state->dq_a_size, state->ddq_a_size};
    if (model->j == n) {
        for (int32_t i = 0; i < n; ++i) full[0][i] = state->q[i];
        state->q = full[0];
        return;
    }
    for (int v = 0; v < 6; ++v) {
        if (!given[v]) continue;
        for (int32_t i = 0; i < n; ++i) full[v][model->moves[i]] = given[v][i];
        for (int32_t k = 0; k < model->j - n; ++k) {
            const double factor = v < 4 ? model->multiplier[k] : fabs(model->multiplier[k]);
            MR_REAL *const mimic_joint = &full[v][model->moves[n + k]];
            *mimic_joint = factor * given[v][model->leader[k]];
            if (v == 0) *mimic_joint += model->offset[k];
        }
    }
    *state = (mr_state){
        full[0], full[1], full[2], full[3], given[4] ? full[4] : NULL, given[5] ? full[5] : NULL};
}

void mr_fold_mimic_torque(const mr_model *model, MR_REAL *tau) {
    const int32_t n = model->n, *moves = model->moves;
    if (model->j == n) return;
    for (int32_t k = 0; k < model->j - n; ++k)
        tau[moves[model->leader[k]]] += model->multiplier[k] * tau[moves[n + k]];
    for (int32_t i = 0; i < n; ++i) tau[i] = tau[moves[i]]; /* moves[i] >= i, ascending */
}

void mr_all_sines(const mr_model *model, const MR_REAL *q, MR_REAL *sines) {
    for (int32_t i = 0; i < model->j; i += MR_BLOCK) {
        mr_lane s, c;
        mr_sine_cosine(MR_TAKE(q, i), &s, &c);
        MR_PUT(s, sines, i);
        MR_PUT(c, sines + mr_joint_stride(model), i);
    }
}

void mr_joint_geometry(const mr_model *model, int32_t i, const MR_REAL *q, const MR_REAL *sines,
                       mr_link *link) {
    const mr_joint_constants *constants = &mr_of_joints(model)[i];
    const double *A = model->after[i].R;
    MR_REAL rotated[9];
    MR_REAL *joint_to_link = constants->before == MR_GENERAL ? rotated : link->R;
    mr_splat(constants->lever, link->p);
    for (int k = 0; k < 3; ++k) joint_to_link[6 + k] = MR_SPLAT(A[6 + k]);
    if (model->joint_type[i] == MR_REVOLUTE) {
        const MR_REAL s = sines[i], c = sines[mr_joint_stride(model) + (size_t)i];
        for (int k = 0; k < 3; ++k) {
            joint_to_link[k] = c * A[k] - s * A[3 + k];
            joint_to_link[3 + k] = s * A[k] + c * A[3 + k];
        }
    } else {
        mr_add_scaled(q[i], A + 6, link->p);
        for (int k = 0; k < 6; ++k) joint_to_link[k] = MR_SPLAT(A[k]);
    }
    if (constants->before == MR_GENERAL) mr_multiply(model->before[i].R, rotated, link->R);
}

/* a += dw x p + w x (wa x p) */
#define ADD_CARRIED(w, wa, dw, p, a)    \
    do {                                \
        MR_REAL carried_[3];            \
        mr_cross(wa, p, carried_);      \
        mr_add_cross(dw, p, a);         \
        mr_add_cross(w, carried_, a);   \
    } while (0)

void mr_forward_recursion(const mr_model *model, const mr_state *state, const mr_workspace *ws) {
    const size_t stride = mr_joint_stride(model);
    MR_REAL from[MR_MOTION], *a = from + MR_A; /* motion of the link before, then of link i */
    MR_REAL *w = from + MR_W, *wa = from + MR_WA, *dw = from + MR_DW;
    for (int k = 0; k < MR_MOTION; ++k) from[k] = MR_SPLAT(0.0);
    mr_all_sines(model, state->q, ws->sines);
    for (int32_t i = 0; i < model->j; ++i) {
        mr_link *link = &ws->links[i];
        const int32_t parent = model->parent[i];
        const double *g = model->gravity, *z = model->after[i].R + 6; /* A1:8 */
        const MR_REAL dq = state->dq[i], dq_a = state->dq_a[i], ddq_a = state->ddq_a[i];
        MR_REAL cross[3];
        mr_joint_geometry(model, i, state->q, ws->sines, link);

        if (parent < 0) {
            const double base_a[3] = {-g[0], -g[1], -g[2]}; /* A1:3 */
            mr_unrotate(link->R, base_a, a);
            for (int k = 0; k < 3; ++k) w[k] = wa[k] = dw[k] = MR_SPLAT(0.0);
        } else {
            if (parent != i - 1)
                for (size_t k = 0; k < MR_MOTION; ++k)
                    from[k] = ws->motion[k * stride + (size_t)parent];
            if (mr_of_joints(model)[i].before != MR_IDENTITY) /* to the joint frame's origin */
                ADD_CARRIED(w, wa, dw, model->before[i].p, a);
            for (int v = 0; v < MR_MOTION; v += 3) {
                MR_REAL rotated[3];
                mr_unrotate(link->R, from + v, rotated);
                mr_copy(rotated, from + v);
            }
        }

        mr_cross(wa, z, cross);
        if (model->joint_type[i] == MR_REVOLUTE) {
            mr_add_scaled(ddq_a, z, dw); /* A1:15 */
            mr_add_scaled(dq, cross, dw);
            mr_add_scaled(dq, z, w);    /* A1:13 */
            mr_add_scaled(dq_a, z, wa); /* A1:14 */
        } else { /* the three terms at the end of A1:21 */
            mr_add_scaled(dq, cross, a);
            mr_cross(w, z, cross);
            mr_add_scaled(dq_a, cross, a);
            mr_add_scaled(ddq_a, z, a);
        }
        ADD_CARRIED(w, wa, dw, link->p, a); /* A1:16 and A1:21 */
        for (size_t k = 0; k < MR_MOTION; ++k) ws->motion[k * stride + (size_t)i] = from[k];
    }
}
