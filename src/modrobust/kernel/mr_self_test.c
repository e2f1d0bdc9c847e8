/* What the proof of docs/theory/rounding.md assumes about the machine and the build, tried
 * out. */
#include "mr_environment.h"
#include "mr_internal.h"

/* Each line names the assumption that it tries. Operands come from volatile memory, so that the
 * machine computes and not the compiler, and each answer goes there, so that nothing is
 * computed after the caller's rounding mode is back. What a licence for a compiler would change is
 * written as plain expressions of doubles that were read once. */
static int assumptions_hold(void) {
    volatile double inputs[] = {
        1.0,       3.0,           5.0, 7.0,  0x1p-53,          0x1p-60,    0x1p-1022,
        0x1p-1074, 0x1.0000001p0, 2.0, -0.0, (double)INFINITY, (double)NAN};
    const double one = inputs[0], three = inputs[1], five = inputs[2], seven = inputs[3];
    const double u = inputs[4], little = inputs[5], small = inputs[6], tiny = inputs[7];
    const double x = inputs[8], again = inputs[8], two = inputs[9], minus_zero = inputs[10];
    const double infinity = inputs[11], nothing = inputs[12];
    volatile int ok = sizeof(double) == 8 && FLT_EVAL_METHOD == 0;
    double s, c;

    ok &= one + u == one && one + 3.0 * u == one + 4.0 * u;    /* ties to even, adding */
    ok &= -one - u == -one && one - u == 0x1.fffffffffffffp-1; /* and on the other side */
    ok &= one / three == 0x1.5555555555555p-2;                 /* division to nearest */
    ok &= one / x == 0x1.ffffffe000000p-1;
    ok &= five / 49.0 == 0x1.a1f58d0fac688p-4; /* no product with an inverse, of a */
    /* constant, nor of a divisor that several share */
    ok &= one / seven == 0x1.2492492492492p-3 && five / seven == 0x1.6db6db6db6db7p-1 &&
          three / seven == 0x1.b6db6db6db6dbp-2;
    ok &= sqrt(two) == 0x1.6a09e667f3bcdp0; /* root to nearest */
    ok &= 0.5 * small > 0.0 && tiny > 0.0 && tiny + tiny == 0x1p-1073; /* subnormals */
    ok &= x * again - 0x1.0000002p0 == 0.0; /* no contraction keeps 2^-56 */
    ok &= (one + little) - one == 0.0 && (little + one) + little == one; /* no reassociation */
    ok &= !signbit(minus_zero + 0.0); /* a zero has its sign */
    ok &= nothing != nothing && !(nothing <= infinity) && !isfinite(nothing); /* not a number, */
    ok &= infinity > DBL_MAX && !isfinite(-infinity);
    ok &= !mr_all_finite(1, &nothing) && !mr_all_finite(1, &infinity); /* and infinity are seen */
    mr_do_sincos(two, &s, &c);
    ok &= s == 0x1.d18f6ead1b446p-1 && c == -0x1.aa22657537205p-2;
    return ok;
}

mr_status mr_self_test(void) {
    const mr_environment caller = mr_enter();
    const int ok = assumptions_hold();
    mr_leave(caller);
    return ok ? MR_OK : MR_PLATFORM;
}
