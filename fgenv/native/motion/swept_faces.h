// Finds the faces of two leaves that may touch while both move, one against eight, after the test of the
// leaves' boxes in swept_boxes.h.
#pragma once

#include "motion/swept_boxes.h"
#include "query/face_culling.h"

namespace fgenv {

// Displacements of the corners of eight faces, relative to the other leaf's center.
FGENV_INLINE void corner_drifts(const FacesF& f, const SideMotion& s, const float center[3], const float less[3],
                                F8 (&u)[3][3]) {
    for (int k = 0; k < 3; ++k) {
        F8 c[3];
        for (int i = 0; i < 3; ++i) c[i] = f.v[k][i] + splat(center[i] - s.origin[i]);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            u[k][i] = splat(s.v[i] - less[i]) + (splat(s.w[j]) * c[l] - splat(s.w[l]) * c[j]);
        }
    }
}

FGENV_INLINE void find_swept_boxes(FacesF& f, const F8 (&u)[3][3], float pad) {
    for (int i = 0; i < 3; ++i) {
        const F8 x = abs(u[0][i]), y = abs(u[1][i]), z = abs(u[2][i]);
        f.lo[i] = min(min(f.v[0][i] - x, f.v[1][i] - y), f.v[2][i] - z) - splat(pad);
        f.hi[i] = max(max(f.v[0][i] + x, f.v[1][i] + y), f.v[2][i] + z) + splat(pad);
    }
}

// Whether eight faces may cross the plane of one, or one face the planes of eight. `side`: heights of
// corners over the plane; `rise`: their changes in half the time; `lift`: those of the plane's own corners.
// Heights are linear in time up to `reach`, so the two ends of the stretch decide.
FGENV_INLINE I8 crossing_plane(const F8 (&side)[3], const F8 (&rise)[3], const F8 (&lift)[3], F8 reach) {
    const F8 up = max(max(lift[0], lift[1]), lift[2]), down = min(min(lift[0], lift[1]), lift[2]);
    const F8 lo_after = min(min(side[0] + rise[0], side[1] + rise[1]), side[2] + rise[2]) - up;
    const F8 hi_after = max(max(side[0] + rise[0], side[1] + rise[1]), side[2] + rise[2]) - down;
    const F8 lo_before = min(min(side[0] - rise[0], side[1] - rise[1]), side[2] - rise[2]) + down;
    const F8 hi_before = max(max(side[0] - rise[0], side[1] - rise[1]), side[2] - rise[2]) + up;
    return (min(lo_after, lo_before) <= reach) & (max(hi_after, hi_before) >= -reach);
}

// Two leaves in a's frame, relative to the center of a's leaf.
struct SweptLeaves {
    FacesF a, b;
    F8 ua[3][3], ub[3][3];  // displacements of corners in half the time
    Local local;
    float pad;  // bound on further motion of the corners, with margin and rounding
};

FGENV_INLINE void load_swept_leaves(const Rigid& pose, const SweptView& view, const Leaf& la, const Leaf& lb,
                                    SweptLeaves& s) {
    float shift[3];
    s.local = leaf_shift(la, lb, pose, shift);
    load_faces(la, s.a);
    const auto& r = view.frame.r;
    for (int k = 0; k < 3; ++k) {
        const F8 x = load(lb.v[k][0]), y = load(lb.v[k][1]), z = load(lb.v[k][2]);
        for (int i = 0; i < 3; ++i)
            s.b.v[k][i] = splat(r[i][0]) * x + splat(r[i][1]) * y + splat(r[i][2]) * z + splat(shift[i]);
    }
    const float radius_a = length_bound(la.half[0], la.half[1], la.half[2]);
    const float radius_b = length_bound(lb.half[0], lb.half[1], lb.half[2]);
    const float far[3] = {la.center[0] + shift[0], la.center[1] + shift[1], la.center[2] + shift[2]};
    const Drift of_a = drift(view.own, la.center[0], la.center[1], la.center[2], radius_a);
    const Drift of_b = drift(view.other, far[0], far[1], far[2], radius_b);
    // Every corner has its own displacement here, so only acceleration and rounding remain.
    s.pad = (of_a.e - view.own.turn * radius_a) + (of_b.e - view.other.turn * radius_b) + view.pad + 2 * s.local.slack +
            2 * float_share * (view.own.turn * radius_a + view.other.turn * radius_b);
    corner_drifts(s.a, view.own, la.center, of_b.u, s.ua);
    corner_drifts(s.b, view.other, la.center, of_b.u, s.ub);
    find_swept_boxes(s.a, s.ua, s.pad);
    find_swept_boxes(s.b, s.ub, 0);
}

// As find_normals, without fused products.
FGENV_INLINE void find_unfused_normals(FacesF& f) {
    F8 u[3], w[3];
    f.scale = F8{};
    for (int x = 0; x < 3; ++x) {
        u[x] = f.v[1][x] - f.v[0][x];
        w[x] = f.v[2][x] - f.v[0][x];
        f.scale += abs(u[x]) + abs(w[x]);
    }
    for (int x = 0; x < 3; ++x) {
        const int y = (x + 1) % 3, z = (x + 2) % 3;
        f.n[x] = u[y] * w[z] - u[z] * w[y];
    }
}

FGENV_INLINE I8 swept_boxes_overlap(const FacesF& a, int i, const FacesF& b) {
    return (b.lo[0] <= splat(a.hi[0][i])) & (b.hi[0] >= splat(a.lo[0][i])) & (b.lo[1] <= splat(a.hi[1][i])) &
           (b.hi[1] >= splat(a.lo[1][i])) & (b.lo[2] <= splat(a.hi[2][i])) & (b.hi[2] >= splat(a.lo[2][i]));
}

FGENV_INLINE I8 faces_cross_plane(const SweptLeaves& s, int i) {
    F8 side[3], rise[3], lift[3];
    for (int k = 0; k < 3; ++k) {
        side[k] = rise[k] = lift[k] = F8{};
        for (int x = 0; x < 3; ++x) {
            const F8 n = splat(s.a.n[x][i]);
            side[k] += n * (s.b.v[k][x] - splat(s.a.v[0][x][i]));
            rise[k] += n * s.ub[k][x];
            lift[k] += n * splat(s.ua[k][x][i]);
        }
    }
    const float normal = length_bound(s.a.n[0][i], s.a.n[1][i], s.a.n[2][i]);
    const F8 volume = splat(s.local.volume_slack * s.local.size);
    return crossing_plane(side, rise, lift, splat(normal * s.pad) + volume * splat(s.a.scale[i]));
}

FGENV_INLINE I8 face_crosses_planes(const SweptLeaves& s, int i) {
    F8 side[3], rise[3], lift[3];
    for (int k = 0; k < 3; ++k) {
        side[k] = rise[k] = lift[k] = F8{};
        for (int x = 0; x < 3; ++x) {
            side[k] += s.b.n[x] * (splat(s.a.v[k][x][i]) - s.b.v[0][x]);
            rise[k] += s.b.n[x] * splat(s.ua[k][x][i]);
            lift[k] += s.b.n[x] * s.ub[k][x];
        }
    }
    const F8 normal = length_bound(s.b.n[0], s.b.n[1], s.b.n[2]);
    const F8 volume = splat(s.local.volume_slack * s.local.size);
    return crossing_plane(side, rise, lift, normal * splat(s.pad) + volume * s.b.scale);
}

// Perpendicular to the relative motion of the faces' centers, as for boxes.
FGENV_INLINE I8 overlap_across_motion(const SweptLeaves& s, int i) {
    F8 d[3], u[3], w[3];
    for (int x = 0; x < 3; ++x) {
        d[x] = (s.b.v[0][x] + s.b.v[1][x] + s.b.v[2][x]) - splat(s.a.v[0][x][i] + s.a.v[1][x][i] + s.a.v[2][x][i]);
        u[x] = (s.ub[0][x] + s.ub[1][x] + s.ub[2][x]) - splat(s.ua[0][x][i] + s.ua[1][x][i] + s.ua[2][x][i]);
    }
    across(d, u, w);
    F8 top_after = splat(-1e30f), top_before = top_after, low_after = splat(1e30f), low_before = low_after;
    for (int k = 0; k < 3; ++k) {
        F8 at_a = F8{}, at_b = F8{}, rise_a = F8{}, rise_b = F8{};
        for (int x = 0; x < 3; ++x) {
            at_a += w[x] * splat(s.a.v[k][x][i]);
            at_b += w[x] * s.b.v[k][x];
            rise_a += w[x] * splat(s.ua[k][x][i]);
            rise_b += w[x] * s.ub[k][x];
        }
        top_after = max(top_after, at_a + rise_a);
        top_before = max(top_before, at_a - rise_a);
        low_after = min(low_after, at_b + rise_b);
        low_before = min(low_before, at_b - rise_b);
    }
    return min(low_after - top_after, low_before - top_before) <= length_bound(w[0], w[1], w[2]) * splat(s.pad);
}

struct FoundPairs {
    FacePair* out;
    int count, capacity;  // count is capacity + 1 if there are more

    void add(FacePair pair) {
        if (count < capacity) out[count] = pair;
        ++count;
    }
    bool full() const { return count > capacity; }
};

// Appends the pairs of faces of two leaves that may touch.
static inline void find_pairs(const Rigid& pose, const SweptView& view, const Leaf& la, const Leaf& lb,
                              FoundPairs& found) {
    SweptLeaves s;
    load_swept_leaves(pose, view, la, lb, s);
    bool has_normals = false;
    for (uint32_t m = la.valid; m; m &= m - 1) {
        const int i = __builtin_ctz(m);
        uint32_t among = lb.valid & bits(swept_boxes_overlap(s.a, i, s.b));
        if (!among) continue;
        if (!has_normals) {
            find_unfused_normals(s.a);
            find_unfused_normals(s.b);
            has_normals = true;
        }
        if (!(among &= bits(faces_cross_plane(s, i)))) continue;
        if (!(among &= bits(face_crosses_planes(s, i)))) continue;
        for (among &= bits(overlap_across_motion(s, i)); among; among &= among - 1) {
            found.add({la.face[i], lb.face[__builtin_ctz(among)]});
            if (found.full()) return;
        }
    }
}

}  // namespace fgenv
