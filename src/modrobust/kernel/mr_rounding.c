/* Bound of the rounding error: sizes (25) of the computed motion, times constants of the robot that
 * mr_prepare.c makes, (26). Proof: docs/theory/rounding.md. */
#include "mr_internal.h"
#include "mr_rounding.h"

/* Over the joints of a register; a batch has one joint in it. */
static inline MR_REAL largest_lane(mr_lane x) {
#ifdef MR_BATCH
    return x;
#else
    double lane[MR_LANES];
    mr_lane_store(x, lane);
    for (int half = MR_LANES / 2; half > 0; half /= 2)
        for (int k = 0; k < half; ++k) lane[k] = MR_MAX(lane[k], lane[k + half]);
    return lane[0];
#endif
}

/* Largest sum of the sizes of a vector's entries, over all links: no square is out of range. */
static MR_REAL largest_sum(const mr_model *model, const MR_REAL *vector) {
    const size_t stride = mr_joint_stride(model);
    mr_lane sum = MR_LANE_SPLAT(0.0);
    for (int32_t i = 0; i < model->j; i += MR_BLOCK) {
        const mr_lane here = MR_LANE_ABS(MR_TAKE(vector, i)) +
                             MR_LANE_ABS(MR_TAKE(vector + stride, i)) +
                             MR_LANE_ABS(MR_TAKE(vector + 2 * stride, i));
        sum = MR_LANE_SELECT(here > sum, here, sum);
    }
    return largest_lane(sum);
}

/* Largest Euclidean norm of a vector of the motion, over all links. */
static inline MR_REAL largest_norm(const mr_model *model, const MR_REAL *vector) {
    const size_t stride = mr_joint_stride(model);
    mr_lane square = MR_LANE_SPLAT(0.0);
    for (int32_t i = 0; i < model->j; i += MR_BLOCK) {
        const mr_lane v[3] = {MR_TAKE(vector, i), MR_TAKE(vector + stride, i),
                              MR_TAKE(vector + 2 * stride, i)};
        const mr_lane here = mr_dot(v, v);
        square = MR_LANE_SELECT(here > square, here, square);
    }
    const MR_REAL squares = largest_lane(square);
    const MR_MASK good = (squares > 0x1p-900) & (squares < 0x1p900);
    const MR_REAL norm = MR_SQRT(squares);
    if (MR_ALL(good)) return norm;
    return MR_SELECT(good, norm, largest_sum(model, vector));
}

mr_motion_size mr_size_of_motion(const mr_model *model, const mr_state *state,
                                 const mr_workspace *ws) {
    const size_t stride = mr_joint_stride(model);
    const double *g = model->gravity;
    const MR_REAL zero = MR_SPLAT(0.0);
    MR_REAL w = largest_norm(model, ws->motion + MR_W * stride);
    MR_REAL wa = largest_norm(model, ws->motion + MR_WA * stride);
    MR_REAL dw = largest_norm(model, ws->motion + MR_DW * stride);
    MR_REAL a = largest_norm(model, ws->motion + MR_A * stride);
    MR_REAL turning = zero, v = zero, va = zero, dv = zero;
    double multipliers = 1.0;
    mr_motion_size size;
    size.mimic_angle = size.prismatic_reach = zero;
    for (int32_t i = 0; i < model->j; ++i) {
        if (model->joint_type[i] == MR_REVOLUTE) {
            turning += MR_ABS(state->dq[i]);
        } else {
            v += MR_ABS(state->dq[i]);
            va += MR_ABS(state->dq_a[i]);
            dv += MR_ABS(state->ddq_a[i]);
            size.prismatic_reach += MR_ABS(state->q[i]);
        }
        if (state->dq_a_size) { /* sums: their rounding counts an eighth, or fully in a */
            wa += 0.125 * state->dq_a_size[i];
            dw += 0.125 * state->ddq_a_size[i];
            if (model->joint_type[i] != MR_REVOLUTE) {
                va += state->dq_a_size[i];
                dv += state->ddq_a_size[i];
            }
        }
    }
    for (int32_t k = 0; k < model->j - model->n; ++k) { /* before the sum may have cancelled */
        const MR_REAL leader = MR_ABS(state->q[model->moves[model->leader[k]]]);
        const MR_REAL q = fabs(model->multiplier[k]) * leader + fabs(model->offset[k]);
        if (model->joint_type[model->moves[model->n + k]] == MR_REVOLUTE)
            size.mimic_angle += 3.0 * q;
        else
            size.prismatic_reach += q;
        multipliers += fabs(model->multiplier[k]);
    }
    a += fabs(g[0]) + fabs(g[1]) + fabs(g[2]);
    size.rotation = dw + 2.0 * ((w + turning) * wa);
    size.acceleration = a + dv + v * wa + va * w;
    size.underflow = (MR_UNDERFLOW * multipliers) *
                     (1.0 + w + wa + turning + v + va + size.acceleration + size.rotation);
    return size;
}

void mr_rounding_slack(const mr_model *model, const mr_slack_factors *factors,
                       const mr_slack_constants *constants, const mr_parameters *parameters,
                       const mr_state *state, const mr_motion_size *size, MR_REAL *slack) {
    const MR_REAL distance = (1.0 + factors->reach) + size->prismatic_reach,
                  infinite = MR_SPLAT((double)INFINITY);
    const MR_REAL largest =
        distance * (size->acceleration + size->rotation * distance); /* of products to come */
    const MR_REAL growth = 1.0 + MR_MIMIC_ANGLE * size->mimic_angle;
    const MR_REAL underflow = (size->underflow * distance * distance) * (1.0 + factors->mass_max);
    const MR_MASK safe = (largest <= MR_HUGE) & (growth <= 0x1p20);
    const double drive_rate = MR_U * (MR_DRIVE + (model->j - model->n)); /* their sums too */
    for (int32_t i = 0; i < model->j; ++i) {
        const mr_slack_constants *c = &constants[i];
        MR_REAL sum = size->acceleration * c->acceleration + size->rotation * c->rotation;
        if (mr_of_model(model)->prismatic != 0.0)
            sum += size->prismatic_reach *
                   (size->acceleration * c->acceleration_prismatic +
                    size->rotation * (c->rotation_prismatic +
                                      c->acceleration_prismatic * size->prismatic_reach));
        if (parameters) {
            const double gear = model->gear_ratio[i] * model->gear_ratio[i];
            const double viscous = fabs(parameters->viscous[i]);
            const double rotor = fabs(parameters->rotor_inertia[i]);
            const MR_REAL dq = MR_ABS(state->dq[i]);
            const MR_REAL ddq_a = mr_acceleration_size(state, i);
            sum += drive_rate *
                   (viscous * dq + fabs(parameters->coulomb[i]) + (gear * rotor) * ddq_a);
            sum += MR_UNDERFLOW * ((1.0 + rotor) * (1.0 + gear) + viscous) * (1.0 + ddq_a);
        }
        sum = sum * growth + underflow;
        slack[i] = MR_SELECT(safe, sum, infinite);
    }
    const int32_t n = model->n, *moves = model->moves;
    if (model->j == n) return;
    for (int32_t k = 0; k < model->j - n; ++k)
        slack[moves[model->leader[k]]] += fabs(model->multiplier[k]) * slack[moves[n + k]];
    for (int32_t i = 0; i < n; ++i) slack[i] = slack[moves[i]];
}
