// Rotations as quaternions and rotation vectors (axis times angle, radians).
#pragma once

#include "math/geometry.h"
#include "math/trig.h"

namespace fgenv {

static inline Rigid identity() { return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}}; }

// outer * inner: first inner, then outer.
static inline Rigid compose(const Rigid& outer, const Rigid& inner) {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = outer.r[i][0] * inner.r[0][j] + outer.r[i][1] * inner.r[1][j] + outer.r[i][2] * inner.r[2][j];
        out.t[i] = outer.r[i][0] * inner.t[0] + outer.r[i][1] * inner.t[1] + outer.r[i][2] * inner.t[2] + outer.t[i];
    }
    return out;
}

static inline Vec3 origin(const Rigid& m) { return {m.t[0], m.t[1], m.t[2]}; }

// m's rotation, transposed, times v: the inverse rotation if m is orthonormal.
static inline Vec3 unrotate(const Rigid& m, Vec3 v) {
    return {m.r[0][0] * v.x + m.r[1][0] * v.y + m.r[2][0] * v.z, m.r[0][1] * v.x + m.r[1][1] * v.y + m.r[2][1] * v.z,
            m.r[0][2] * v.x + m.r[1][2] * v.y + m.r[2][2] * v.z};
}

// Quaternion of a rotation times a positive factor, from its largest component (S. Shepperd, "Quaternion
// from rotation matrix", 1978).
static inline void quaternion_parts(const double (&m)[3][3], double& w, Vec3& v) {
    const double trace = m[0][0] + m[1][1] + m[2][2];
    if (trace >= m[0][0] && trace >= m[1][1] && trace >= m[2][2]) {
        w = 1 + trace;
        v = {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
    } else if (m[0][0] >= m[1][1] && m[0][0] >= m[2][2]) {
        w = m[2][1] - m[1][2];
        v = {1 + m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0]};
    } else if (m[1][1] >= m[2][2]) {
        w = m[0][2] - m[2][0];
        v = {m[0][1] + m[1][0], 1 + m[1][1] - m[2][2] - m[0][0], m[1][2] + m[2][1]};
    } else {
        w = m[1][0] - m[0][1];
        v = {m[0][2] + m[2][0], m[1][2] + m[2][1], 1 + m[2][2] - m[0][0] - m[1][1]};
    }
}

// Rotation vector of the shortest arc from the rotation of a to that of b, in the frame that both are
// given in; at a half turn either way is as short, and the one that rounding finds is taken.
static inline Vec3 turn_between(const Rigid& a, const Rigid& b) {
    double m[3][3];  // b a^T
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = b.r[i][0] * a.r[j][0] + b.r[i][1] * a.r[j][1] + b.r[i][2] * a.r[j][2];
    double w;
    Vec3 v;
    quaternion_parts(m, w, v);
    const double sine = norm(v);
    if (sine == 0) return {0, 0, 0};
    const double angle = 2 * arc_tangent(sine, std::fabs(w));
    return ((w < 0 ? -angle : angle) / sine) * v;
}

// The rotation of m turned by a rotation vector in the frame that m is given in; m's translation stays.
static inline Rigid turned(const Rigid& m, Vec3 turn) {
    const double angle = norm(turn);
    if (angle == 0) return m;
    double s, c;
    sin_cos(angle, s, c);
    const Vec3 k = (1 / angle) * turn;
    Rigid out = m;
    for (int j = 0; j < 3; ++j) {  // Rodrigues
        const Vec3 column{m.r[0][j], m.r[1][j], m.r[2][j]};
        const Vec3 x = c * column + s * cross(k, column) + ((1 - c) * dot(k, column)) * k;
        out.r[0][j] = x.x;
        out.r[1][j] = x.y;
        out.r[2][j] = x.z;
    }
    return out;
}

}  // namespace fgenv
