/* Sine and cosine, lane by lane: reduction by a pi/2 in three parts, then Taylor polynomials on [-pi/4, pi/4].
 *
 * For |x| <= 1e5 the multiple k of pi/2 has at most 16 bits, so that k times the first two parts
 * (33 bits each) is exact; the third part leaves an absolute error below 2^-100. The first
 * omitted Taylor terms, y^19 / 19! and y^18 / 18!, are below 2^-61 relative to the results. The
 * error bound and its proof: docs/theory/rounding.md, Lemma 2. */
#include "mr_internal.h"

static const double TWO_OVER_PI = 0x1.45f306dc9c883p-1;
static const double HALF_PI_1 = 0x1.921fb54400000p+0;
static const double HALF_PI_2 = 0x1.0b4611a600000p-34;
static const double HALF_PI_3 = 0x1.3198a2e037073p-69;

/* 1.5 * 2^52: adding and subtracting it rounds to the nearest integer, and the sum's last bits
 * are those of the integer in two's complement. */
static const double ROUND = 0x1.8p52;

void mr_sine_cosine(mr_lane x, mr_lane *sine, mr_lane *cosine) {
    const mr_lane shifted = x * TWO_OVER_PI + ROUND;
    const mr_lane k = shifted - ROUND;
    const mr_lane a = x - k * HALF_PI_1;
    const mr_lane b = k * HALF_PI_2;
    const mr_lane head = a - b;
    const mr_lane c = k * HALF_PI_3;
    const mr_lane y = head - c;
    const mr_lane t = (head - y) - c + ((a - head) - b); /* y + t is the reduced angle */

    const mr_lane z = y * y;
    const mr_lane s =
        -0x1.5555555555555p-3 +
        z * (0x1.1111111111111p-7 +
             z * (-0x1.a01a01a01a01ap-13 +
                  z * (0x1.71de3a556c734p-19 +
                       z * (-0x1.ae64567f544e4p-26 +
                            z * (0x1.6124613a86d09p-33 +
                                 z * (-0x1.ae7f3e733b81fp-41 + z * 0x1.952c77030ad4ap-49))))));
    const mr_lane r =
        0x1.5555555555555p-5 +
        z * (-0x1.6c16c16c16c17p-10 +
             z * (0x1.a01a01a01a01ap-16 +
                  z * (-0x1.27e4fb7789f5cp-22 +
                       z * (0x1.1eed8eff8d898p-29 +
                            z * (-0x1.93974a8c07c9dp-37 + z * 0x1.ae7f3e733b81fp-45)))));

    /* sin(y + t) = sin y + t cos y and cos(y + t) = cos y - t sin y to first order in t. */
    const mr_lane sin_y = y + (y * z * s + t * (1.0 - 0.5 * z));
    const mr_lane half = 0.5 * z;
    const mr_lane one = 1.0 - half;
    const mr_lane cos_y = one + (((1.0 - one) - half) + (z * z * r - t * y));

    /* Quadrant k mod 4: odd ones exchange the two, bits of k and k + 1 give the signs. */
    const mr_lane_mask quadrant = MR_LANE_BITS(shifted);
    const mr_lane_mask odd = (quadrant & 1) != 0;
    const mr_lane first = MR_LANE_SELECT(odd, cos_y, sin_y),
                  second = MR_LANE_SELECT(odd, sin_y, cos_y);
    *sine = MR_LANE_SELECT((quadrant & 2) != 0, -first, first);
    *cosine = MR_LANE_SELECT(((quadrant + 1) & 2) != 0, -second, second);
}

#ifndef MR_BATCH
void mr_do_sincos(double x, double *sine, double *cosine) {
    double s[MR_LANES], c[MR_LANES];
    mr_lane lane_s, lane_c;
    mr_sine_cosine(MR_LANE_SPLAT(x), &lane_s, &lane_c);
    mr_lane_store(lane_s, s);
    mr_lane_store(lane_c, c);
    *sine = s[0];
    *cosine = c[0];
}
#endif
