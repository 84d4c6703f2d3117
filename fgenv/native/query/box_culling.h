// One oriented box against a node's eight: separating axes, in floats with slack.
#pragma once

#include "query/pair_frame.h"

namespace fgenv {

// Half the sum of a box's sides. The larger of two boxes is opened first.
template <class Bounded>
FGENV_INLINE float size(const Bounded& x) {
    return x.half[0] + x.half[1] + x.half[2];
}

// A box in the frame of the other shape; the fourth lanes are unused.
struct PosedBox {
    F4 c, axis[3];
    float h[3];
};

FGENV_INLINE F4 turned(const F4 (&columns)[3], const float v[3], F4 to) {
    return columns[0] * v[0] + (columns[1] * v[1] + (columns[2] * v[2] + to));
}

FGENV_INLINE PosedBox posed(const OrientedBox& box, const PairFrame& f) {
    PosedBox out;
    out.c = turned(f.columns, box.center, f.shift);
    for (int i = 0; i < 3; ++i) {
        out.axis[i] = turned(f.columns, box.axis[i], F4{});
        out.h[i] = box.half[i];
    }
    return out;
}

FGENV_INLINE void load_axes(const Oriented& n, F8 (&axis)[3][3]) {
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 3; ++k) axis[i][k] = load(n.axis[i][k]);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        axis[2][i] = axis[0][j] * axis[1][k] - axis[0][k] * axis[1][j];
    }
}

// The boxes of a node that overlap `box`: normals of both boxes' faces, then products of their edges.
// `centers`: squared distances of the centers, for the order of the search.
FGENV_INLINE uint32_t overlapping(const Oriented& n, const PosedBox& box, float slack, F8& centers) {
    F8 d[3], h[3], r[3][3], abs_r[3][3], along_n[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = load(n.center[k]) - splat(box.c[k]);
        h[k] = load(n.half[k]);
    }
    F8 axis[3][3];
    load_axes(n, axis);
    centers = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    I8 meet = I8{} == 0;
    for (int j = 0; j < 3; ++j) {
        const F8 x = splat(box.axis[j][0]), y = splat(box.axis[j][1]), z = splat(box.axis[j][2]);
        F8 radius = splat(box.h[j] + slack);
        for (int i = 0; i < 3; ++i) {
            r[i][j] = fused(z, axis[i][2], fused(y, axis[i][1], x * axis[i][0]));
            abs_r[i][j] = abs(r[i][j]);
            radius = fused(h[i], abs_r[i][j], radius);
        }
        meet &= abs(fused(d[2], z, fused(d[1], y, d[0] * x))) <= radius;
    }
    if (!bits(meet)) return 0;
    for (int i = 0; i < 3; ++i) {
        along_n[i] = fused(d[2], axis[i][2], fused(d[1], axis[i][1], d[0] * axis[i][0]));
        F8 radius = h[i] + splat(slack);
        for (int j = 0; j < 3; ++j) radius = fused(abs_r[i][j], splat(box.h[j]), radius);
        meet &= abs(along_n[i]) <= radius;
    }
    if (!bits(meet)) return 0;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const F8 along = fused(along_n[i2], r[i1][j], -(along_n[i1] * r[i2][j]));
            const F8 own = fused(h[i1], abs_r[i2][j], fused(h[i2], abs_r[i1][j], splat(2 * slack)));
            const F8 radius = fused(splat(box.h[j1]), abs_r[i][j2], fused(splat(box.h[j2]), abs_r[i][j1], own));
            meet &= abs(along) <= radius;
        }
    }
    return bits(meet);
}

}  // namespace fgenv
