/* The floating-point environment: rounding to nearest, subnormal numbers neither flushed nor read
 * as zero. Other libraries leave it changed, or change it when they are loaded. */
#ifndef MR_ENVIRONMENT_H
#define MR_ENVIRONMENT_H

#include <stdint.h>

typedef uint64_t mr_environment;

/* Sets ours and returns the caller's; mr_leave restores it. */
mr_environment mr_enter(void);
void mr_leave(mr_environment caller);

#endif
