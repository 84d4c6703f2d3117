// Distance of two surfaces: branch and bound over the two trees, faces eight at a time in double.
// Segments as in C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.9; a face's interior is
// only asked for vertices, since sides against sides cover everything else.
#include "kernels.h"
#include "pair_frame.h"

namespace fgenv::FGENV_ISA {
namespace {

typedef D8 V8[3];  // eight points or vectors

FGENV_INLINE D8 dot(const V8 a, const V8 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
FGENV_INLINE void subtract(const V8 a, const V8 b, V8 out) {
    for (int i = 0; i < 3; ++i) out[i] = a[i] - b[i];
}
FGENV_INLINE void cross(const V8 a, const V8 b, V8 out) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}
FGENV_INLINE D8 clamped(D8 x) { return min(max(x, splat(0.0)), splat(1.0)); }
// 1 / x, and 0 where x is 0 (a side of length 0 after placing, parallel sides).
FGENV_INLINE D8 reciprocal(D8 x) { return x > splat(0.0) ? splat(1.0) / x : splat(0.0); }

// Parameters of the nearest points of p + s u and q + t w, 0 <= s, t <= 1; the squared distance.
FGENV_INLINE D8 segments(const V8 p, const V8 u, D8 uu, D8 inv_uu, const V8 q, const V8 w, D8 ww,
                         D8 inv_ww, D8& s, D8& t) {
    V8 r;
    subtract(p, q, r);
    const D8 ur = dot(u, r), wr = dot(w, r), uw = dot(u, w);
    s = clamped((uw * wr - ur * ww) * reciprocal(uu * ww - uw * uw));
    t = clamped((uw * s + wr) * inv_ww);
    s = clamped((uw * t - ur) * inv_uu);
    for (int i = 0; i < 3; ++i) r[i] += s * u[i] - t * w[i];
    return dot(r, r);
}

struct Faces {
    V8 v[3], side[3];  // side k from vertex k to k + 1
    D8 length[3], inv_length[3];  // squared
    V8 n;
    D8 inv_n;  // of the squared normal
};

FGENV_INLINE void derive(Faces& f) {
    for (int k = 0; k < 3; ++k) {
        subtract(f.v[(k + 1) % 3], f.v[k], f.side[k]);
        f.length[k] = dot(f.side[k], f.side[k]);
        f.inv_length[k] = reciprocal(f.length[k]);
    }
    cross(f.side[0], f.side[1], f.n);
    f.inv_n = reciprocal(dot(f.n, f.n));
}

// Squared distance of point p to the interior of the face, huge where it projects outside.
FGENV_INLINE D8 above_face(const V8 p, const Faces& f) {
    L8 within = L8{} == 0;
    V8 r, outward;
    for (int k = 0; k < 3; ++k) {
        subtract(p, f.v[k], r);
        cross(f.side[k], f.n, outward);
        within &= dot(r, outward) <= splat(0.0);
    }
    const D8 height = dot(r, f.n);
    const D8 squared = height * height * f.inv_n;
    return within & (f.inv_n > splat(0.0)) ? squared : splat(HUGE_VAL);
}

FGENV_INLINE D8 squared_distances(const Faces& f, const Faces& g) {
    D8 best = splat(HUGE_VAL), s, t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            best = min(best, segments(f.v[i], f.side[i], f.length[i], f.inv_length[i], g.v[j], g.side[j],
                                      g.length[j], g.inv_length[j], s, t));
    for (int i = 0; i < 3; ++i) {
        best = min(best, above_face(f.v[i], g));
        best = min(best, above_face(g.v[i], f));
    }
    return best;
}

struct Corners {
    Vec3 v[3];
};

FGENV_INLINE Corners corners(const Shape& s, int32_t face) {
    const Face& f = s.mesh.faces[face];
    return {{s.mesh.vertices[f[0]], s.mesh.vertices[f[1]], s.mesh.vertices[f[2]]}};
}

FGENV_INLINE void fill(V8 out, int lane, Vec3 p) {
    out[0][lane] = p.x;
    out[1][lane] = p.y;
    out[2][lane] = p.z;
}

FGENV_INLINE void same(V8 out, Vec3 p) {
    out[0] = splat(p.x);
    out[1] = splat(p.y);
    out[2] = splat(p.z);
}

FGENV_INLINE Vec3 lane(const V8 v, int k) { return {v[0][k], v[1][k], v[2][k]}; }

// The nearest points of two faces: its candidates (nine pairs of sides, six vertices) side by side.
void nearest_points(const Corners& a, const Corners& b, Nearest& out) {
    out.squared = HUGE_VAL;
    for (int group = 0; group < 2; ++group) {
        V8 p, u, q, w;
        for (int l = 0; l < lanes; ++l) {
            const int pair = group == 0 ? l : 8, i = pair / 3, j = pair % 3;
            fill(p, l, a.v[i]);
            fill(u, l, a.v[(i + 1) % 3] - a.v[i]);
            fill(q, l, b.v[j]);
            fill(w, l, b.v[(j + 1) % 3] - b.v[j]);
        }
        D8 s, t;
        const D8 uu = dot(u, u), ww = dot(w, w);
        const D8 d = segments(p, u, uu, reciprocal(uu), q, w, ww, reciprocal(ww), s, t);
        for (int l = 0; l < (group == 0 ? lanes : 1); ++l)
            if (d[l] < out.squared) {
                out.squared = d[l];
                out.on_a = lane(p, l) + s[l] * lane(u, l);
                out.on_b = lane(q, l) + t[l] * lane(w, l);
            }
    }
    Faces f;
    V8 p;
    for (int l = 0; l < lanes; ++l) {
        const Corners& face = l < 3 ? b : a;
        for (int k = 0; k < 3; ++k) fill(f.v[k], l, face.v[k]);
        fill(p, l, l < 3 ? a.v[l] : b.v[l % 3]);
    }
    derive(f);
    const D8 d = above_face(p, f);
    for (int l = 0; l < 6; ++l)
        if (d[l] < out.squared) {
            out.squared = d[l];
            const Vec3 n = lane(f.n, l), at = lane(p, l);
            const Vec3 foot = at - (fgenv::dot(n, at - lane(f.v[0], l)) * f.inv_n[l]) * n;
            out.on_a = l < 3 ? at : foot;
            out.on_b = l < 3 ? foot : at;
        }
}

// Squared lower bounds on the distance of `box` (of the other shape) to a node's eight; `order`: the
// distance of the centres breaks ties between boxes that overlap.
FGENV_INLINE F8 lower_bounds(const Node& n, const BoxF& box, const PairFrame& f, F8& order) {
    const BoxF p = placed(box, f);
    F8 d[3], h[3], here = F8{}, there = F8{};
    order = F8{};
    for (int i = 0; i < 3; ++i) {
        d[i] = load(n.centre[i]) - splat(p.c[i]);
        h[i] = load(n.half[i]);
        const F8 gap = max(abs(d[i]) - h[i] - splat(p.h[i]), F8{});
        here += gap * gap;
        order += d[i] * d[i];
    }
    for (int j = 0; j < 3; ++j) {
        const F8 along = d[0] * splat(f.r[0][j]) + d[1] * splat(f.r[1][j]) + d[2] * splat(f.r[2][j]);
        const F8 radius = h[0] * splat(f.abs_r[0][j]) + h[1] * splat(f.abs_r[1][j]) +
                          h[2] * splat(f.abs_r[2][j]) + splat(box.h[j] + f.slack);
        const F8 gap = max(abs(along) - radius, F8{});
        there += gap * gap;
    }
    const F8 bound = max(here, there) * splat(0.99999f);
    order = bound + order * splat(1e-4f);
    return h[0] >= splat(0.0f) ? bound : splat(HUGE_VALF);
}

struct Search {
    const Shape& a;
    const Shape& b;
    const Rigid& pose;
    PairFrames frames;
    double best;  // squared
    bool any;
    int32_t face_a = -1, face_b = -1;
};

FGENV_INLINE D8 box_gaps(const Faces& f, const Corners& c) {
    const double xs[3][3] = {{c.v[0].x, c.v[1].x, c.v[2].x},
                             {c.v[0].y, c.v[1].y, c.v[2].y},
                             {c.v[0].z, c.v[1].z, c.v[2].z}};
    D8 sum = D8{};
    for (int i = 0; i < 3; ++i) {
        const D8 lo = min(min(f.v[0][i], f.v[1][i]), f.v[2][i]);
        const D8 hi = max(max(f.v[0][i], f.v[1][i]), f.v[2][i]);
        const double c_lo = lesser(lesser(xs[i][0], xs[i][1]), xs[i][2]);
        const double c_hi = greater(greater(xs[i][0], xs[i][1]), xs[i][2]);
        const D8 gap = max(max(lo - splat(c_hi), splat(c_lo) - hi), D8{});
        sum += gap * gap;
    }
    return sum;
}

// True if the search is over.
bool search_leaves(Search& q, const Leaf& la, const Leaf& lb) {
    Faces b;
    for (int l = 0; l < lanes; ++l) {
        const Corners c = corners(q.b, lb.face[l]);
        for (int k = 0; k < 3; ++k) fill(b.v[k], l, apply(q.pose, c.v[k]));
    }
    derive(b);
    for (uint32_t in_a = la.valid; in_a; in_a &= in_a - 1) {
        const int i = __builtin_ctz(in_a);
        const Corners c = corners(q.a, la.face[i]);
        if (!(bits(box_gaps(b, c) < splat(q.best)) & lb.valid)) continue;
        Faces a;
        for (int k = 0; k < 3; ++k) same(a.v[k], c.v[k]);
        derive(a);
        const D8 d = squared_distances(a, b);
        for (uint32_t m = bits(q.any ? d <= splat(q.best) : d < splat(q.best)) & lb.valid; m; m &= m - 1) {
            const int j = __builtin_ctz(m);
            if (q.any ? d[j] <= q.best : d[j] < q.best) {
                q.best = d[j];
                q.face_a = la.face[i];
                q.face_b = lb.face[j];
                if (q.any || q.best == 0) return true;
            }
        }
    }
    return false;
}

void search(Search& q) {
    struct Pair {
        Ref a, b;
        float bound;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    const Tree &ta = q.a.tree, &tb = q.b.tree;
    stack[top++] = {0, 0, 0.0f};
    while (top) {
        const Pair pair = stack[--top];
        if (pair.bound > q.best) continue;
        const int32_t ca = child_of(ta, pair.a), cb = child_of(tb, pair.b);
        if (ca < 0 && cb < 0) {
            if (search_leaves(q, ta.leaves[~ca], tb.leaves[~cb])) return;
            continue;
        }
        const BoxF box_a = box_of(ta, pair.a), box_b = box_of(tb, pair.b);
        const bool split_a = cb < 0 || (ca >= 0 && box_a.h[0] + box_a.h[1] + box_a.h[2] >=
                                                       box_b.h[0] + box_b.h[1] + box_b.h[2]);
        F8 order;
        const F8 bound = split_a ? lower_bounds(ta.nodes[ca], box_b, q.frames.b_in_a, order)
                                 : lower_bounds(tb.nodes[cb], box_a, q.frames.a_in_b, order);
        float keys[lanes];
        const int first = top;
        const float limit = q.best < 1e38 ? static_cast<float>(q.best) * 1.000001f : 1e38f;
        for (uint32_t m = bits(bound <= splat(limit)); m; m &= m - 1) {  // nearest last
            const int l = __builtin_ctz(m);
            const float key = order[l];
            int at = top++;
            for (; at > first && keys[at - 1 - first] < key; --at) {
                keys[at - first] = keys[at - 1 - first];
                stack[at] = stack[at - 1];
            }
            keys[at - first] = key;
            stack[at] = split_a ? Pair{static_cast<Ref>(lanes * ca + l), pair.b, bound[l]}
                                : Pair{pair.a, static_cast<Ref>(lanes * cb + l), bound[l]};
        }
    }
}

}  // namespace

Nearest nearest(const Shape& a, const Shape& b, const Rigid& pose, double bound, bool any) {
    Search q{a, b, pose, pair_frames(a, b, pose), bound, any};
    search(q);
    Nearest out{HUGE_VAL, {0, 0, 0}, {0, 0, 0}, q.face_a, q.face_b};
    if (q.face_a < 0) return out;
    Corners on_b = corners(b, q.face_b);
    for (Vec3& v : on_b.v) v = apply(pose, v);
    nearest_points(corners(a, q.face_a), on_b, out);
    return out;
}

}  // namespace fgenv::FGENV_ISA
