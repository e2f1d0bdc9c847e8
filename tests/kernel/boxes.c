/* The product of boxes in `ianea` as a function, for test_interval_vectors.py. */
#include "mr_ianea.c"

void product_of(double x, double x_rad, double y, double y_rad, double out[2]) {
    double lane[MR_LANES];
    mr_lane mid, rad;
    product(MR_LANE_SPLAT(x), MR_LANE_SPLAT(x_rad), MR_LANE_SPLAT(y), MR_LANE_SPLAT(y_rad), &mid,
            &rad);
    mr_lane_store(mid, lane);
    out[0] = lane[0];
    mr_lane_store(rad, lane);
    out[1] = lane[0];
}
