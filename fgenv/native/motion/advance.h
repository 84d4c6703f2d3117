// Shared parts of conservative advancement, by separating planes and by pairs of faces.
#pragma once

#include "motion/certify.h"

namespace fgenv {

constexpr double corner_rounding = 4e-15;  // relative to the coordinates: bound on the error of placing a corner twice

struct Instant {
    double t;
    Rigid a, b;
    Velocity va, vb;
};

static inline Instant instant(const Moving& a, const Moving& b, double t) {
    Instant out;
    out.t = t;
    out.a = a.motion->pose(t, out.va);
    out.b = b.motion->pose(t, out.vb);
    return out;
}

static inline double rounding_slack(const Instant& now, double radii) {
    return corner_rounding * (norm(origin(now.a) - origin(now.b)) + radii) +
           0x1p-51 * (norm(origin(now.a)) + norm(origin(now.b)));
}

// The longest t with approach t + acceleration t^2 / 2 <= gap.
static inline double time_to(double gap, double approach, double acceleration) {
    const double root = std::sqrt(greater(approach * approach + 2 * acceleration * gap, 0));
    if (approach + root > 0 && approach >= 0) return 2 * gap / (approach + root) * (1 - 1e-12);
    return acceleration > 0 ? (root - approach) / acceleration * (1 - 1e-12) : HUGE_VAL;
}

}  // namespace fgenv
