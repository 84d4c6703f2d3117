// Light as numbers and as the bytes of a picture, without the C library's powers: those differ in the
// last bit from machine to machine, and pictures must not.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fgenv {

// Newton's method from a fifth of the exponent; error under 1e-15 of the root.
static inline double fifth_root(double x) {
    if (!(x > 1e-300)) return 0;
    double y = std::bit_cast<double>(std::bit_cast<uint64_t>(x) / 5 + (uint64_t{1023} << 52) / 5 * 4);
    for (int i = 0; i < 5; ++i) {
        const double square = y * y;
        y = 0.2 * (4 * y + x / (square * square));
    }
    return y;
}

// e^-x for x from 0 to 20: Taylor's series for a 1024th of it, squared ten times; error under 1e-11.
static inline double decay(double x) {
    const double z = x * (1.0 / 1024);
    double e = 1 - z * (1.0 / 6);
    e = 1 - z * (1.0 / 5) * e;
    e = 1 - z * (1.0 / 4) * e;
    e = 1 - z * (1.0 / 3) * e;
    e = 1 - z * (1.0 / 2) * e;
    e = 1 - z * e;
    for (int i = 0; i < 10; ++i) e *= e;
    return e;
}

// An sRGB value from 0 to 1 as linear light.
static inline double linear_light(double srgb) {
    if (srgb <= 0.04045) return srgb / 12.92;
    const double x = (srgb + 0.055) / 1.055;
    return x * x * fifth_root(x * x);  // x^2.4
}

// Linear light from 0 to 1 as the nearest sRGB byte. sRGB rises by at most 0.81 bytes in 1/4096 of
// light, so a step of the table holds one change of byte at most.
class SrgbTable {
public:
    SrgbTable() {
        for (int k = 0; k <= 255; ++k) least_[k] = k ? linear_light((k - 0.5) / 255) : 0;
        least_[256] = HUGE_VAL;
        for (int i = 0, k = 0; i <= steps; ++i) {
            while (least_[k + 1] <= static_cast<double>(i) / steps) ++k;
            first_[i] = static_cast<uint8_t>(k);
        }
    }
    uint8_t byte(double light) const {
        const double c = light > 0 ? light < 1 ? light : 1 : 0;
        const int k = first_[static_cast<int>(c * steps)];
        return static_cast<uint8_t>(k + (c >= least_[k + 1]));
    }

private:
    static constexpr int steps = 4096;
    double least_[257];  // light of each byte
    uint8_t first_[steps + 1];
};

}  // namespace fgenv
