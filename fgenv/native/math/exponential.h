// Exponential and hyperbolic tangent from additions, products, quotients and bits alone, as sines are in
// trig.h: the same bits on every machine. No branches, so that the compiler may do several at once.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fgenv {

// exp(x) - 1 for 0 <= x <= 40. With x = k ln 2 + r, |r| <= ln 2 / 2, it is 2^k (exp(r) - 1) + (2^k - 1);
// Taylor's polynomial of exp(r) - 1 (the first term left out is under 1e-17 of it). Error under 1e-15 of it.
static inline double exponential_minus_one(double x) {
    constexpr double shift = 0x1.8p52;  // adding and taking it away rounds to a whole number
    const double shifted = x * 1.4426950408889634074 + shift, k = shifted - shift;
    const double r = (x - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33;
    double e = 1.0 / 87178291200.0;  // 14!
    e = 1.0 / 6227020800.0 + r * e;
    e = 1.0 / 479001600.0 + r * e;
    e = 1.0 / 39916800.0 + r * e;
    e = 1.0 / 3628800.0 + r * e;
    e = 1.0 / 362880.0 + r * e;
    e = 1.0 / 40320.0 + r * e;
    e = 1.0 / 5040.0 + r * e;
    e = 1.0 / 720.0 + r * e;
    e = 1.0 / 120.0 + r * e;
    e = 1.0 / 24.0 + r * e;
    e = 1.0 / 6.0 + r * e;
    e = 0.5 + r * e;
    e = r + r * r * e;
    const double power = std::bit_cast<double>((std::bit_cast<uint64_t>(shifted) + 1023) << 52);
    return power * e + (power - 1);
}

// 1 from 20 on, where it is 1 to the last bit.
static inline double hyperbolic_tangent(double x) {
    const double size = std::fabs(x), twice = 2 * (size < 20 ? size : 20);
    const double e = exponential_minus_one(twice);
    return std::copysign(e / (e + 2), x);
}

}  // namespace fgenv
