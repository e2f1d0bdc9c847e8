/* One pass: nominal torque and its box at one state, or at a register of states. */
#include "mr_internal.h"

void mr_torque_box(const mr_model *model, const mr_bounds *bounds, mr_method method,
                   const mr_state *state, int drives, const mr_workspace *ws) {
    mr_newton_euler(model, mr_nominal_point(bounds), state, ws, ws->mid);
    const mr_motion_size size = mr_size_of_motion(model, state, ws);
    if (drives) mr_add_drives(model, &bounds->nominal, state, ws->mid);
    mr_fold_mimic_torque(model, ws->mid);
    if (method == MR_IANEA) {
        mr_ianea(model, bounds, &size, ws);
        if (drives) mr_add_drives_box(model, bounds, state, ws->lo, ws->hi);
    } else {
        mr_hull_deviation(model, bounds, ws);
        if (drives) mr_add_drives_deviation(model, bounds, state, ws->lo, ws->hi);
        mr_rounding_slack(model, mr_factors(bounds), mr_hull_slack_constants(model, bounds),
                          drives ? &bounds->upper : NULL, state, &size, ws->slack);
    }
    mr_fold_mimic_box(model, ws->lo, ws->hi);
}

void mr_total_bounds(const mr_model *model, mr_method method, const mr_workspace *ws) {
    if (method == MR_IANEA) return;
    for (int32_t i = 0; i < model->n; ++i) {
        const mr_interval total =
            mr_i_add((mr_interval){ws->lo[i], ws->hi[i]}, (mr_interval){ws->mid[i], ws->mid[i]});
        const mr_interval wide = mr_i_widen(total, ws->slack[i]);
        ws->lo[i] = wide.lo;
        ws->hi[i] = wide.hi;
    }
}
