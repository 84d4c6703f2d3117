// Orientation predicates: the sign is always that of the exact determinant of the doubles given.
// A forward error bound decides nearly every call in plain double arithmetic; the rest goes to
// expansion arithmetic (J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
// geometric predicates", 1997; the bounds are those of his sections 4.2 and 4.3).
#pragma once

#include "math/geometry.h"

namespace fgenv {

// Exact signs, no filter.
int orient2d_exact(const double a[2], const double b[2], const double c[2]);
int orient3d_exact(Vec3 a, Vec3 b, Vec3 c, Vec3 d);
// On which side of the line from o along `direction` the segment ab passes: the sign of det(direction, a - o, b - o).
int orient_line_exact(Vec3 direction, Vec3 a, Vec3 b, Vec3 o);

// > 0 if a, b, c turn counter-clockwise.
static inline int orient2d(const double a[2], const double b[2], const double c[2]) {
    const double left = (a[0] - c[0]) * (b[1] - c[1]);
    const double right = (a[1] - c[1]) * (b[0] - c[0]);
    const double det = left - right;
    const double bound = 3.3306690738754716e-16 * (std::fabs(left) + std::fabs(right));
    if (det > bound) return 1;
    if (det < -bound) return -1;
    return orient2d_exact(a, b, c);
}

constexpr double orient3d_bound = 7.771561172376103e-16;  // of the permanent

// > 0 if d lies below the plane of a, b, c, where above is the side from which they turn
// counter-clockwise: the sign of det(a - d, b - d, c - d).
static inline int orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Vec3 ad = a - d, bd = b - d, cd = c - d;
    const double bc = bd.x * cd.y, cb = cd.x * bd.y;
    const double ca = cd.x * ad.y, ac = ad.x * cd.y;
    const double ab = ad.x * bd.y, ba = bd.x * ad.y;
    const double det = ad.z * (bc - cb) + bd.z * (ca - ac) + cd.z * (ab - ba);
    const double permanent = (std::fabs(bc) + std::fabs(cb)) * std::fabs(ad.z) +
                             (std::fabs(ca) + std::fabs(ac)) * std::fabs(bd.z) +
                             (std::fabs(ab) + std::fabs(ba)) * std::fabs(cd.z);
    const double bound = orient3d_bound * permanent;
    if (det > bound) return 1;
    if (det < -bound) return -1;
    return orient3d_exact(a, b, c, d);
}

// Exactly collinear: zero area in each of the three axis projections.
bool collinear(Vec3 a, Vec3 b, Vec3 c);

}  // namespace fgenv
