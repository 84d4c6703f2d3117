// Lower bounds on distances in floats with slack: of boxes, one against eight, and of the faces of two leaves.
#pragma once

#include "query/face_culling.h"

namespace fgenv {

// Squared lower bounds on the distance of `box` to the eight boxes of a node: in the frame of either box, the
// gaps to the upright box around the other; and the gap along `towards`, a unit vector from the node to the
// box. `order` adds a share of the distance of the centers, which breaks ties between boxes that overlap.
FGENV_INLINE F8 lower_bounds(const Oriented& n, const PosedBox& box, const float towards[3], float slack, F8& order) {
    F8 d[3], h[3], axis[3][3], abs_r[3][3], here = F8{}, there = F8{};
    load_axes(n, axis);
    for (int k = 0; k < 3; ++k) {
        d[k] = load(n.center[k]) - splat(box.c[k]);
        h[k] = load(n.half[k]);
    }
    for (int i = 0; i < 3; ++i) {
        const F8 x = axis[i][0], y = axis[i][1], z = axis[i][2];
        F8 radius = h[i] + splat(slack);
        for (int j = 0; j < 3; ++j) {
            abs_r[i][j] = abs(x * splat(box.axis[j][0]) + y * splat(box.axis[j][1]) + z * splat(box.axis[j][2]));
            radius += abs_r[i][j] * splat(box.h[j]);
        }
        const F8 gap = max(abs(d[0] * x + d[1] * y + d[2] * z) - radius, F8{});
        here += gap * gap;
    }
    for (int j = 0; j < 3; ++j) {
        const F8 along = d[0] * splat(box.axis[j][0]) + d[1] * splat(box.axis[j][1]) + d[2] * splat(box.axis[j][2]);
        const F8 radius = h[0] * abs_r[0][j] + h[1] * abs_r[1][j] + h[2] * abs_r[2][j] + splat(box.h[j] + slack);
        const F8 gap = max(abs(along) - radius, F8{});
        there += gap * gap;
    }
    F8 along = F8{}, radius = splat(2 * slack);
    for (int i = 0; i < 3; ++i) {
        along -= d[i] * splat(towards[i]);
        F8 axis_along = F8{};
        for (int k = 0; k < 3; ++k) axis_along += axis[i][k] * splat(towards[k]);
        radius += abs(axis_along) * h[i];
        const float box_along = box.axis[i][0] * towards[0] + box.axis[i][1] * towards[1] + box.axis[i][2] * towards[2];
        radius += splat(std::fabs(box_along) * box.h[i]);
    }
    const F8 apart = max(along - radius, F8{});
    const F8 bound = max(max(here, there), apart * apart) * splat(0.9999f);  // a pose may be off orthonormal by 1e-5
    order = bound + (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * splat(1e-2f);
    return h[0] >= splat(0.0f) ? bound : splat(HUGE_VALF);
}

// At least the lengths of eight vectors, at most 1.16 times them, without squares that could vanish.
FGENV_INLINE F8 length_bound(const F8 (&v)[3]) {
    const F8 x = abs(v[0]), y = abs(v[1]), z = abs(v[2]);
    return splat(0.5f) * (x + y + z + max(max(x, y), z));
}

// Which of eight faces g may be nearer than `radius` to face i of f: boxes, then the two planes.
FGENV_INLINE uint32_t faces_within(const FacesF& f, int i, const FacesF& g, const Local& local, float radius,
                                   uint32_t among) {
    F8 gaps = F8{};
    for (int x = 0; x < 3; ++x) {
        const F8 gap =
            max(max(g.lo[x] - splat(f.hi[x][i]), splat(f.lo[x][i]) - g.hi[x]) - splat(2 * local.slack), F8{});
        gaps += gap * gap;
    }
    among &= bits(gaps <= splat(radius * radius));
    if (!among) return 0;
    const F8 reach = splat(local.volume_slack * local.size);
    const F8 own_normal[3] = {splat(f.n[0][i]), splat(f.n[1][i]), splat(f.n[2][i])};
    const F8 own = length_bound(own_normal) * splat(radius) + reach * splat(f.scale[i]);
    const F8 theirs = length_bound(g.n) * splat(radius) + reach * g.scale;
    F8 side[3];
    for (int k = 0; k < 3; ++k) {
        side[k] = F8{};
        for (int x = 0; x < 3; ++x) side[k] += own_normal[x] * (g.v[k][x] - splat(f.v[0][x][i]));
    }
    I8 near = (min(min(side[0], side[1]), side[2]) <= own) & (max(max(side[0], side[1]), side[2]) >= -own);
    for (int k = 0; k < 3; ++k) {
        side[k] = F8{};
        for (int x = 0; x < 3; ++x) side[k] += g.n[x] * (splat(f.v[k][x][i]) - g.v[0][x]);
    }
    near &= (min(min(side[0], side[1]), side[2]) <= theirs) & (max(max(side[0], side[1]), side[2]) >= -theirs);
    return among & bits(near);
}

// Squared distance of the nearest vertices: a first bound.
FGENV_INLINE float nearest_vertices(const FacesF& a, uint32_t in_a, const FacesF& b) {
    F8 best = splat(HUGE_VALF);
    for (; in_a; in_a &= in_a - 1) {
        const int i = __builtin_ctz(in_a);
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                F8 sum = F8{};
                for (int x = 0; x < 3; ++x) {
                    const F8 d = b.v[l][x] - splat(a.v[k][x][i]);
                    sum += d * d;
                }
                best = min(best, sum);
            }
    }
    float out = best[0];
    for (int l = 1; l < lanes; ++l) out = best[l] < out ? best[l] : out;
    return out;
}

FGENV_INLINE F8 along(const F8 (&v)[3], const float d[3]) {
    return v[0] * splat(d[0]) + v[1] * splat(d[1]) + v[2] * splat(d[2]);
}

}  // namespace fgenv
