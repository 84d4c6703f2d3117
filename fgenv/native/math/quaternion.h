// Orientations as unit quaternions (x, y, z, w), and the shortest arc between two.
#pragma once

#include "math/rotation.h"

namespace fgenv {

struct Quaternion {
    double x, y, z, w;
};

static inline Quaternion normalized(Quaternion q) {
    const double s = 1 / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {s * q.x, s * q.y, s * q.z, s * q.w};
}

// A rotation for a quaternion of any length but 0.
static inline void to_matrix(Quaternion q, double (&r)[3][3]) {
    const double s = 2 / (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const double xx = s * q.x * q.x, yy = s * q.y * q.y, zz = s * q.z * q.z;
    const double xy = s * q.x * q.y, yz = s * q.y * q.z, zx = s * q.z * q.x;
    const double xw = s * q.x * q.w, yw = s * q.y * q.w, zw = s * q.z * q.w;
    r[0][0] = 1 - yy - zz, r[0][1] = xy - zw, r[0][2] = zx + yw;
    r[1][0] = xy + zw, r[1][1] = 1 - zz - xx, r[1][2] = yz - xw;
    r[2][0] = zx - yw, r[2][1] = yz + xw, r[2][2] = 1 - xx - yy;
}

// Quaternion of a rotation, with w >= 0.
static inline Quaternion quaternion_of(const Rigid& m) {
    double w;
    Vec3 v;
    quaternion_parts(m.r, w, v);
    return normalized(w < 0 ? Quaternion{-v.x, -v.y, -v.z, -w} : Quaternion{v.x, v.y, v.z, w});
}

// Rotation b seen from a, with w >= 0.
static inline Quaternion relative(Quaternion a, Quaternion b) {
    const Vec3 u{a.x, a.y, a.z}, v{b.x, b.y, b.z};
    const Vec3 t = a.w * v - b.w * u - cross(u, v);
    const double w = a.w * b.w + dot(u, v);
    return w < 0 ? Quaternion{-t.x, -t.y, -t.z, -w} : Quaternion{t.x, t.y, t.z, w};
}

// From one orientation to another at constant angular velocity (K. Shoemake, "Animating rotation with
// quaternion curves", 1985). At a half turn either way is as short; the signs as given decide.
class Slerp {
public:
    Slerp(Quaternion from, Quaternion to) : from_(normalized(from)), to_(normalized(to)) {
        if (from_.x * to_.x + from_.y * to_.y + from_.z * to_.z + from_.w * to_.w < 0)
            to_ = {-to_.x, -to_.y, -to_.z, -to_.w};
        const auto length = [&](double s) {
            const double x = to_.x + s * from_.x, y = to_.y + s * from_.y, z = to_.z + s * from_.z,
                         w = to_.w + s * from_.w;
            return std::sqrt(x * x + y * y + z * z + w * w);
        };
        half_ = 2 * arc_tangent(length(-1), length(1));
        double cosine;
        sin_cos(half_, sine_, cosine);
    }

    Quaternion at(double t) const {
        if (half_ == 0) return from_;
        double a = 1 - t, b = t;
        if (half_ > straight) {
            double s, c;
            sin_cos((1 - t) * half_, s, c);
            a = s / sine_;
            sin_cos(t * half_, s, c);
            b = s / sine_;
        }
        return {a * from_.x + b * to_.x, a * from_.y + b * to_.y, a * from_.z + b * to_.z, a * from_.w + b * to_.w};
    }

    // The whole turn as a rotation vector in the frame that both are given in, radians.
    Vec3 turn() const {
        const Vec3 u{from_.x, from_.y, from_.z}, v{to_.x, to_.y, to_.z};
        return (2 * half_) * unit(from_.w * v - to_.w * u + cross(u, v));
    }

private:
    static constexpr double straight = 1e-6;  // the chord of a shorter arc is the arc, to 1e-13
    Quaternion from_, to_;
    double half_, sine_;
};

}  // namespace fgenv
