/* IANEA*: Algorithm 1 of the paper from line 23 on, several bodies a link. Line numbers at right.
 *
 * Rounding is to nearest and not yet enclosed: see docs/guarantees.md. */
#include "mr_internal.h"

static void body_wrench(const mr_model *model, const mr_parameters *lower,
                        const mr_parameters *upper, const mr_link *links, int32_t b,
                        mr_wrench_box *out) {
    const mr_transform *T = &model->placement[b];
    mr_motion m;
    mr_interval c[3], I[6], F[3], N[3], part[3], swap[3];
    mr_body_motion(model, links, b, &m);
    for (int k = 0; k < 3; ++k) /* 5 */
        c[k] = (mr_interval){lower->com[3 * b + k], upper->com[3 * b + k]};
    for (int k = 0; k < 6; ++k)
        I[k] = (mr_interval){lower->inertia[6 * b + k], upper->inertia[6 * b + k]};

    for (int k = 0; k < 3; ++k) F[k] = (mr_interval){m.a[k], m.a[k]}; /* 23 */
    mr_i_cross_real(m.dw, c, part);
    mr_i_accumulate(part, F);
    mr_i_cross_real(m.wa, c, part);
    mr_i_cross_real(m.w, part, swap);
    mr_i_accumulate(swap, F);
    const mr_interval mass = {lower->mass[b], upper->mass[b]};
    for (int k = 0; k < 3; ++k) F[k] = mr_i_mul(mass, F[k]); /* 27 */

    mr_i_cross(c, F, N);                                     /* 29 */
    const mr_interval rows[9] = {I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5]};
    for (int k = 0; k < 3; ++k) N[k] = mr_i_add(N[k], mr_i_dot(m.dw, rows + 3 * k)); /* 30 */
    for (int k = 0; k < 3; ++k) part[k] = mr_i_dot(m.w, rows + 3 * k);
    mr_i_cross_real(m.wa, part, swap);
    mr_i_accumulate(swap, N);

    if (mr_is_identity(T->R)) {
        for (int k = 0; k < 3; ++k) out->f[k] = F[k], out->n[k] = N[k];
    } else {
        mr_i_rotate(T->R, F, out->f);
        mr_i_rotate(T->R, N, out->n);
    }
    mr_i_cross_real(T->p, out->f, part);
    mr_i_accumulate(part, out->n);
}

void mr_ianea(const mr_model *model, const mr_parameters *lower, const mr_parameters *upper,
              const mr_link *links, mr_wrench_box *wrenches, double *tau_lo, double *tau_hi) {
    for (int32_t i = 0; i < model->j; ++i) /* 25 */
        for (int k = 0; k < 3; ++k)
            wrenches[i].f[k] = wrenches[i].n[k] = (mr_interval){0.0, 0.0};

    for (int32_t b = 0; b < model->b; ++b) {
        mr_wrench_box body;
        if (model->body_joint[b] < 0) continue;
        body_wrench(model, lower, upper, links, b, &body);
        mr_i_accumulate(body.f, wrenches[model->body_joint[b]].f);
        mr_i_accumulate(body.n, wrenches[model->body_joint[b]].n);
    }

    for (int32_t i = model->j - 1; i >= 0; --i) { /* 26 */
        const mr_link *link = &links[i];
        mr_wrench_box *own = &wrenches[i];
        mr_interval part[3], f[3], n[3];
        mr_i_cross_real(link->p, own->f, part); /* 30 */
        mr_i_accumulate(part, own->n);
        const mr_interval u =
            mr_i_dot(link->z, model->joint_type[i] == MR_REVOLUTE ? own->n : own->f); /* 32, 34 */
        tau_lo[i] = u.lo;
        tau_hi[i] = u.hi;
        if (model->parent[i] < 0) continue;
        mr_wrench_box *parent = &wrenches[model->parent[i]];
        mr_i_rotate(link->R, own->f, f); /* 28 */
        mr_i_rotate(link->R, own->n, n); /* 29 */
        mr_i_cross_real(model->before[i].p, f, part);
        mr_i_accumulate(part, n);
        mr_i_accumulate(f, parent->f);
        mr_i_accumulate(n, parent->n);
    }
}
