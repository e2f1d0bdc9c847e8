/* Operations on boxes of `ianea` as functions, for test_interval_vectors.py. */
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

void turned(const double R[9], double error, const double x[6], double out[6]) {
    ROTATE_BOX(double, fabs, R, error, x, x + 3, out, out + 3);
}

/* out += lever (x) force */
void moment(const double lever[3], double error, const double force[6], double out[6]) {
    ADD_MOMENT(double, fabs, lever, error, force, force + 3, out, out + 3);
}

void sum(const double x[6], double out[6]) { accumulate(x, x + 3, out, out + 3); }
