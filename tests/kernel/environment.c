/* The floating-point environment that a careless library leaves behind, for test_environment.py. */
#define _GNU_SOURCE
#include <fenv.h>
#include <stdint.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#define FLUSH 0x8040u /* flush-to-zero and denormals-are-zero */
#define STICKY 0x3fu  /* which exceptions happened: no part of the environment's control */
static uint64_t get(void) { return _mm_getcsr(); }
static void set(uint64_t bits) { _mm_setcsr((uint32_t)bits); }
#elif defined(__aarch64__)
#define FLUSH (UINT64_C(1) << 24)
#define STICKY 0u
static uint64_t get(void) {
    uint64_t bits;
    __asm__ volatile("mrs %0, fpcr" : "=r"(bits));
    return bits;
}
static void set(uint64_t bits) { __asm__ volatile("msr fpcr, %0" : : "r"(bits)); }
#endif

/* The bits that control arithmetic. */
uint64_t environment(void) { return get() & ~(uint64_t)STICKY; }

void be_upward(void) { fesetround(FE_UPWARD); }
void be_downward(void) { fesetround(FE_DOWNWARD); }
void be_towards_zero(void) { fesetround(FE_TOWARDZERO); }
void be_flushing(void) { set(get() | FLUSH); }
void be_flushing_upward(void) { be_upward(), be_flushing(); }
void be_trapping(void) { feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW); }

void be_normal(void) {
    fedisableexcept(FE_ALL_EXCEPT);
    fesetround(FE_TONEAREST);
    set(get() & ~(uint64_t)FLUSH);
}
