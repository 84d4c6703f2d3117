// Points, triangles, rigid motions and boxes: plain data and free functions, double precision.
// Everything here is `static inline`: kernels are compiled once per instruction set, and a shared
// inline symbol could carry one set's code into another.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace fgenv {

// Not fmin and fmax: those are calls into the C library for the sake of NaN, and slow.
static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double greater(double a, double b) { return a > b ? a : b; }

struct Vec3 {
    double x, y, z;
};

static inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
static inline bool operator==(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
static inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }
static inline Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline Vec3 unit(Vec3 a) {
    const double length = norm(a);
    return length > 0 ? (1.0 / length) * a : Vec3{0, 0, 0};
}
static inline double coordinate(const Vec3& a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

// Vertex indices of one face, counter-clockwise seen from outside.
using Face = std::array<int32_t, 3>;

using Triangle = std::array<Vec3, 3>;

// x -> r x + t.
struct Rigid {
    double r[3][3];
    double t[3];
};

static inline Vec3 apply(const Rigid& m, Vec3 p) {
    return {m.r[0][0] * p.x + m.r[0][1] * p.y + m.r[0][2] * p.z + m.t[0],
            m.r[1][0] * p.x + m.r[1][1] * p.y + m.r[1][2] * p.z + m.t[1],
            m.r[2][0] * p.x + m.r[2][1] * p.y + m.r[2][2] * p.z + m.t[2]};
}
static inline Vec3 rotate(const Rigid& m, Vec3 v) {
    return {m.r[0][0] * v.x + m.r[0][1] * v.y + m.r[0][2] * v.z, m.r[1][0] * v.x + m.r[1][1] * v.y + m.r[1][2] * v.z,
            m.r[2][0] * v.x + m.r[2][1] * v.y + m.r[2][2] * v.z};
}

// The true inverse by cofactors, not the transpose: a pose that is orthonormal only to 1e-6 (float32,
// printed digits) then still gives the verdict of the vertices as it places them in the world.
static inline void invert3(const double (&m)[3][3], double (&out)[3][3]) {
    const double c00 = m[1][1] * m[2][2] - m[1][2] * m[2][1];
    const double c10 = m[1][2] * m[2][0] - m[1][0] * m[2][2];
    const double c20 = m[1][0] * m[2][1] - m[1][1] * m[2][0];
    const double s = 1.0 / (m[0][0] * c00 + m[0][1] * c10 + m[0][2] * c20);
    out[0][0] = s * c00;
    out[1][0] = s * c10;
    out[2][0] = s * c20;
    out[0][1] = s * (m[0][2] * m[2][1] - m[0][1] * m[2][2]);
    out[1][1] = s * (m[0][0] * m[2][2] - m[0][2] * m[2][0]);
    out[2][1] = s * (m[0][1] * m[2][0] - m[0][0] * m[2][1]);
    out[0][2] = s * (m[0][1] * m[1][2] - m[0][2] * m[1][1]);
    out[1][2] = s * (m[0][2] * m[1][0] - m[0][0] * m[1][2]);
    out[2][2] = s * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
}

static inline Rigid inverse(const Rigid& m) {
    Rigid out;
    invert3(m.r, out.r);
    const Vec3 t = rotate(out, {m.t[0], m.t[1], m.t[2]});
    out.t[0] = -t.x;
    out.t[1] = -t.y;
    out.t[2] = -t.z;
    return out;
}

// Frame of b seen from the frame of a. The origins are subtracted first: 1e6 m from the world's
// origin the difference is still exact, while a product of the two poses would have lost it. And equal
// rotations cancel exactly, so that what touches in one frame touches in every frame.
static inline Rigid relative(const Rigid& a, const Rigid& b) {
    double inv[3][3];
    invert3(a.r, inv);
    const double d[3] = {b.t[0] - a.t[0], b.t[1] - a.t[1], b.t[2] - a.t[2]};
    Rigid out;
    bool turned = false;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[i][j] = inv[i][0] * b.r[0][j] + inv[i][1] * b.r[1][j] + inv[i][2] * b.r[2][j];
            turned |= a.r[i][j] != b.r[i][j];
        }
        out.t[i] = inv[i][0] * d[0] + inv[i][1] * d[1] + inv[i][2] * d[2];
    }
    if (!turned)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) out.r[i][j] = i == j;
    return out;
}

struct Box {
    Vec3 lo, hi;
};

static inline Box empty_box() {
    const double inf = HUGE_VAL;
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
}
static inline void grow(Box& box, Vec3 p) {
    box.lo = {lesser(box.lo.x, p.x), lesser(box.lo.y, p.y), lesser(box.lo.z, p.z)};
    box.hi = {greater(box.hi.x, p.x), greater(box.hi.y, p.y), greater(box.hi.z, p.z)};
}
static inline void grow(Box& box, const Box& other) {
    grow(box, other.lo);
    grow(box, other.hi);
}
static inline bool inside(const Box& box, Vec3 p) {
    return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y && p.z >= box.lo.z &&
           p.z <= box.hi.z;
}
static inline double half_area(const Box& box) {
    const Vec3 d = box.hi - box.lo;
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

}  // namespace fgenv
