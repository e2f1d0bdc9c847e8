/* Friction and reflected rotor inertia: (20) and (21). */
#include "mr_internal.h"
#include "mr_rounding.h"

static MR_REAL smooth_sign(MR_REAL dq, double coulomb_speed) {
    const MR_REAL speed = MR_ABS(dq), zero = MR_SPLAT(0.0);
    const MR_REAL limit = MR_SPLAT(coulomb_speed);
    const MR_MASK fast = speed > limit;
    /* the ratio is at most 1, so that its square does not overflow */
    const MR_REAL large = MR_SELECT(fast, speed, limit), small = MR_SELECT(fast, limit, speed);
    const MR_REAL ratio = small / large;
    const MR_REAL root = MR_SQRT(1.0 + ratio * ratio);
    const MR_REAL size = MR_SELECT(fast, 1.0 / root, ratio / root);
    return MR_SELECT(speed == 0.0, zero, MR_COPYSIGN(size, dq));
}

static double reflected(const mr_model *model, int32_t i) {
    return model->gear_ratio[i] * model->gear_ratio[i];
}

/* A drive that is all zero costs nothing; in most arms without figures they all are. */
static int has_drive(const mr_parameters *upper, int32_t i) {
    return upper->viscous[i] != 0.0 || upper->coulomb[i] != 0.0 || upper->rotor_inertia[i] != 0.0;
}

void mr_add_drives(const mr_model *model, const mr_parameters *parameters, const mr_state *state,
                   MR_REAL *tau) {
    for (int32_t i = 0; i < model->j; ++i) {
        if (!has_drive(parameters, i)) continue;
        MR_REAL drive = parameters->viscous[i] * state->dq[i] +
                        reflected(model, i) * parameters->rotor_inertia[i] * state->ddq_a[i];
        if (parameters->coulomb[i] != 0.0)
            drive += parameters->coulomb[i] * smooth_sign(state->dq[i], model->coulomb_speed[i]);
        tau[i] += drive;
    }
}

/* Slower than this, a Coulomb speed below the normal numbers may not be the one that was written. */
#define MR_SLOW 0x1p-960

/* Hull of the smooth and the true sign of dq: what Coulomb friction may be, (20). The smooth one
 * is off by at most 5 u of itself, a speed written in decimals included. */
static mr_interval sign_box(MR_REAL dq, double coulomb_speed) {
    const MR_REAL speed = MR_ABS(dq), one = MR_SPLAT(1.0);
    const MR_MASK free = (speed <= coulomb_speed) | (speed <= MR_SLOW);
    const MR_REAL least = MR_ABS(smooth_sign(dq, coulomb_speed)) * (1.0 - 0x1p-50);
    return (mr_interval){MR_SELECT(free, -one, MR_SELECT(dq > 0.0, least, -one)),
                         MR_SELECT(free, one, MR_SELECT(dq > 0.0, one, -least))};
}

/* Friction and rotor, less the nominal torque of each where c is given. */
static mr_interval drive_box(const mr_model *model, const mr_bounds *bounds,
                             const mr_parameters *c, int32_t i, const mr_state *state) {
    const MR_REAL dq = state->dq[i], ddq_a = state->ddq_a[i];
    const MR_REAL ddq_a_size = mr_acceleration_size(state, i);
    const mr_parameters *l = &bounds->lower, *h = &bounds->upper;
    const double viscous = c ? c->viscous[i] : 0.0, rotor = c ? c->rotor_inertia[i] : 0.0;
    const mr_interval viscous_box = {MR_SPLAT(l->viscous[i] - viscous),
                                     MR_SPLAT(h->viscous[i] - viscous)};
    const mr_interval rotor_box = {MR_SPLAT(l->rotor_inertia[i] - rotor),
                                   MR_SPLAT(h->rotor_inertia[i] - rotor)};
    /* the square of a gear ratio that is written in decimals, times ddq_a: less than 8 u of its
     * terms; a mimic joint's rate, 2 u; and what underflow may take from both */
    const double most = h->rotor_inertia[i], gear = reflected(model, i);
    const MR_REAL error =
        0x1p-50 * (gear * most * ddq_a_size) + 0x1p-51 * (h->viscous[i] * MR_ABS(dq)) +
        MR_UNDERFLOW * ((1.0 + most) * (1.0 + gear) + h->viscous[i]) * (1.0 + ddq_a_size);
    mr_interval sum = mr_i_add(mr_i_scale(dq, viscous_box),
                               mr_i_widen(mr_i_scale(gear * ddq_a, rotor_box), error));
    if (h->coulomb[i] > 0.0) {
        const double speed = model->coulomb_speed[i];
        const mr_interval coulomb = {MR_SPLAT(l->coulomb[i]), MR_SPLAT(h->coulomb[i])};
        sum = mr_i_add(sum, mr_i_mul(coulomb, sign_box(dq, speed)));
        if (c) {
            const MR_REAL nominal = c->coulomb[i] * smooth_sign(dq, speed);
            sum = mr_i_sub(sum, (mr_interval){nominal, nominal});
        }
    }
    return sum;
}

void mr_add_drives_box(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                       MR_REAL *lo, MR_REAL *hi) {
    for (int32_t i = 0; i < model->j; ++i) {
        if (!has_drive(&bounds->upper, i)) continue;
        const mr_interval drive = drive_box(model, bounds, NULL, i, state);
        const mr_interval sum = mr_i_add((mr_interval){lo[i], hi[i]}, drive);
        lo[i] = sum.lo;
        hi[i] = sum.hi;
    }
}

void mr_add_drives_deviation(const mr_model *model, const mr_bounds *bounds, const mr_state *state,
                             MR_REAL *lo, MR_REAL *hi) {
    for (int32_t i = 0; i < model->j; ++i) {
        if (!has_drive(&bounds->upper, i)) continue;
        const mr_interval drive = drive_box(model, bounds, &bounds->nominal, i, state);
        lo[i] += drive.lo;
        hi[i] += drive.hi;
    }
}
