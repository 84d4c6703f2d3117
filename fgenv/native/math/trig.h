// Sine, cosine and arc tangent from additions, products, quotients and roots alone: the C library's
// differ in the last bit from machine to machine, and results here must not.
#pragma once

#include <cmath>

#include "math/constants.h"

namespace fgenv {

// Taylor's polynomials on [-pi/4, pi/4] (the first term left out is under 1e-19) after a reduction by
// multiples of pi/2 in three parts (W. Cody, W. Waite, "Software Manual for the Elementary Functions",
// 1980). For |x| up to 1e5; error under 2e-16.
static inline void sin_cos(double x, double& sine, double& cosine) {
    const double quarter = std::floor(x * 0.63661977236758134308 + 0.5);
    const double r = ((x - quarter * 0x1.921fb544p0) - quarter * 0x1.0b4611a6p-34) - quarter * 0x1.3198a2e037073p-69;
    const double z = r * r;
    double s = 1.0 / 121645100408832000.0;  // 19!
    s = 1.0 / 355687428096000.0 - z * s;
    s = 1.0 / 1307674368000.0 - z * s;
    s = 1.0 / 6227020800.0 - z * s;
    s = 1.0 / 39916800.0 - z * s;
    s = 1.0 / 362880.0 - z * s;
    s = 1.0 / 5040.0 - z * s;
    s = 1.0 / 120.0 - z * s;
    s = 1.0 / 6.0 - z * s;
    s = r - r * z * s;
    double c = 1.0 / 6402373705728000.0;  // 18!
    c = 1.0 / 20922789888000.0 - z * c;
    c = 1.0 / 87178291200.0 - z * c;
    c = 1.0 / 479001600.0 - z * c;
    c = 1.0 / 3628800.0 - z * c;
    c = 1.0 / 40320.0 - z * c;
    c = 1.0 / 720.0 - z * c;
    c = 1.0 / 24.0 - z * c;
    c = 1.0 - z * (0.5 - z * c);
    switch (static_cast<long long>(quarter) & 3) {
        case 0: sine = s, cosine = c; break;
        case 1: sine = c, cosine = -s; break;
        case 2: sine = -s, cosine = -c; break;
        default: sine = -c, cosine = s;
    }
}

// Halved twice by atan x = 2 atan(x / (1 + sqrt(1 + x^2))), then Gregory's series; for 0 <= x <= 1.
static inline double arc_tangent_unit(double x) {
    x = x / (1 + std::sqrt(1 + x * x));
    x = x / (1 + std::sqrt(1 + x * x));
    const double z = x * x;  // at most 0.0396
    double sum = 1.0 / 23;
    for (int k = 21; k >= 1; k -= 2) sum = 1.0 / k - z * sum;
    return 4 * x * sum;
}

// Angle of the point (x, y) in (-pi, pi]; error under 1e-15.
static inline double arc_tangent(double y, double x) {
    const double ax = std::fabs(x), ay = std::fabs(y);
    if (ax == 0 && ay == 0) return 0;
    double angle = ay <= ax ? arc_tangent_unit(ay / ax) : 0.5 * pi - arc_tangent_unit(ax / ay);
    if (x < 0) angle = pi - angle;
    return y < 0 ? -angle : angle;
}

}  // namespace fgenv
