/* Bounds of the torque for many states, a register of them at a time.
 *
 * The files of the pass are included once more, here for registers in place of doubles; their
 * functions get names of their own. So does this file's, where it is compiled again for wider
 * registers. */
#define MR_BATCH
#ifndef MR_BATCH_SUFFIX
#define MR_BATCH_SUFFIX
#endif
#define MR_JOIN_(name, suffix) name##suffix
#define MR_JOIN(name, suffix) MR_JOIN_(name, suffix)
#define MR_BATCH_NAME(name) MR_JOIN(mr_batch_##name, MR_BATCH_SUFFIX)

#define mr_sine_cosine MR_BATCH_NAME(sine_cosine)
#define mr_expand_mimic MR_BATCH_NAME(expand_mimic)
#define mr_fold_mimic_torque MR_BATCH_NAME(fold_mimic_torque)
#define mr_fold_mimic_box MR_BATCH_NAME(fold_mimic_box)
#define mr_joint_geometry MR_BATCH_NAME(joint_geometry)
#define mr_forward_recursion MR_BATCH_NAME(forward_recursion)
#define mr_all_sines MR_BATCH_NAME(all_sines)
#define mr_body_pass MR_BATCH_NAME(body_pass)
#define mr_backward_recursion MR_BATCH_NAME(backward_recursion)
#define mr_size_of_motion MR_BATCH_NAME(size_of_motion)
#define mr_rounding_slack MR_BATCH_NAME(rounding_slack)
#define mr_newton_euler MR_BATCH_NAME(newton_euler)
#define mr_ianea MR_BATCH_NAME(ianea)
#define mr_hull_deviation MR_BATCH_NAME(hull_deviation)
#define mr_add_drives MR_BATCH_NAME(add_drives)
#define mr_add_drives_box MR_BATCH_NAME(add_drives_box)
#define mr_add_drives_deviation MR_BATCH_NAME(add_drives_deviation)
#define mr_torque_box MR_BATCH_NAME(torque_box)
#define mr_total_bounds MR_BATCH_NAME(total_bounds)

#include "mr_environment.h"
#include "mr_sincos.c"
#include "mr_kinematics.c"
#include "mr_newton_euler.c"
#include "mr_drives.c"
#include "mr_rounding.c"
#include "mr_ianea.c"
#include "mr_hull.c"
#include "mr_torque.c"

#define COUNT(type) (sizeof(type) / sizeof(mr_lane))

/* Memory in registers of doubles, cut as mr_workspace_view does, and four arrays for the states. */
static size_t registers(const mr_model *model) {
    return (size_t)model->j * (COUNT(mr_link) + COUNT(mr_wrench_box) + COUNT(mr_pose)) +
           mr_joint_stride(model) * (MR_MOTION + 9 + 2 + 4 + 6 + 4) +
           mr_body_stride(model) * MR_BODY;
}

size_t MR_JOIN(mr_batch_workspace_size, MR_BATCH_SUFFIX)(const mr_model *model) {
    return (registers(model) + 1) * 8; /* the widest register has 8; one more to align */
}

static mr_lane *cut(mr_lane **memory, size_t count) {
    mr_lane *part = *memory;
    *memory += count;
    return part;
}

static mr_workspace view_of(const mr_model *model, double *workspace, mr_lane *given[4]) {
    const size_t j = (size_t)model->j, joints = mr_joint_stride(model);
    const uintptr_t start = (uintptr_t)workspace, past = start % sizeof(mr_lane);
    mr_lane *memory = (mr_lane *)(start + (past ? sizeof(mr_lane) - past : 0));
    mr_workspace ws;
    ws.links = (mr_link *)cut(&memory, j * COUNT(mr_link));
    ws.wrench.box = (mr_wrench_box *)cut(&memory, j * COUNT(mr_wrench_box));
    ws.poses = (mr_pose *)cut(&memory, j * COUNT(mr_pose));
    ws.motion = cut(&memory, joints * MR_MOTION);
    ws.bodies = cut(&memory, mr_body_stride(model) * MR_BODY);
    ws.axes = cut(&memory, joints * 9);
    ws.sines = cut(&memory, joints * 2);
    ws.point = NULL;
    ws.lo = cut(&memory, joints);
    ws.hi = cut(&memory, joints);
    ws.mid = cut(&memory, joints);
    ws.slack = cut(&memory, joints);
    ws.dq_a = ws.ddq_a = ws.dq_a_size = ws.ddq_a_size = NULL;
    for (int v = 0; v < 6; ++v) ws.full[v] = cut(&memory, joints);
    for (int v = 0; v < 4; ++v) given[v] = cut(&memory, joints);
    return ws;
}

/* Where the lanes' rows of up to a register's number begin; the last row fills what is missing. */
static void row_starts(int32_t n, int64_t count, int64_t start[MR_LANES]) {
    for (int64_t l = 0; l < MR_LANES; ++l) start[l] = (l < count ? l : count - 1) * n;
}

static mr_lane gather(const double *column, const int64_t start[MR_LANES]) {
    double lane[MR_LANES];
    for (int l = 0; l < MR_LANES; ++l) lane[l] = column[start[l]];
    return mr_lane_load(lane);
}

/* Row by row what mr_full_state checks: the first row that is refused, and why. */
static mr_status check_rows(const mr_model *model, const double *const given[4], int64_t count,
                            int64_t *row) {
    const int32_t n = model->n;
    for (*row = 0; *row < count; ++*row) {
        int beyond = 0;
        for (int v = 0; v < 4; ++v)
            if (!mr_all_finite(n, given[v] + *row * n)) return MR_NOT_FINITE;
        for (int32_t i = 0; i < model->j; ++i) {
            const int64_t at = *row * n + (i < n ? i : model->leader[i - n]);
            double q = given[0][at];
            if (i >= n) {
                const double multiplier = model->multiplier[i - n];
                q = multiplier * q + model->offset[i - n];
                if (!isfinite(q)) return MR_NOT_FINITE;
                for (int v = 1; v < 4; ++v)
                    if (!isfinite(multiplier * given[v][at])) return MR_NOT_FINITE;
            }
            const int32_t joint = model->j > n ? model->moves[i] : i;
            if (model->joint_type[joint] == MR_REVOLUTE && fabs(q) > MR_ANGLE_MAX) beyond = 1;
        }
        if (beyond) return MR_ANGLE_RANGE;
    }
    return MR_OK;
}

/* The same of all rows at once. */
static int state_is_good(const mr_model *model, const mr_state *state) {
    const mr_lane *given[4] = {state->q, state->dq, state->dq_a, state->ddq_a};
    const mr_lane zero = MR_SPLAT(0.0);
    mr_lane_mask good = zero == zero;
    for (int32_t i = 0; i < model->j; ++i) {
        for (int v = 0; v < 4; ++v) good &= MR_ABS(given[v][i]) <= DBL_MAX;
        if (model->joint_type[i] == MR_REVOLUTE) good &= MR_ABS(state->q[i]) <= MR_ANGLE_MAX;
    }
    return mr_lane_all(good);
}

/* Up to a register's number of rows; *row is the one that is refused. */
static mr_status block(const mr_model *model, const mr_bounds *bounds, mr_method method,
                       int64_t count, const double *const given[4], int drives, double *workspace,
                       double *tau_lo, double *tau_hi, int64_t *row) {
    const int32_t n = model->n;
    int64_t start[MR_LANES];
    mr_lane *lanes[4];
    mr_workspace ws = view_of(model, workspace, lanes);
    row_starts(n, count, start);
    for (int v = 0; v < 4; ++v)
        for (int32_t i = 0; i < n; ++i) lanes[v][i] = gather(given[v] + i, start);
    mr_state state = {lanes[0], lanes[1], lanes[2], lanes[3], NULL, NULL};
    if (model->j > n) mr_expand_mimic(model, &state, ws.full);
    if (!state_is_good(model, &state)) return check_rows(model, given, count, row);
    mr_torque_box(model, bounds, method, &state, drives, &ws);
    mr_total_bounds(model, method, &ws);
    const mr_lane zero = MR_SPLAT(0.0);
    mr_lane_mask good = zero == zero;
    for (int32_t i = 0; i < n; ++i) {
        double lo[MR_LANES], hi[MR_LANES];
        good &= (MR_ABS(ws.lo[i]) <= DBL_MAX) & (MR_ABS(ws.hi[i]) <= DBL_MAX);
        mr_lane_store(ws.lo[i], lo);
        mr_lane_store(ws.hi[i], hi);
        for (int64_t l = 0; l < count; ++l) {
            tau_lo[l * n + i] = lo[l];
            tau_hi[l * n + i] = hi[l];
        }
    }
    if (mr_lane_all(good)) return MR_OK;
    for (*row = 0; *row < count - 1; ++*row)
        if (!mr_all_finite(n, tau_lo + *row * n) || !mr_all_finite(n, tau_hi + *row * n)) break;
    return MR_NOT_FINITE;
}

#define ENTRY MR_JOIN(mr_inverse_dynamics_bounds_batch, MR_BATCH_SUFFIX)

mr_status ENTRY(const mr_model *model, const mr_bounds *bounds, mr_method method, int64_t count,
                const double *q, const double *dq, const double *dq_a, const double *ddq_a,
                int drives, double *workspace, double *tau_lo, double *tau_hi, int64_t *row) {
    const mr_environment caller = mr_enter();
    mr_status status = mr_is_sound(bounds) ? MR_OK : MR_NOT_FINITE;
    *row = 0;
    for (int64_t first = 0; first < count && !status; first += MR_LANES) {
        const int64_t left = count - first, at = first * model->n;
        const double *const given[4] = {q + at, dq + at, dq_a + at, ddq_a + at};
        status = block(model, bounds, method, left < MR_LANES ? left : MR_LANES, given, drives,
                       workspace, tau_lo + at, tau_hi + at, row);
        *row = status ? *row + first : count; /* the last block's word counts */
    }
    mr_leave(caller);
    return status;
}
