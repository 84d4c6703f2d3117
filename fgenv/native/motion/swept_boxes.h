// Tests oriented boxes of two moving shapes, one box against eight: separating axes in floats with slack, for
// all times between half a stretch before the middle and half a stretch after it. No fused operations: the
// result must not depend on the instruction set, since the brackets of contacts depend on it.
#pragma once

#include "query/box_culling.h"
#include "query/kernels.h"

namespace fgenv {

// Relative error of a displacement (velocity times half the time) in floats.
constexpr float float_share = 1e-5f;

struct SideMotion {
    float v[3], w[3], origin[3];
    float turn, at_origin, by_radius;
};

FGENV_INLINE SideMotion side_motion(const Sweep::Side& s, Vec3 v, Vec3 w, Vec3 origin) {
    const double turn = norm(w);
    return {{float(v.x), float(v.y), float(v.z)},
            {float(w.x), float(w.y), float(w.z)},
            {float(origin.x), float(origin.y), float(origin.z)},
            static_cast<float>(turn) * 1.0001f,
            static_cast<float>(s.at_origin) * 1.0001f,
            static_cast<float>(s.by_radius) * 1.0001f};
}

// The motion of both shapes, in the frame of one of them.
struct SweptView {
    const PairFrame& frame;  // places the other shape
    SideMotion own, other;
    float pad;  // margin and slack
};

struct Drift {
    float u[3];  // displacement of the box's center in half the time
    float e;     // bound on the deviation of any point of the box from u
};

// Upper bound on the length of a vector, at most 1.16 times the length.
FGENV_INLINE float length_bound(float x, float y, float z) {
    const float a = std::fabs(x), b = std::fabs(y), c = std::fabs(z);
    const float most = a > b ? (a > c ? a : c) : (b > c ? b : c);
    return 0.5f * (a + b + c + most);
}

FGENV_INLINE Drift drift(const SideMotion& s, float cx, float cy, float cz, float radius) {
    const float x = cx - s.origin[0], y = cy - s.origin[1], z = cz - s.origin[2];
    Drift out;
    out.u[0] = s.v[0] + (s.w[1] * z - s.w[2] * y);
    out.u[1] = s.v[1] + (s.w[2] * x - s.w[0] * z);
    out.u[2] = s.v[2] + (s.w[0] * y - s.w[1] * x);
    const float far = length_bound(x, y, z) + radius;
    out.e = s.turn * radius + s.at_origin + s.by_radius * far +
            float_share * (length_bound(s.v[0], s.v[1], s.v[2]) + s.turn * far);
    return out;
}

FGENV_INLINE F8 length_bound(F8 x, F8 y, F8 z) {
    x = abs(x);
    y = abs(y);
    z = abs(z);
    return splat(0.5f) * (x + y + z + max(max(x, y), z));
}

// The component of d perpendicular to u, not normalized. Only a candidate direction: rounding is harmless.
FGENV_INLINE void across(const F8 (&d)[3], const F8 (&u)[3], F8 (&w)[3]) {
    const F8 uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], du = d[0] * u[0] + d[1] * u[1] + d[2] * u[2];
    const F8 share = uu > splat(1e-30f) ? du / uu : F8{};
    for (int i = 0; i < 3; ++i) w[i] = d[i] - share * u[i];
}

// Eight boxes of a node relative to a box of the other shape: offsets, extents and displacements.
struct SweptBoxes {
    F8 d[3], u[3];  // center and displacement in half the time, relative to the other's
    F8 h[3], axis[3][3];
    F8 e;                     // bound on the deviation of points of both
    F8 r[3][3], abs_r[3][3];  // dot products of own axes and the other's axes
};

FGENV_INLINE void load_swept_boxes(const Oriented& n, const PosedBox& box, const SweptView& view, SweptBoxes& s) {
    const SideMotion& own = view.own;
    const Drift theirs = drift(view.other, box.c[0], box.c[1], box.c[2], length_bound(box.h[0], box.h[1], box.h[2]));
    F8 c[3];
    for (int k = 0; k < 3; ++k) {
        c[k] = load(n.center[k]);
        s.d[k] = c[k] - splat(box.c[k]);
        s.h[k] = load(n.half[k]);
        c[k] = c[k] - splat(own.origin[k]);
    }
    load_axes(n, s.axis);
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        s.u[k] = splat(own.v[k] - theirs.u[k]) + (splat(own.w[l]) * c[m] - splat(own.w[m]) * c[l]);
    }
    const F8 radius = length_bound(s.h[0], s.h[1], s.h[2]);
    const F8 far = length_bound(c[0], c[1], c[2]) + radius;
    s.e = splat(theirs.e + view.pad + own.at_origin + float_share * length_bound(own.v[0], own.v[1], own.v[2])) +
          splat(own.turn) * radius + splat(own.by_radius + float_share * own.turn) * far;
}

FGENV_INLINE F8 dot(const F8 (&a)[3], F8 x, F8 y, F8 z) { return a[0] * x + a[1] * y + a[2] * z; }

// Tests the axes of the other box; stores `r` for the other tests.
FGENV_INLINE I8 overlap_on_axes_of_box(SweptBoxes& s, const PosedBox& box) {
    I8 overlap = s.h[0] >= splat(0.0f);
    for (int j = 0; j < 3; ++j) {
        const F8 x = splat(box.axis[j][0]), y = splat(box.axis[j][1]), z = splat(box.axis[j][2]);
        F8 reach = splat(box.h[j]) + s.e;
        for (int i = 0; i < 3; ++i) {
            s.r[i][j] = x * s.axis[i][0] + y * s.axis[i][1] + z * s.axis[i][2];
            s.abs_r[i][j] = abs(s.r[i][j]);
            reach += s.h[i] * s.abs_r[i][j];
        }
        overlap &= abs(dot(s.d, x, y, z)) <= reach + abs(dot(s.u, x, y, z));
    }
    return overlap;
}

// Boxes that pass by are separated perpendicular to their motion: along the centers' offset without its part along u.
FGENV_INLINE I8 overlap_across_motion(const SweptBoxes& s, const PosedBox& box) {
    F8 w[3];
    across(s.d, s.u, w);
    F8 reach = length_bound(w[0], w[1], w[2]) * s.e;
    for (int i = 0; i < 3; ++i) reach += s.h[i] * abs(dot(w, s.axis[i][0], s.axis[i][1], s.axis[i][2]));
    for (int j = 0; j < 3; ++j)
        reach += splat(box.h[j]) * abs(dot(w, splat(box.axis[j][0]), splat(box.axis[j][1]), splat(box.axis[j][2])));
    return abs(dot(s.d, w[0], w[1], w[2])) <= reach + abs(dot(s.u, w[0], w[1], w[2]));
}

// Tests the boxes' own axes; `along_d` and `along_u` are d and u in those axes.
FGENV_INLINE I8 overlap_on_own_axes(const SweptBoxes& s, const PosedBox& box, F8 (&along_d)[3], F8 (&along_u)[3]) {
    I8 overlap = I8{} == 0;
    for (int i = 0; i < 3; ++i) {
        along_d[i] = dot(s.d, s.axis[i][0], s.axis[i][1], s.axis[i][2]);
        along_u[i] = dot(s.u, s.axis[i][0], s.axis[i][1], s.axis[i][2]);
        F8 reach = s.h[i] + s.e;
        for (int j = 0; j < 3; ++j) reach += s.abs_r[i][j] * splat(box.h[j]);
        overlap &= abs(along_d[i]) <= reach + abs(along_u[i]);
    }
    return overlap;
}

FGENV_INLINE I8 overlap_on_products(const SweptBoxes& s, const PosedBox& box, const F8 (&along_d)[3],
                                    const F8 (&along_u)[3]) {
    I8 overlap = I8{} == 0;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const F8 along = along_d[i2] * s.r[i1][j] - along_d[i1] * s.r[i2][j];
            const F8 moved = along_u[i2] * s.r[i1][j] - along_u[i1] * s.r[i2][j];
            const F8 reach = s.h[i1] * s.abs_r[i2][j] + s.h[i2] * s.abs_r[i1][j] + splat(box.h[j1]) * s.abs_r[i][j2] +
                             splat(box.h[j2]) * s.abs_r[i][j1] + s.e;
            overlap &= abs(along) <= reach + abs(moved);
        }
    }
    return overlap;
}

// Selects the boxes of a node that may touch `box` within half the time before or after the middle: along a
// separating axis at the middle the gap must exceed the motion of both. As `overlapping` for boxes at rest.
FGENV_INLINE uint32_t overlapping(const Oriented& n, const PosedBox& box, const SweptView& view) {
    SweptBoxes s;
    load_swept_boxes(n, box, view, s);
    I8 overlap = overlap_on_axes_of_box(s, box);
    if (!bits(overlap)) return 0;
    overlap &= overlap_across_motion(s, box);
    if (!bits(overlap)) return 0;
    F8 along_d[3], along_u[3];
    overlap &= overlap_on_own_axes(s, box, along_d, along_u);
    if (!bits(overlap)) return 0;
    return bits(overlap & overlap_on_products(s, box, along_d, along_u));
}

}  // namespace fgenv
