/* A-priori bound of the rounding error: sizes (25) of the motion by the triangle inequality, times
 * constants of the robot that mr_prepare.c makes, (26). Proof: docs/guarantees.md. */
#include "mr_internal.h"
#include "mr_rounding.h"

mr_motion_size mr_size_of_motion(const mr_model *model, const mr_state *state) {
    const double *g = model->gravity;
    const MR_REAL zero = MR_SPLAT(0.0);
    MR_REAL w = zero, wa = zero, dw = zero, v = zero, va = zero, dv = zero;
    mr_motion_size size;
    size.followed = size.out = zero;
    for (int32_t i = 0; i < model->j; ++i) {
        const MR_REAL dq = MR_ABS(state->dq[i]), dq_a = MR_ABS(state->dq_a_size[i]);
        const MR_REAL ddq_a = MR_ABS(state->ddq_a_size[i]);
        if (model->joint_type[i] == MR_REVOLUTE) {
            w += dq;
            wa += dq_a;
            dw += ddq_a;
        } else {
            v += dq;
            va += dq_a;
            dv += ddq_a;
            size.out += MR_ABS(state->q[i]);
        }
    }
    for (int32_t k = 0; k < model->j - model->n; ++k) { /* before the sum may have cancelled */
        const MR_REAL q = fabs(model->multiplier[k]) * MR_ABS(state->q[model->leader[k]]) +
                          fabs(model->offset[k]);
        if (model->joint_type[model->n + k] == MR_REVOLUTE)
            size.followed += 3.0 * q;
        else
            size.out += q;
    }
    size.k = dw + 2.0 * (w * wa);
    size.a = (fabs(g[0]) + fabs(g[1]) + fabs(g[2])) + dv + v * wa + va * w;
    size.under = MR_UNDER * (1.0 + w + wa);
    return size;
}

void mr_rounding_slack(const mr_model *model, const mr_slack_factors *factors,
                       const mr_slack_constants *constants, const mr_parameters *parameters,
                       const mr_state *state, const mr_motion_size *size, MR_REAL *slack) {
    const MR_REAL way = (1.0 + factors->reach) + size->out, infinite = MR_SPLAT((double)INFINITY);
    const MR_REAL largest = way * (size->a + size->k * way); /* of products to come */
    const MR_REAL grown = 1.0 + MR_FOLLOWED * size->followed;
    const MR_REAL under = (size->under * way * way) * (1.0 + factors->heavy);
    const MR_MASK safe = (largest <= MR_HUGE) & (grown <= 0x1p20);
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_slack_constants *c = &constants[i];
        MR_REAL sum = size->a * c->a + size->k * c->k;
        if (mr_of_model(model)->prismatic != 0.0)
            sum += size->out * (size->a * c->a_out + size->k * (c->k_out + c->a_out * size->out));
        if (parameters) {
            const double ratio = model->gear_ratio[i], rotor = fabs(parameters->rotor_inertia[i]);
            const MR_REAL dq = MR_ABS(state->dq[i]), ddq_a = MR_ABS(state->ddq_a_size[i]);
            sum += (MR_U * MR_DRIVE) * (fabs(parameters->viscous[i]) * dq +
                                        fabs(parameters->coulomb[i]) +
                                        (ratio * ratio * rotor) * ddq_a);
            sum += MR_UNDER * (1.0 + rotor) * (1.0 + ddq_a);
        }
        sum = sum * grown + under;
        slack[i] = MR_SELECT(safe, sum, infinite);
    }
    for (int32_t k = 0; k < model->j - model->n; ++k)
        slack[model->leader[k]] += fabs(model->multiplier[k]) * slack[model->n + k];
}
