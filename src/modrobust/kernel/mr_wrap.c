/* The error of a joint that wraps, (4): q_d - q less whole turns. */
#include "mr_internal.h"

/* 2 pi: 31 bits, so that k times them is exact, and the nearest double of the rest; what is missing
 * is below 2^-85. */
static const double TURN = 0x1.921fb544p+2, TURN_REST = 0x1.0b4611a626331p-32;
static const double TURNS = 0x1.45f306dc9c883p-3; /* 1 / (2 pi) */
static const double HALF = 0x1.921fb54442d18p+1;  /* the largest double below pi */

/* 1.5 * 2^52: adding and subtracting it rounds to the nearest whole number. */
static const double ROUND = 0x1.8p52;

/* Of each turn that is taken off: more than all its rounding in units of MR_U, but that of e. */
static const double PER_TURN = 0x1p-27;

mr_error mr_wrapped_error(double q_des, double q) {
    const double sum = q_des - q;
    if (!(fabs(q_des) <= MR_ANGLE_MAX && fabs(q) <= MR_ANGLE_MAX))
        return (mr_error){sum, fabs(sum)}; /* refused where angles are checked */
    const double part = q_des - sum; /* sum + lost is the exact difference */
    const double lost = (q_des - (sum + part)) + (part - q);
    double k = (sum * TURNS + ROUND) - ROUND, e = (sum - k * TURN) - (k * TURN_REST - lost);
    if (fabs(e) > HALF) { /* the quotient's rounding, next to half a turn */
        k += e > 0.0 ? 1.0 : -1.0;
        e = (sum - k * TURN) - (k * TURN_REST - lost);
    }
    return (mr_error){e, fabs(e) + PER_TURN * fabs(k)};
}

int mr_beyond_wrapping(const mr_model *model, const double *q_des) {
    int beyond = 0;
    if (model->wraps)
        for (int32_t i = 0; i < model->n; ++i)
            beyond |= (model->wraps[i] != 0) & (fabs(q_des[i]) > MR_ANGLE_MAX);
    return beyond;
}

mr_status mr_do_tracking_error(const mr_model *model, const double *q, const double *q_des,
                               double *error) {
    if (!(mr_all_finite(model->n, q) & mr_all_finite(model->n, q_des))) return MR_NOT_FINITE;
    if (mr_beyond_wrapping(model, q) | mr_beyond_wrapping(model, q_des)) return MR_ANGLE_RANGE;
    for (int32_t i = 0; i < model->n; ++i)
        if (!isfinite(mr_error_of(model, i, q_des, q))) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->n; ++i) error[i] = mr_error_of(model, i, q_des, q);
    return MR_OK;
}
