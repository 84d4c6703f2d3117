// Distances of faces in double: of four pairs at once, and the nearest points of one pair.
#pragma once

#include "query/faces4.h"
#include "query/kernels.h"

namespace fgenv {

FGENV_INLINE D4 squared_distances(const Faces& f, const Faces& g) {
    D4 best = splat(HUGE_VAL), s, t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            best = min(best, segments(f.v[i], f.side[i], f.length[i], f.inv_length[i], g.v[j], g.side[j], g.length[j],
                                      g.inv_length[j], s, t));
    for (int i = 0; i < 3; ++i) {
        best = min(best, above_face(f.v[i], g));
        best = min(best, above_face(g.v[i], f));
    }
    return best;
}

FGENV_INLINE Vec3 lane(const V4 v, int k) { return {v[0][k], v[1][k], v[2][k]}; }

// Side i of a against the three sides of b.
static inline void nearest_on_sides(const Triangle& a, int i, const Triangle& b, Nearest& out) {
    Points rows[4];
    for (int l = 0; l < width; ++l) {
        const int j = l % 3;
        put(rows[0], l, a[i]);
        put(rows[1], l, a[(i + 1) % 3] - a[i]);
        put(rows[2], l, b[j]);
        put(rows[3], l, b[(j + 1) % 3] - b[j]);
    }
    V4 p, u, q, w;
    read(rows[0], p);
    read(rows[1], u);
    read(rows[2], q);
    read(rows[3], w);
    D4 s, t;
    const D4 uu = dot(u, u), ww = dot(w, w);
    const D4 d = segments(p, u, uu, reciprocal(uu), q, w, ww, reciprocal(ww), s, t);
    for (int l = 0; l < 3; ++l)
        if (d[l] < out.squared) {
            out.squared = d[l];
            out.on_a = point(rows[0], l) + s[l] * point(rows[1], l);
            out.on_b = point(rows[2], l) + t[l] * point(rows[3], l);
        }
}

// The three vertices of `from` against the interior of `to`.
static inline void nearest_on_interior(const Triangle& from, const Triangle& to, double& squared, Vec3& on_from,
                                       Vec3& on_to) {
    Points rows[4];
    for (int l = 0; l < width; ++l) {
        for (int k = 0; k < 3; ++k) put(rows[k], l, to[k]);
        put(rows[3], l, from[l % 3]);
    }
    Faces f;
    V4 p;
    for (int k = 0; k < 3; ++k) read(rows[k], f.v[k]);
    read(rows[3], p);
    derive(f);
    const D4 d = above_face(p, f);
    for (int l = 0; l < 3; ++l)
        if (d[l] < squared) {
            squared = d[l];
            const Vec3 n = lane(f.n, l);
            on_from = from[l];
            on_to = from[l] - (fgenv::dot(n, from[l] - to[2]) * f.inv_n[l]) * n;
        }
}

// The nearest points of two faces that do not cross: three pairs of sides or three vertices at a time.
static inline void nearest_points(const Triangle& a, const Triangle& b, Nearest& out) {
    out.squared = HUGE_VAL;
    for (int i = 0; i < 3; ++i) nearest_on_sides(a, i, b, out);
    nearest_on_interior(a, b, out.squared, out.on_a, out.on_b);
    nearest_on_interior(b, a, out.squared, out.on_b, out.on_a);
}

}  // namespace fgenv
