// Eight floats or four doubles side by side, in the vector extensions of GCC and Clang: one source for
// every instruction set, the same operations in the same order in each.
#pragma once

#include <cstdint>
#include <cstring>
#if defined(__SSE__)
#include <immintrin.h>
#endif

namespace fgenv {

#define FGENV_INLINE static inline __attribute__((always_inline))

typedef float F8 __attribute__((vector_size(32)));
typedef float F4 __attribute__((vector_size(16)));
typedef int32_t I8 __attribute__((vector_size(32)));
typedef double D4 __attribute__((vector_size(32)));
typedef int64_t L4 __attribute__((vector_size(32)));

FGENV_INLINE F8 splat(float x) { return F8{x, x, x, x, x, x, x, x}; }
FGENV_INLINE D4 splat(double x) { return D4{x, x, x, x}; }

FGENV_INLINE F8 load(const float* p) {
    F8 x;
    std::memcpy(&x, p, sizeof x);
    return x;
}

FGENV_INLINE F8 abs(F8 x) { return (F8)((I8)x & 0x7fffffff); }
FGENV_INLINE D4 abs(D4 x) { return (D4)((L4)x & 0x7fffffffffffffffll); }
FGENV_INLINE F8 min(F8 a, F8 b) { return a < b ? a : b; }
FGENV_INLINE F8 max(F8 a, F8 b) { return a > b ? a : b; }
FGENV_INLINE D4 min(D4 a, D4 b) { return a < b ? a : b; }
FGENV_INLINE D4 max(D4 a, D4 b) { return a > b ? a : b; }

// a b + c, fused where the instruction set can: other bits on other machines, so for culling with slack
// only, never for a result or an order.
FGENV_INLINE F8 fused(F8 a, F8 b, F8 c) {
#if defined(__FMA__)
    return (F8)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
#else
    return a * b + c;
#endif
}

// Bit k: lane k is true.
FGENV_INLINE uint32_t bits(I8 m) {
#if defined(__AVX__)
    return static_cast<uint32_t>(_mm256_movemask_ps((__m256)m));
#elif defined(__SSE__)
    __m128 half[2];
    std::memcpy(half, &m, sizeof half);
    return static_cast<uint32_t>(_mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4);
#else
    uint32_t out = 0;
    for (int i = 0; i < 8; ++i) out |= static_cast<uint32_t>(m[i] & 1) << i;
    return out;
#endif
}

}  // namespace fgenv
