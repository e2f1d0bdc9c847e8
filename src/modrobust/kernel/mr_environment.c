/* One file of its own, so that no compiler moves arithmetic across the change of environment. */
#include "mr_environment.h"

#if defined(__x86_64__) || defined(__SSE2__)

#include <xmmintrin.h>

/* MXCSR: all exceptions masked, round to nearest, no flush to zero, no denormals are zero. The low
 * six bits are flags that arithmetic has raised; they are not ours to touch. */
#define FLAGS 0x3Fu
#define OURS 0x1F80u

mr_environment mr_enter(void) {
    const uint32_t caller = _mm_getcsr();
    if ((caller & ~FLAGS) != OURS) _mm_setcsr(OURS);
    return caller;
}

void mr_leave(mr_environment caller) {
    if (((uint32_t)caller & ~FLAGS) != OURS) _mm_setcsr((uint32_t)caller);
}

#elif defined(__aarch64__)

/* FPCR: zero is round to nearest, no flush to zero, default not-a-number off, no traps. */
mr_environment mr_enter(void) {
    uint64_t caller;
    __asm__ volatile("mrs %0, fpcr" : "=r"(caller)::"memory");
    if (caller) __asm__ volatile("msr fpcr, %0" ::"r"((uint64_t)0) : "memory");
    return caller;
}

void mr_leave(mr_environment caller) {
    if (caller) __asm__ volatile("msr fpcr, %0" ::"r"(caller) : "memory");
}

#else

#include <fenv.h>

/* Standard C knows the rounding mode only; mr_self_test refuses where subnormals are flushed. */
mr_environment mr_enter(void) {
    const int caller = fegetround();
    if (caller != FE_TONEAREST) fesetround(FE_TONEAREST);
    return (mr_environment)(int64_t)caller;
}

void mr_leave(mr_environment caller) {
    if ((int)(int64_t)caller != FE_TONEAREST) fesetround((int)(int64_t)caller);
}

#endif
