/* NE*: Algorithm 1 with real parameters, several bodies a link. */
#include "mr_internal.h"

static void add_body_wrench(const mr_model *model, const mr_parameters *parameters, const mr_motion *m,
                     int32_t b, mr_wrench *link) {
    const mr_transform *T = &model->placement[b];
    const double *com = parameters->com + 3 * b, *inertia = parameters->inertia + 6 * b;
    const double kind = mr_of_bodies(model)[b].placement;
    MR_REAL F[3], N[3], Iw[3];
    mr_rotate(m->L, com, F);
    for (int k = 0; k < 3; ++k) F[k] = parameters->mass[b] * (m->a[k] + F[k]); /* 23, 27 */
    mr_symmetric(inertia, m->dw, N);                                           /* 30 */
    mr_symmetric(inertia, m->w, Iw);
    mr_add_cross(m->wa, Iw, N);
    mr_add_cross(com, F, N); /* 29 */
    if (kind == MR_IDENTITY) {
        mr_add(F, link->f);
        mr_add(N, link->n);
        return;
    }
    if (kind == MR_GENERAL) {
        MR_REAL f[3], n[3];
        mr_rotate(T->R, F, f);
        mr_rotate(T->R, N, n);
        mr_copy(f, F);
        mr_copy(n, N);
    }
    mr_add_cross(T->p, F, N);
    mr_add(F, link->f);
    mr_add(N, link->n);
}

void mr_newton_euler(const mr_model *model, const mr_parameters *parameters, const mr_link *links,
                     const mr_motion *motions, mr_wrench *wrenches, MR_REAL *tau) {
    for (int32_t i = 0; i < model->j; ++i)
        for (int k = 0; k < 3; ++k) wrenches[i].f[k] = wrenches[i].n[k] = MR_SPLAT(0.0);
    for (int32_t b = 0; b < model->b; ++b)
        if (model->body_joint[b] >= 0)
            add_body_wrench(model, parameters, &motions[b], b, &wrenches[model->body_joint[b]]);

    for (int32_t i = model->j - 1; i >= 0; --i) {
        const mr_link *link = &links[i];
        const double *z = model->after[i].R + 6;
        mr_wrench *own = &wrenches[i];
        mr_add_cross(link->p, own->f, own->n); /* 30: moment about the joint frame's origin */
        if (model->joint_type[i] == MR_REVOLUTE)
            tau[i] = mr_dot(own->n, z);
        else
            tau[i] = mr_dot(own->f, z);
        if (model->parent[i] < 0) continue;
        mr_wrench *parent = &wrenches[model->parent[i]];
        MR_REAL f[3], n[3];
        mr_rotate(link->R, own->f, f);
        mr_rotate(link->R, own->n, n);
        if (mr_of_joints(model)[i].before != MR_IDENTITY)
            mr_add_cross(model->before[i].p, f, n);
        mr_add(f, parent->f); /* 28 */
        mr_add(n, parent->n); /* 29 */
    }
}
