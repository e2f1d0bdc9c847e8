/* A-priori bound of the rounding error: sizes (25) of all that is computed, by the triangle
 * inequality, times a rate that the proof in docs/guarantees.md counts out, (26). */
#include "mr_internal.h"
#include "mr_rounding.h"

MR_REAL mr_motion_sizes(const mr_model *model, const mr_state *state, mr_size *sizes) {
    const double *g = model->gravity;
    const double g_size = fabs(g[0]) + fabs(g[1]) + fabs(g[2]);
    MR_REAL followed = MR_SPLAT(0.0);
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_joint_constants *constants = &mr_of_joints(model)[i];
        const MR_REAL dq = MR_ABS(state->dq[i]), dq_a = MR_ABS(state->dq_a[i]);
        const MR_REAL ddq_a = MR_ABS(state->ddq_a[i]);
        const int revolute = model->joint_type[i] == MR_REVOLUTE;
        mr_size *own = &sizes[i];
        MR_REAL q = MR_ABS(state->q[i]);
        own->follower = MR_SPLAT(0.0);
        if (i >= model->n) {
            const int32_t k = i - model->n;
            q = fabs(model->multiplier[k]) * MR_ABS(state->q[model->leader[k]]) +
                fabs(model->offset[k]);
            if (revolute) {
                own->follower = 3.0 * q;
                followed += own->follower;
            }
        }
        if (model->parent[i] < 0) {
            own->w = own->wa = own->dw = own->K = MR_SPLAT(0.0);
            own->a = MR_SPLAT(g_size + MR_TINY);
            own->reach = MR_SPLAT(MR_TINY);
        } else {
            const mr_size *parent = &sizes[model->parent[i]];
            own->w = parent->w;
            own->wa = parent->wa;
            own->dw = parent->dw;
            own->a = parent->a + parent->K * constants->before_norm;
            own->reach = parent->reach + constants->before_norm;
        }
        if (revolute) {
            own->dw += ddq_a + dq * own->wa + MR_TINY;
            own->w += dq;
            own->wa += dq_a;
            own->p = MR_SPLAT(constants->lever_norm);
        } else {
            own->a += ddq_a + dq * own->wa + dq_a * own->w;
            own->p = constants->lever_norm + q;
        }
        own->K = own->dw + own->w * own->wa + MR_TINY;
        own->a += own->K * own->p;
        own->reach += own->p;
        own->f = own->n = own->df = own->dn = MR_SPLAT(MR_TINY);
    }
    return followed;
}

/* Force and moment of a body with these norms, about its link frame's origin. */
static void add_body_size(const mr_model *model, const mr_body_norms *norms, int32_t b,
                     mr_size *link) {
    const double lever = mr_of_bodies(model)[b].lever_norm + norms->com;
    const MR_REAL force = norms->mass * (link->a + link->K * lever) + MR_TINY;
    link->f += force;
    link->n += force * lever + norms->inertia * link->K;
}

/* Change of the same over the box of an uncertain body. Moments about every joint that carries it
 * are sized by the way from the base, because positions are differences of such ways. */
static MR_REAL add_change(const mr_model *model, const mr_body_norms *nominal,
                          const mr_body_box *box, int32_t b, mr_size *link) {
    const double lever = mr_of_bodies(model)[b].lever_norm + nominal->com;
    const MR_REAL reach = link->reach + lever;
    const MR_REAL acceleration = link->a + link->K * lever;
    const MR_REAL bent = acceleration + link->K * box->com_norm;
    link->df += box->mass_change * acceleration + box->mass_largest * link->K * box->com_norm;
    link->dn += box->mass_change * acceleration * reach +
                box->mass_largest * (bent + link->K * reach) * box->com_norm +
                box->inertia_norm * link->K;
    return bent * (1.0 + reach + box->com_norm);
}

/* Sizes of the forces and moments at the joints, and of the drives' torques. */
static void add_up(const mr_model *model, mr_size *sizes) {
    for (int32_t i = model->j - 1; i >= 0; --i) {
        mr_size *own = &sizes[i];
        own->n += own->p * own->f;
        if (model->parent[i] < 0) continue;
        mr_size *parent = &sizes[model->parent[i]];
        const MR_REAL before = MR_SPLAT(mr_of_joints(model)[i].before_norm);
        parent->f += own->f;
        parent->n += own->n + before * own->f;
        parent->df += own->df;
        parent->dn += own->dn;
    }
}

static MR_REAL drive_size(const mr_model *model, const mr_parameters *parameters, int32_t i,
                          const mr_state *state) {
    const double k = model->gear_ratio[i];
    return parameters->viscous[i] * MR_ABS(state->dq[i]) + parameters->coulomb[i] +
           k * k * parameters->rotor_inertia[i] * MR_ABS(state->ddq_a[i]);
}

/* Rate (26) for the followers' share `turns`, infinite where the proof ends. */
static MR_REAL rate_of(const mr_model *model, double joint, double once, MR_REAL turns) {
    const MR_REAL rate = (MR_U * MR_SECOND_ORDER) *
                         (joint * mr_of_model(model)->depth + once + model->b + 2.0 * model->j +
                          turns);
    return MR_SELECT(rate <= MR_RATE_MAX, rate, MR_SPLAT((double)INFINITY));
}

/* Products stay in range where these are below MR_HUGE. */
static MR_REAL largest_motion(const mr_model *model, const mr_size *sizes) {
    MR_REAL largest = MR_SPLAT(0.0);
    for (int32_t i = 0; i < model->j; ++i)
        largest += sizes[i].a + sizes[i].K + sizes[i].w + sizes[i].wa + sizes[i].reach;
    return largest;
}

/* slack holds the drives' sizes and gets rates times sizes; infinite where a product could have
 * overflowed unseen. */
static void weigh(const mr_model *model, MR_REAL followed, MR_REAL largest, const mr_size *sizes,
                  MR_REAL *slack) {
    const double defect = 4.0 * mr_of_model(model)->defect / MR_U;
    const MR_REAL nominal =
        rate_of(model, MR_NOMINAL_JOINT, MR_NOMINAL_ONCE, MR_NOMINAL_TURNS * followed);
    const MR_REAL change = rate_of(model, MR_CHANGE_JOINT, MR_CHANGE_ONCE + defect,
                                   MR_CHANGE_TURNS * followed);
    for (int32_t i = 0; i < model->j; ++i) {
        const int revolute = model->joint_type[i] == MR_REVOLUTE;
        const MR_REAL size = (revolute ? sizes[i].n : sizes[i].f) + slack[i];
        slack[i] = nominal * size + change * (revolute ? sizes[i].dn : sizes[i].df);
        slack[i] = MR_SELECT(largest + size <= MR_HUGE, slack[i], MR_SPLAT((double)INFINITY));
    }
    for (int32_t k = 0; k < model->j - model->n; ++k)
        slack[model->leader[k]] += fabs(model->multiplier[k]) * slack[model->n + k];
}

void mr_nominal_slack(const mr_model *model, const mr_parameters *parameters,
                      const mr_state *state, MR_REAL followed, int drives, mr_size *sizes,
                      MR_REAL *slack) {
    for (int32_t b = 0; b < model->b; ++b) {
        if (model->body_joint[b] < 0) continue;
        const mr_body_norms norms = mr_norms_of(parameters, b);
        add_body_size(model, &norms, b, &sizes[model->body_joint[b]]);
    }
    add_up(model, sizes);
    for (int32_t i = 0; i < model->j; ++i)
        slack[i] = drives ? drive_size(model, parameters, i, state) : MR_SPLAT(0.0);
    weigh(model, followed, largest_motion(model, sizes), sizes, slack);
}

void mr_hull_slack(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                   MR_REAL followed, int drives, mr_size *sizes, MR_REAL *slack) {
    const mr_body_norms *nominal = mr_nominal_norms(bounds);
    const mr_body_box *boxes = mr_boxes(model, bounds);
    MR_REAL largest = largest_motion(model, sizes);
    for (int32_t b = 0; b < model->b; ++b)
        if (model->body_joint[b] >= 0)
            add_body_size(model, &nominal[b], b, &sizes[model->body_joint[b]]);
    for (int32_t k = 0; k < bounds->uncertain_count; ++k) {
        const int32_t b = bounds->uncertain[k];
        if (model->body_joint[b] >= 0)
            largest += add_change(model, &nominal[b], &boxes[k], b, &sizes[model->body_joint[b]]);
    }
    add_up(model, sizes);
    for (int32_t i = 0; i < model->j; ++i)
        slack[i] = drives ? drive_size(model, &bounds->upper, i, state) : MR_SPLAT(0.0);
    weigh(model, followed, largest, sizes, slack);
}
