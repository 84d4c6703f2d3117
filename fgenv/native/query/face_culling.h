// Eight faces against a box, one face against eight: what may meet, in floats with slack. In the order of
// T. Moeller, "A fast triangle-triangle intersection test", 1997: boxes, planes, then the rest.
#pragma once

#include "query/box_culling.h"

namespace fgenv {

// Eight faces with what the culling tests need of them.
struct FacesF {
    F8 v[3][3];  // vertex, axis
    F8 n[3];     // normal, not normalized
    F8 lo[3], hi[3];
    F8 scale;  // sum of the lengths of two sides (1-norm)
};

// Float errors of a leaf pair in the frame of a's leaf; `size` bounds the 1-norm of every difference of
// two points. In units u = 2^-24: a vertex of b is rounded (1 u of its size), turned by a rounded
// rotation (1 u), in three products and three sums (1 u of the size and 3 u of the partial sums at the
// most), which is less than 4 u size = slack; one of a is only rounded. A volume is a determinant of
// three differences, each off by 2 slack: for differences u, v, w it is off by less than
// volume_slack (|u||v| + |v||w| + |w||u|) in 1-norms, its own rounding included.
struct Local {
    float size, slack, volume_slack;
};

FGENV_INLINE Local local_errors(float size) {
    const float slack = 4 * 0x1p-24f * size;
    return {size, slack, 4 * slack};
}

FGENV_INLINE void load_faces(const Leaf& leaf, FacesF& out) {
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) out.v[k][i] = load(leaf.v[k][i]);
}

// Turned, then moved by `shift`.
FGENV_INLINE void load_faces(const Leaf& leaf, const float r[3][3], const float shift[3], FacesF& out) {
    for (int k = 0; k < 3; ++k) {
        const F8 x = load(leaf.v[k][0]), y = load(leaf.v[k][1]), z = load(leaf.v[k][2]);
        for (int i = 0; i < 3; ++i)
            out.v[k][i] = fused(splat(r[i][2]), z, fused(splat(r[i][1]), y, fused(splat(r[i][0]), x, splat(shift[i]))));
    }
}

// The center of b's leaf less that of a's, in a's frame; subtracted in double.
FGENV_INLINE Local leaf_shift(const Leaf& la, const Leaf& lb, const Rigid& pose, float shift[3]) {
    const Vec3 center =
        apply(pose, {lb.center[0], lb.center[1], lb.center[2]}) - Vec3{la.center[0], la.center[1], la.center[2]};
    for (int i = 0; i < 3; ++i) shift[i] = static_cast<float>(coordinate(center, i));
    return local_errors(2 * (size(la) + size(lb)) + std::fabs(shift[0]) + std::fabs(shift[1]) + std::fabs(shift[2]));
}

// Both leaves of a pair in a's frame, relative to the center of a's leaf; b's center is then at `shift`.
FGENV_INLINE Local load_leaves(const Leaf& la, const Leaf& lb, const Rigid& pose, const PairFrame& frame, FacesF& a,
                               FacesF& b, float shift[3]) {
    const Local local = leaf_shift(la, lb, pose, shift);
    load_faces(la, a);
    load_faces(lb, frame.r, shift, b);
    return local;
}

FGENV_INLINE void find_boxes(FacesF& f) {
    for (int i = 0; i < 3; ++i) {
        f.lo[i] = min(min(f.v[0][i], f.v[1][i]), f.v[2][i]);
        f.hi[i] = max(max(f.v[0][i], f.v[1][i]), f.v[2][i]);
    }
}

FGENV_INLINE void find_normals(FacesF& f) {
    F8 u[3], w[3];
    f.scale = F8{};
    for (int i = 0; i < 3; ++i) {
        u[i] = f.v[1][i] - f.v[0][i];
        w[i] = f.v[2][i] - f.v[0][i];
        f.scale += abs(u[i]) + abs(w[i]);
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        f.n[i] = fused(u[j], w[k], -(u[k] * w[j]));
    }
}

// Which faces may meet a box: the box's axes, then their own planes.
FGENV_INLINE uint32_t faces_near_box(FacesF& f, const float lo[3], const float hi[3], const Local& local,
                                     uint32_t among) {
    find_boxes(f);
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i)
        meet &= (f.lo[i] <= splat(hi[i] + local.slack)) & (f.hi[i] >= splat(lo[i] - local.slack));
    among &= bits(meet);
    if (!among) return 0;
    find_normals(f);
    F8 at_center = F8{}, radius = f.scale * splat(local.volume_slack * local.size);
    for (int i = 0; i < 3; ++i) {
        at_center = fused(f.n[i], splat(0.5f * (lo[i] + hi[i])) - f.v[0][i], at_center);
        radius = fused(abs(f.n[i]), splat(0.5f * (hi[i] - lo[i]) + local.slack), radius);
    }
    return among & bits(abs(at_center) <= radius);
}

// The same for an oriented box, along its own axes: the sharpest test where a leaf's box is a thin plate.
// Faces that are larger than the box are asked by their upright boxes as well. `box.c` is relative to the
// faces' origin; `slack` holds the errors of placing it.
FGENV_INLINE uint32_t faces_near_box(FacesF& f, const PosedBox& box, float slack, const Local& local, uint32_t among,
                                     bool larger) {
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i) {
        const F8 x = splat(box.axis[i][0]), y = splat(box.axis[i][1]), z = splat(box.axis[i][2]);
        const float c = box.axis[i][0] * box.c[0] + box.axis[i][1] * box.c[1] + box.axis[i][2] * box.c[2];
        const float h = box.h[i] + slack;
        F8 along[3];
        for (int k = 0; k < 3; ++k) along[k] = fused(f.v[k][2], z, fused(f.v[k][1], y, f.v[k][0] * x));
        meet &= (min(min(along[0], along[1]), along[2]) <= splat(c + h)) &
                (max(max(along[0], along[1]), along[2]) >= splat(c - h));
    }
    if (!(among &= bits(meet))) return 0;
    find_boxes(f);
    if (larger) {
        for (int i = 0; i < 3; ++i) {
            float h = slack;
            for (int k = 0; k < 3; ++k) h += std::fabs(box.axis[k][i]) * box.h[k];
            meet &= (f.lo[i] <= splat(box.c[i] + h)) & (f.hi[i] >= splat(box.c[i] - h));
        }
        if (!(among &= bits(meet))) return 0;
    }
    find_normals(f);
    F8 at_center = F8{}, radius = f.scale * splat(local.volume_slack * local.size);
    for (int i = 0; i < 3; ++i) {
        const F8 along_axis =
            fused(f.n[2], splat(box.axis[i][2]), fused(f.n[1], splat(box.axis[i][1]), f.n[0] * splat(box.axis[i][0])));
        at_center = fused(f.n[i], splat(box.c[i]) - f.v[0][i], at_center);
        radius = fused(abs(f.n[i]), splat(slack), fused(abs(along_axis), splat(box.h[i]), radius));
    }
    return among & bits(abs(at_center) <= radius);
}

// The box around some of eight faces.
FGENV_INLINE void bounds_of(const FacesF& f, uint32_t among, float lo[3], float hi[3]) {
    for (int i = 0; i < 3; ++i) {
        lo[i] = 1e30f;
        hi[i] = -1e30f;
    }
    for (; among; among &= among - 1) {
        const int k = __builtin_ctz(among);
        for (int i = 0; i < 3; ++i) {
            lo[i] = f.lo[i][k] < lo[i] ? f.lo[i][k] : lo[i];
            hi[i] = f.hi[i][k] > hi[i] ? f.hi[i][k] : hi[i];
        }
    }
}

// Which of eight faces g may meet face i of f: boxes, the two planes, then the nine products of sides.
// For the axis u x w of sides u of f and w of g the shapes' extents along it are the plane values
// already at hand (n_f . w and n_g . u), so one triple product an axis is left.
FGENV_INLINE uint32_t faces_near_face(const FacesF& f, int i, const FacesF& g, const Local& local, uint32_t among) {
    I8 meet = I8{} == 0;
    for (int x = 0; x < 3; ++x)
        meet &= (g.lo[x] <= splat(f.hi[x][i] + local.slack)) & (g.hi[x] >= splat(f.lo[x][i] - local.slack));
    among &= bits(meet);
    if (!among) return 0;

    const F8 zero = F8{};
    const F8 reach = (g.scale + splat(f.scale[i])) * splat(local.volume_slack);  // boxes meet: all is near
    const F8 own = reach * splat(f.scale[i]), theirs = reach * g.scale;
    F8 g_side[3], f_side[3];  // of the plane of the other
    for (int k = 0; k < 3; ++k) {
        g_side[k] = zero;
        for (int x = 0; x < 3; ++x) g_side[k] = fused(splat(f.n[x][i]), g.v[k][x] - splat(f.v[0][x][i]), g_side[k]);
    }
    meet = (min(min(g_side[0], g_side[1]), g_side[2]) <= own) & (max(max(g_side[0], g_side[1]), g_side[2]) >= -own);
    among &= bits(meet);
    if (!among) return 0;

    for (int k = 0; k < 3; ++k) {
        f_side[k] = zero;
        for (int x = 0; x < 3; ++x) f_side[k] = fused(g.n[x], splat(f.v[k][x][i]) - g.v[0][x], f_side[k]);
    }
    meet =
        (min(min(f_side[0], f_side[1]), f_side[2]) <= theirs) & (max(max(f_side[0], f_side[1]), f_side[2]) >= -theirs);
    among &= bits(meet);
    if (!among) return 0;

    const F8 both = splat(2.0f) * (own + theirs);
    for (int k = 0; k < 3; ++k) {
        F8 u[3];
        for (int x = 0; x < 3; ++x) u[x] = splat(f.v[(k + 1) % 3][x][i] - f.v[k][x][i]);
        const F8 g_extent = f_side[(k + 1) % 3] - f_side[k];  // n_g . u
        for (int l = 0; l < 3; ++l) {
            F8 w[3], q[3];
            for (int x = 0; x < 3; ++x) {
                w[x] = g.v[(l + 1) % 3][x] - g.v[l][x];
                q[x] = g.v[l][x] - splat(f.v[k][x][i]);
            }
            F8 at = zero;
            for (int x = 0; x < 3; ++x) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                at = fused(fused(u[y], w[z], -(u[z] * w[y])), q[x], at);
            }
            const F8 f_extent = g_side[l] - g_side[(l + 1) % 3];  // -n_f . w
            meet &= (at + min(g_extent, zero) <= max(f_extent, zero) + both) &
                    (at + max(g_extent, zero) >= min(f_extent, zero) - both);
        }
        if (!(among &= bits(meet))) break;
    }
    return among;
}

}  // namespace fgenv
