// Direction in which two convex hulls are apart: the point nearest to the origin of the hull of all differences,
// by a simplex of its corners (E. Gilbert, D. Johnson, S. Keerthi, "A fast procedure for computing the
// distance between complex objects in three-dimensional space", 1988).
#pragma once

#include "math/geometry.h"

namespace fgenv {

struct Simplex {
    Vec3 p[4];
    int n = 0;
};

// The point of an edge or face nearest to the origin (C. Ericson, "Real-Time Collision Detection", 2005,
// 5.1.5); leaves the corners that hold it.
static inline Vec3 nearest_of_edge(Simplex& s, Vec3 a, Vec3 b) {
    const Vec3 ab = b - a;
    const double t = -dot(a, ab), length = dot(ab, ab);
    if (t <= 0) return s.p[0] = a, s.n = 1, a;
    if (t >= length) return s.p[0] = b, s.n = 1, b;
    s.p[0] = a, s.p[1] = b, s.n = 2;
    return a + (t / length) * ab;
}

static inline Vec3 nearest_of_face(Simplex& s, Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 ab = b - a, ac = c - a;
    const double d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b), d5 = -dot(ab, c),
                 d6 = -dot(ac, c);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return nearest_of_edge(s, a, b);
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return nearest_of_edge(s, a, c);
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return nearest_of_edge(s, b, c);
    if (d1 <= 0 && d2 <= 0) return s.p[0] = a, s.n = 1, a;
    if (d3 >= 0 && d4 <= d3) return s.p[0] = b, s.n = 1, b;
    if (d6 >= 0 && d5 <= d6) return s.p[0] = c, s.n = 1, c;
    s.p[0] = a, s.p[1] = b, s.p[2] = c, s.n = 3;
    const double sum = va + vb + vc;
    return a + (vb / sum) * ab + (vc / sum) * ac;
}

// The point of a simplex nearest to the origin; (0, 0, 0) if the origin is inside.
static inline Vec3 nearest_of_simplex(Simplex& s) {
    const Simplex all = s;
    const Vec3* p = all.p;
    if (s.n == 1) return p[0];
    if (s.n == 2) return nearest_of_edge(s, p[0], p[1]);
    if (s.n == 3) return nearest_of_face(s, p[0], p[1], p[2]);
    static constexpr int faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    Vec3 best{0, 0, 0};
    double least = HUGE_VAL;
    for (const auto& f : faces) {
        const Vec3 n = cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]);
        const double side = -dot(n, p[f[0]]), other = dot(n, p[f[3]] - p[f[0]]);
        if (side * other > 0) continue;  // the origin is on the inner side
        Simplex part;
        const Vec3 v = nearest_of_face(part, p[f[0]], p[f[1]], p[f[2]]);
        if (dot(v, v) >= least) continue;
        least = dot(v, v);
        best = v;
        s = part;
    }
    return best;
}

// Vector from the first hull to the second; (0, 0, 0) if they overlap. `corner(n)` is the
// corner of the differences, second less first, that is farthest against n. A good guess saves steps. `precision` is
// relative, of the squared distance.
template <class Corner>
static inline Vec3 direction_apart(const Corner& corner, Vec3 guess, double precision = 1e-6) {
    constexpr int max_steps = 24;
    Simplex s;
    s.p[s.n++] = corner(guess);
    Vec3 v = s.p[0];
    for (int i = 0; i < max_steps; ++i) {
        const double squared = dot(v, v);
        const Vec3 w = corner(v);
        if (!(squared - dot(v, w) > precision * squared)) break;  // none is much nearer
        s.p[s.n++] = w;
        v = nearest_of_simplex(s);
        if (s.n == 4 || dot(v, v) == 0) return {0, 0, 0};
    }
    return v;
}

}  // namespace fgenv
