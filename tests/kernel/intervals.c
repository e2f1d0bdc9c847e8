/* The kernel's inline interval operations as functions, for test_interval_vectors.py. */
#include "mr_vector.h"

static mr_interval of(const double x[2]) { return (mr_interval){x[0], x[1]}; }

static void store(mr_interval x, double out[2]) {
    out[0] = x.lo;
    out[1] = x.hi;
}

void add(const double *x, const double *y, double *out) { store(mr_i_add(of(x), of(y)), out); }
void sub(const double *x, const double *y, double *out) { store(mr_i_sub(of(x), of(y)), out); }
void mul(const double *x, const double *y, double *out) { store(mr_i_mul(of(x), of(y)), out); }
void scale(const double *k, const double *x, double *out) { store(mr_i_scale(*k, of(x)), out); }
