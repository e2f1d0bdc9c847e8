/* What the proof of docs/theory/guarantees.md assumes about the machine and the build, tried
 * out. */
#include "mr_environment.h"
#include "mr_internal.h"

/* Each line names the assumption that it tries. Operands are volatile, so that the machine computes
 * and not the compiler. */
static int assumptions_hold(void) {
    volatile double one = 1.0, u = 0x1p-53, small = 0x1p-1022, tiny = 0x1p-1074, three = 3.0;
    volatile double x = 0x1.0000001p0, product, sum;
    int ok = sizeof(double) == 8 && FLT_EVAL_METHOD == 0;
    ok &= one + u == one && one + 3.0 * u == one + 4.0 * u;       /* ties to even, adding */
    ok &= -one - u == -one && one - u == 0x1.fffffffffffffp-1;     /* and on the other side */
    ok &= one / three == 0x1.5555555555555p-2;                     /* division to nearest */
    ok &= sqrt(2.0 * one) == 0x1.6a09e667f3bcdp0;                  /* root to nearest */
    ok &= 0.5 * small > 0.0 && tiny > 0.0 && tiny + tiny == 0x1p-1073; /* subnormals */
    product = x * x;
    sum = product - 0x1.0000002p0;                                 /* no contraction: 2^-56 is */
    ok &= x * x - 0x1.0000002p0 == sum && sum == 0.0;              /* lost in the product */
    sum = (1.0 + 0x1p-30 * one) + 0x1p-60;                         /* no reassociation */
    ok &= sum - 1.0 == 0x1p-30;
    ok &= (double)INFINITY > DBL_MAX && (double)NAN != (double)NAN;
    double s, c;
    mr_do_sincos(2.0 * one, &s, &c);
    ok &= s == 0x1.d18f6ead1b446p-1 && c == -0x1.aa22657537205p-2;
    return ok;
}

mr_status mr_self_test(void) {
    const mr_environment caller = mr_enter();
    const int ok = assumptions_hold();
    mr_leave(caller);
    return ok ? MR_OK : MR_PLATFORM;
}
