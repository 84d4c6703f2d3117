#include "shape/oriented_box.h"

#include <algorithm>
#include <limits>

namespace fgenv {
namespace {

using Axes = std::array<Vec3, 3>;

// Second moments of the surface (S. Gottschalk et al., "OBBTree", 1996, section 4): faces weigh by
// area, so that how finely a part is tessellated does not turn the box.
void moments(const std::vector<Vec3>& corners, double (&m)[3][3]) {
    const Vec3 origin = corners[0];
    double area = 0, sum[3] = {}, square[3][3] = {};
    for (size_t i = 0; i < corners.size(); i += 3) {
        const Vec3 p = corners[i] - origin, q = corners[i + 1] - origin, r = corners[i + 2] - origin;
        const double w = norm(cross(q - p, r - p));
        const Vec3 c = (1.0 / 3) * (p + q + r);
        area += w;
        for (int a = 0; a < 3; ++a) {
            const double pa = coordinate(p, a), qa = coordinate(q, a), ra = coordinate(r, a);
            const double ca = coordinate(c, a);
            sum[a] += w * ca;
            for (int b = 0; b <= a; ++b)
                square[a][b] +=
                    w / 12 *
                    (9 * ca * coordinate(c, b) + pa * coordinate(p, b) + qa * coordinate(q, b) + ra * coordinate(r, b));
        }
    }
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b <= a; ++b) m[a][b] = m[b][a] = square[a][b] - sum[a] * sum[b] / area;
}

// Eigenvectors of a symmetric matrix by Jacobi rotations.
Axes eigenvectors(double (&m)[3][3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 12; ++sweep) {
        const double off = std::fabs(m[0][1]) + std::fabs(m[0][2]) + std::fabs(m[1][2]);
        if (off <= 1e-12 * (std::fabs(m[0][0]) + std::fabs(m[1][1]) + std::fabs(m[2][2]))) break;
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (m[p][q] == 0) continue;
                const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double kp = m[k][p], kq = m[k][q];
                    m[k][p] = c * kp - s * kq;
                    m[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < 3; ++k) {
                    const double pk = m[p][k], qk = m[q][k];
                    m[p][k] = c * pk - s * qk;
                    m[q][k] = s * pk + c * qk;
                }
                for (int k = 0; k < 3; ++k) {
                    const double kp = v[k][p], kq = v[k][q];
                    v[k][p] = c * kp - s * kq;
                    v[k][q] = s * kp + c * kq;
                }
            }
    }
    const Vec3 x = unit({v[0][0], v[1][0], v[2][0]});
    const Vec3 y = {v[0][1], v[1][1], v[2][1]};
    const Vec3 z = unit(cross(x, y));
    return {x, cross(z, x), z};
}

// Along the normal and the longest side of the widest face: what fits a machined part.
Axes widest_face(const std::vector<Vec3>& corners) {
    size_t widest = 0;
    double most = -1;
    for (size_t i = 0; i < corners.size(); i += 3) {
        const Vec3 n = cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]);
        if (dot(n, n) <= most) continue;
        most = dot(n, n);
        widest = i;
    }
    const Vec3* p = &corners[widest];
    Vec3 side = p[1] - p[0];
    for (const Vec3 other : {p[2] - p[1], p[0] - p[2]})
        if (dot(other, other) > dot(side, side)) side = other;
    const Vec3 z = unit(cross(p[1] - p[0], p[2] - p[0])), x = unit(side);
    return {x, cross(z, x), z};
}

bool orthonormal(const Axes& a) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
            if (!(std::fabs(dot(a[i], a[j]) - (i == j)) < 1e-9)) return false;
    return true;
}

struct Extent {
    double lo[3], hi[3];
};

Extent extent(const std::vector<Vec3>& corners, const Axes& axes) {
    const double inf = std::numeric_limits<double>::infinity();
    Extent e{{inf, inf, inf}, {-inf, -inf, -inf}};
    for (const Vec3& p : corners)
        for (int i = 0; i < 3; ++i) {
            const double x = dot(axes[i], p);
            e.lo[i] = lesser(e.lo[i], x);
            e.hi[i] = greater(e.hi[i], x);
        }
    return e;
}

double half_area(const Extent& e) {
    const double x = e.hi[0] - e.lo[0], y = e.hi[1] - e.lo[1], z = e.hi[2] - e.lo[2];
    return x * y + y * z + z * x;
}

}  // namespace

OrientedBox fit_box(const std::vector<Vec3>& corners, const Box& upright) {
    double m[3][3];
    moments(corners, m);
    Axes axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Extent e = {{upright.lo.x, upright.lo.y, upright.lo.z}, {upright.hi.x, upright.hi.y, upright.hi.z}};
    double least = 0.95 * half_area(e);  // a box that is turned must be worth it
    for (const Axes& turned : {eigenvectors(m), widest_face(corners)}) {
        const Extent other = extent(corners, turned);
        if (!(half_area(other) < least) || !orthonormal(turned)) continue;
        least = half_area(other);
        axes = turned;
        e = other;
    }
    OrientedBox box{};
    const Vec3 c =
        0.5 * (e.lo[0] + e.hi[0]) * axes[0] + 0.5 * (e.lo[1] + e.hi[1]) * axes[1] + 0.5 * (e.lo[2] + e.hi[2]) * axes[2];
    // Rounding moves the center by u |c| and turns the axes by u: both widen the box.
    const double reach = std::fabs(c.x) + std::fabs(c.y) + std::fabs(c.z) + (e.hi[0] - e.lo[0]) + (e.hi[1] - e.lo[1]) +
                         (e.hi[2] - e.lo[2]);
    for (int i = 0; i < 3; ++i) {
        box.center[i] = static_cast<float>(coordinate(c, i));
        box.half[i] = static_cast<float>(0.5 * (e.hi[i] - e.lo[i]) + 4 * 0x1p-24 * reach);
        for (int k = 0; k < 3; ++k) box.axis[i][k] = static_cast<float>(coordinate(axes[i], k));
    }
    return box;
}

}  // namespace fgenv
