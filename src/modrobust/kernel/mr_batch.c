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
#define mr_follow MR_BATCH_NAME(follow)
#define mr_lead MR_BATCH_NAME(lead)
#define mr_lead_box MR_BATCH_NAME(lead_box)
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

/* Column i of up to a register's number of rows; the last row fills what is missing. */
static mr_lane gather(const double *rows, int32_t n, int32_t i, int64_t count) {
    double lane[MR_LANES];
    for (int64_t l = 0; l < MR_LANES; ++l) lane[l] = rows[(l < count ? l : count - 1) * n + i];
    return mr_lane_load(lane);
}

/* What mr_full_state checks. */
static mr_status check_row(const mr_model *model, const double *const given[4], int64_t row) {
    const int32_t n = model->n;
    int beyond = 0;
    for (int v = 0; v < 4; ++v)
        if (!mr_all_finite(n, given[v] + row * n)) return MR_NOT_FINITE;
    for (int32_t i = 0; i < model->j; ++i) {
        const int64_t at = row * n + (i < n ? i : model->leader[i - n]);
        double q = given[0][at];
        if (i >= n) {
            const double multiplier = model->multiplier[i - n];
            q = multiplier * q + model->offset[i - n];
            if (!isfinite(q)) return MR_NOT_FINITE;
            for (int v = 1; v < 4; ++v)
                if (!isfinite(multiplier * given[v][at])) return MR_NOT_FINITE;
        }
        if (model->joint_type[i] == MR_REVOLUTE && fabs(q) > MR_ANGLE_MAX) beyond = 1;
    }
    return beyond ? MR_ANGLE_RANGE : MR_OK;
}

/* Rows from `first` to first + count, at most a register's number of them. */
static mr_status block(const mr_model *model, const mr_bounds *bounds, mr_method method,
                       int64_t first, int64_t count, const double *const given[4], int drives,
                       double *workspace, double *tau_lo, double *tau_hi, int64_t *row) {
    const int32_t n = model->n;
    mr_lane *lanes[4];
    mr_workspace ws = view_of(model, workspace, lanes);
    for (*row = first; *row < first + count; ++*row) {
        const mr_status status = check_row(model, given, *row);
        if (status) return status;
    }
    for (int v = 0; v < 4; ++v)
        for (int32_t i = 0; i < n; ++i) lanes[v][i] = gather(given[v] + first * n, n, i, count);
    mr_state state = {lanes[0], lanes[1], lanes[2], lanes[3], NULL, NULL};
    if (model->j > n) mr_follow(model, &state, ws.full);
    mr_torque_box(model, bounds, method, &state, drives, &ws);
    mr_total_bounds(model, method, &ws);
    for (int32_t i = 0; i < n; ++i) {
        double lo[MR_LANES], hi[MR_LANES];
        mr_lane_store(ws.lo[i], lo);
        mr_lane_store(ws.hi[i], hi);
        for (int64_t l = 0; l < count; ++l) {
            tau_lo[(first + l) * n + i] = lo[l];
            tau_hi[(first + l) * n + i] = hi[l];
        }
    }
    for (*row = first; *row < first + count; ++*row)
        if (!mr_all_finite(n, tau_lo + *row * n) || !mr_all_finite(n, tau_hi + *row * n))
            return MR_NOT_FINITE;
    return MR_OK;
}

#define ENTRY MR_JOIN(mr_inverse_dynamics_bounds_batch, MR_BATCH_SUFFIX)

mr_status ENTRY(const mr_model *model, const mr_bounds *bounds, mr_method method, int64_t count,
                const double *q, const double *dq, const double *dq_a, const double *ddq_a,
                int drives, double *workspace, double *tau_lo, double *tau_hi, int64_t *row) {
    const double *const given[4] = {q, dq, dq_a, ddq_a};
    const mr_environment caller = mr_enter();
    mr_status status = mr_is_sound(bounds) ? MR_OK : MR_NOT_FINITE;
    *row = 0;
    for (int64_t first = 0; first < count && !status; first += MR_LANES) {
        const int64_t left = count - first;
        status = block(model, bounds, method, first, left < MR_LANES ? left : MR_LANES, given,
                       drives, workspace, tau_lo, tau_hi, row);
    }
    mr_leave(caller);
    return status;
}
