/* What program.c asks of the other library; implemented in C++. */
#ifndef PEER_H
#define PEER_H

#include "mr_kernel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The robot; order (j) lists the joints so that each subtree is contiguous. */
void peer_load(const mr_model *model, const mr_parameters *nominal, const int32_t *order);
/* One more state to run on. */
void peer_state(const double *q, const double *v, const double *a);
/* Inverse dynamics of every state; returns something that depends on all of them. */
double peer_pass(void);
/* Inverse dynamics of one state. */
void peer_torque(int32_t state, double *tau);

#ifdef __cplusplus
}
#endif
#endif
