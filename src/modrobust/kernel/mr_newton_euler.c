/* NE*: Algorithm 1 with real parameters, several bodies a link; and the drives, (20), (21). */
#include "mr_internal.h"

void mr_newton_euler(const mr_model *model, const mr_parameters *parameters, const mr_link *links,
                     mr_wrench *wrenches, double *tau) {
    for (int32_t i = 0; i < model->j; ++i)
        for (int k = 0; k < 3; ++k) wrenches[i].f[k] = wrenches[i].n[k] = 0.0;

    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        mr_wrench *link = &wrenches[model->body_joint[b]];
        const mr_transform *T = &model->placement[b];
        const double *com = parameters->com + 3 * b, *inertia = parameters->inertia + 6 * b;
        mr_motion m;
        double L[9], F[3], N[3], Iw[3], f[3], n[3];
        mr_body_motion(model, links, b, &m);
        mr_acceleration_matrix(m.w, m.wa, m.dw, L);
        mr_rotate(L, com, F);
        for (int k = 0; k < 3; ++k) F[k] = parameters->mass[b] * (m.a[k] + F[k]); /* 23, 27 */
        mr_symmetric(inertia, m.dw, N);                                           /* 30 */
        mr_symmetric(inertia, m.w, Iw);
        mr_add_cross(m.wa, Iw, N);
        mr_add_cross(com, F, N); /* 29 */
        const int same = mr_is_identity(T->R);
        if (!same) {
            mr_rotate(T->R, F, f);
            mr_rotate(T->R, N, n);
        }
        mr_add_cross(T->p, same ? F : f, same ? N : n);
        mr_add(same ? F : f, link->f);
        mr_add(same ? N : n, link->n);
    }

    for (int32_t i = model->j - 1; i >= 0; --i) {
        const mr_link *link = &links[i];
        mr_wrench *own = &wrenches[i];
        mr_add_cross(link->p, own->f, own->n); /* 30: moment about the joint frame's origin */
        tau[i] = mr_dot(model->joint_type[i] == MR_REVOLUTE ? own->n : own->f, link->z);
        if (model->parent[i] < 0) continue;
        mr_wrench *parent = &wrenches[model->parent[i]];
        double f[3], n[3];
        mr_rotate(link->R, own->f, f);
        mr_rotate(link->R, own->n, n);
        mr_add_cross(model->before[i].p, f, n);
        mr_add(f, parent->f); /* 28 */
        mr_add(n, parent->n); /* 29 */
    }
}

double mr_smooth_sign(double dq, double coulomb_speed) {
    const double speed = fabs(dq);
    double s;
    if (speed == 0.0) return 0.0;
    if (speed > coulomb_speed) {
        const double r = coulomb_speed / speed;
        s = 1.0 / sqrt(1.0 + r * r);
    } else {
        const double r = speed / coulomb_speed;
        s = r / sqrt(1.0 + r * r);
    }
    return dq > 0.0 ? s : -s;
}

static double reflected(const mr_model *model, int32_t i) {
    return model->gear_ratio[i] * model->gear_ratio[i];
}

void mr_add_drives(const mr_model *model, const mr_parameters *parameters, const double *dq,
                   const double *ddq_a, double *tau) {
    for (int32_t i = 0; i < model->j; ++i)
        tau[i] += parameters->viscous[i] * dq[i] +
                  parameters->coulomb[i] * mr_smooth_sign(dq[i], model->coulomb_speed[i]) +
                  reflected(model, i) * parameters->rotor_inertia[i] * ddq_a[i];
}

/* Hull of the smooth and the true sign of dq: what Coulomb friction may be, (20). */
static mr_interval sign_box(double dq, double coulomb_speed) {
    if (fabs(dq) <= coulomb_speed || dq == 0.0) return (mr_interval){-1.0, 1.0};
    const double s = mr_smooth_sign(dq, coulomb_speed);
    return dq > 0.0 ? (mr_interval){s, 1.0} : (mr_interval){-1.0, s};
}

void mr_add_drives_box(const mr_model *model, const mr_bounds *bounds, const double *dq,
                       const double *ddq_a, double *lo, double *hi) {
    const mr_parameters *l = &bounds->lower, *h = &bounds->upper;
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_interval coulomb = {l->coulomb[i], h->coulomb[i]};
        mr_interval sum = mr_i_scale(dq[i], (mr_interval){l->viscous[i], h->viscous[i]});
        if (coulomb.hi > 0.0)
            sum = mr_i_add(sum, mr_i_mul(coulomb, sign_box(dq[i], model->coulomb_speed[i])));
        sum = mr_i_add(sum, mr_i_scale(reflected(model, i) * ddq_a[i],
                                       (mr_interval){l->rotor_inertia[i], h->rotor_inertia[i]}));
        lo[i] += sum.lo;
        hi[i] += sum.hi;
    }
}

void mr_add_drives_deviation(const mr_model *model, const mr_bounds *bounds, const double *dq,
                             const double *ddq_a, double *lo, double *hi) {
    const mr_parameters *c = &bounds->nominal, *l = &bounds->lower, *h = &bounds->upper;
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_interval viscous = {l->viscous[i] - c->viscous[i], h->viscous[i] - c->viscous[i]};
        const mr_interval rotor = {l->rotor_inertia[i] - c->rotor_inertia[i],
                                   h->rotor_inertia[i] - c->rotor_inertia[i]};
        mr_interval sum = mr_i_add(mr_i_scale(dq[i], viscous),
                                   mr_i_scale(reflected(model, i) * ddq_a[i], rotor));
        if (h->coulomb[i] > 0.0) {
            const double speed = model->coulomb_speed[i];
            const mr_interval coulomb =
                mr_i_mul((mr_interval){l->coulomb[i], h->coulomb[i]}, sign_box(dq[i], speed));
            const double nominal = c->coulomb[i] * mr_smooth_sign(dq[i], speed);
            sum = mr_i_add(sum, (mr_interval){coulomb.lo - nominal, coulomb.hi - nominal});
        }
        lo[i] += sum.lo;
        hi[i] += sum.hi;
    }
}
