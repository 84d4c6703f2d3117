// Distance of two surfaces: branch and bound over the two trees, faces four at a time in double.
#include "query/box_culling.h"
#include "query/face_culling.h"
#include "query/faces4.h"
#include "query/kernels.h"

namespace fgenv::FGENV_ISA {
namespace {

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

struct Corners {
    Vec3 v[3];
};

FGENV_INLINE Corners corners(const Shape& s, int32_t face) {
    const Face& f = s.mesh.faces[face];
    return {{s.mesh.vertices[f[0]], s.mesh.vertices[f[1]], s.mesh.vertices[f[2]]}};
}

FGENV_INLINE Vec3 lane(const V4 v, int k) { return {v[0][k], v[1][k], v[2][k]}; }

// The nearest points of two faces: three pairs of sides or three vertices at a time.
void nearest_points(const Corners& a, const Corners& b, Nearest& out) {
    out.squared = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
        Points rows[4];
        for (int l = 0; l < width; ++l) {
            const int j = l % 3;
            put(rows[0], l, a.v[i]);
            put(rows[1], l, a.v[(i + 1) % 3] - a.v[i]);
            put(rows[2], l, b.v[j]);
            put(rows[3], l, b.v[(j + 1) % 3] - b.v[j]);
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
    for (int side = 0; side < 2; ++side) {
        const Corners &from = side ? b : a, &to = side ? a : b;
        Points rows[4];
        for (int l = 0; l < width; ++l) {
            for (int k = 0; k < 3; ++k) put(rows[k], l, to.v[k]);
            put(rows[3], l, from.v[l % 3]);
        }
        Faces f;
        V4 p;
        for (int k = 0; k < 3; ++k) read(rows[k], f.v[k]);
        read(rows[3], p);
        derive(f);
        const D4 d = above_face(p, f);
        for (int l = 0; l < 3; ++l)
            if (d[l] < out.squared) {
                out.squared = d[l];
                const Vec3 n = lane(f.n, l), at = from.v[l];
                const Vec3 foot = at - (fgenv::dot(n, at - to.v[2]) * f.inv_n[l]) * n;
                (side ? out.on_b : out.on_a) = at;
                (side ? out.on_a : out.on_b) = foot;
            }
    }
}

// Squared lower bounds on the distance of `box` to a node's eight: in the frame of either box, the gaps
// to the upright box around the other; and the gap along `towards`, a unit vector from the node to the
// box. `order`: the distance of the centers breaks ties between boxes
// that overlap.
FGENV_INLINE F8 lower_bounds(const Oriented& n, const PlacedBox& box, const float towards[3], float slack, F8& order) {
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
    const F8 bound = max(max(here, there), apart * apart) * splat(0.9999f);  // a pose may be askew by 1e-5
    order = bound + (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * splat(1e-2f);
    return h[0] >= splat(0.0f) ? bound : splat(HUGE_VALF);
}

// Pairs of faces that may be nearest, measured four at once.
struct Candidates {
    Points a[3], b[3];  // vertices
    int32_t face_a[width], face_b[width];
    int count = 0;
};

struct Search {
    const Shape& a;
    const Shape& b;
    const Rigid& pose;
    PairFrames frames;
    double best;  // squared
    bool any;
    int32_t face_a = -1, face_b = -1;
    // Unit, a's frame, from a to b along the shortest way known: what is farther apart than that along
    // it cannot be nearer.
    float towards_b[3] = {0, 0, 0};
};

void turn(Search& q, Vec3 way) {
    const Vec3 n = unit(way);
    q.towards_b[0] = static_cast<float>(n.x);
    q.towards_b[1] = static_cast<float>(n.y);
    q.towards_b[2] = static_cast<float>(n.z);
}

// Ties go to the smaller faces, whichever the search meets first: rounding in the culls may change that.
bool is_better(const Search& q, double squared, int32_t face_a, int32_t face_b) {
    if (squared != q.best) return squared < q.best;
    if (q.face_a < 0) return q.any;
    return face_a != q.face_a ? face_a < q.face_a : face_b < q.face_b;
}

void measure(Search& q, Candidates& c) {
    if (!c.count) return;
    for (int l = c.count; l < width; ++l)  // spare lanes repeat the first pair
        for (int k = 0; k < 3; ++k) {
            put(c.a[k], l, point(c.a[k], 0));
            put(c.b[k], l, point(c.b[k], 0));
        }
    Faces a, b;
    for (int k = 0; k < 3; ++k) {
        read(c.a[k], a.v[k]);
        read(c.b[k], b.v[k]);
    }
    derive(a);
    derive(b);
    const D4 d = squared_distances(a, b);
    int best = -1;
    for (int l = 0; l < c.count; ++l)
        if (is_better(q, d[l], c.face_a[l], c.face_b[l])) {
            q.best = d[l];
            q.face_a = c.face_a[l];
            q.face_b = c.face_b[l];
            best = l;
        }
    if (best >= 0) {
        Nearest found;
        nearest_points({{point(c.a[0], best), point(c.a[1], best), point(c.a[2], best)}},
                       {{point(c.b[0], best), point(c.b[1], best), point(c.b[2], best)}}, found);
        turn(q, found.on_b - found.on_a);
    }
    c.count = 0;
}

void add_candidate(Search& q, Candidates& c, const Leaf& la, int i, const Leaf& lb, int j) {
    for (int k = 0; k < 3; ++k) {
        put(c.a[k], c.count, q.a.mesh.vertices[la.vertex[k][i]]);
        put(c.b[k], c.count, apply(q.pose, q.b.mesh.vertices[lb.vertex[k][j]]));
    }
    c.face_a[c.count] = la.face[i];
    c.face_b[c.count] = lb.face[j];
    if (++c.count == width) measure(q, c);
}

// At least the lengths of eight vectors, at most 1.16 times them, without squares that could vanish.
FGENV_INLINE F8 length_bound(const F8 (&v)[3]) {
    const F8 x = abs(v[0]), y = abs(v[1]), z = abs(v[2]);
    return splat(0.5f) * (x + y + z + max(max(x, y), z));
}

// Which of eight faces g may be nearer than `radius` to face i of f: boxes, then the two planes.
FGENV_INLINE uint32_t within(const FacesF& f, int i, const FacesF& g, const Local& local, float radius,
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

// The float above the root of the bound.
FGENV_INLINE float limit_of(const Search& q) {
    return q.best < 1e30 ? static_cast<float>(std::sqrt(q.best)) * 1.000001f : 1e15f;
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

void search_leaves(Search& q, const Leaf& la, const Leaf& lb) {
    FacesF a, b;
    float shift[3];
    const Local local = load_leaves(la, lb, q.pose, q.frames.b_in_a, a, b, shift);
    float limit = limit_of(q);
    if (q.face_a < 0) {
        const float known = std::sqrt(nearest_vertices(a, la.valid, b)) + 4 * local.slack;
        limit = known < limit ? known : limit;
    }
    float radius = limit + 4 * local.slack;

    float lo[3], hi[3];
    for (int i = 0; i < 3; ++i) {
        lo[i] = -la.half[i] - radius;
        hi[i] = la.half[i] + radius;
    }
    const F8 b_start = min(min(along(b.v[0], q.towards_b), along(b.v[1], q.towards_b)), along(b.v[2], q.towards_b));
    const F8 a_end = max(max(along(a.v[0], q.towards_b), along(a.v[1], q.towards_b)), along(a.v[2], q.towards_b));
    const uint32_t in_b = reaching(b, lo, hi, local, lb.valid);
    if (!in_b) return;
    around(b, in_b, lo, hi);
    for (int i = 0; i < 3; ++i) {
        lo[i] -= radius;
        hi[i] += radius;
    }
    Candidates candidates;
    for (uint32_t in_a = reaching(a, lo, hi, local, la.valid); in_a; in_a &= in_a - 1) {
        const int i = __builtin_ctz(in_a);
        const uint32_t ahead = in_b & bits(b_start <= splat(a_end[i] + radius));
        if (!ahead) continue;
        for (uint32_t m = within(a, i, b, local, radius, ahead); m; m &= m - 1)
            add_candidate(q, candidates, la, i, lb, __builtin_ctz(m));
        const float now = limit_of(q);
        if (now < limit) radius = (limit = now) + 4 * local.slack;
    }
    measure(q, candidates);
}

void search(Search& q) {
    struct Pair {
        Ref a, b;
        float bound;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    const Tree &ta = q.a.tree, &tb = q.b.tree;
    const OrientedBox *boxes_a = ta.boxes.data(), *boxes_b = tb.boxes.data();
    const PairFrame &b_in_a = q.frames.b_in_a, &a_in_b = q.frames.a_in_b;
    stack[top++] = {0, 0, 0.0f};
    while (top && q.best > 0 && !(q.any && q.face_a >= 0)) {
        const Pair pair = stack[--top];
        if (pair.bound > q.best) continue;
        const OrientedBox &a = boxes_a[pair.a], &b = boxes_b[pair.b];
        const int32_t ca = a.child, cb = b.child;
        if (ca < 0 && cb < 0) {
            search_leaves(q, ta.leaves[~ca], tb.leaves[~cb]);
            continue;
        }
        const bool split_a = cb < 0 || (ca >= 0 && size(a) >= size(b));
        F8 order;
        float towards[3];
        for (int i = 0; i < 3; ++i)
            towards[i] = split_a ? q.towards_b[i]
                                 : -(a_in_b.r[i][0] * q.towards_b[0] + a_in_b.r[i][1] * q.towards_b[1] +
                                     a_in_b.r[i][2] * q.towards_b[2]);
        const F8 bound = split_a ? lower_bounds(ta.oriented[ca], placed(b, b_in_a), towards, b_in_a.slack, order)
                                 : lower_bounds(tb.oriented[cb], placed(a, a_in_b), towards, a_in_b.slack, order);
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

FGENV_INLINE int least(F8 keys) {
    int at = 0;
    for (int k = 1; k < lanes; ++k)
        if (keys[k] < keys[at]) at = k;
    return at;
}

// A vertex near p: always on to the nearest box, none left for later.
Vec3 near_vertex(const Shape& s, Vec3 p) {
    const float at[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    int32_t child = s.tree.nodes[0].child[0];
    while (child >= 0) {
        const Node& n = s.tree.nodes[child];
        F8 key = F8{};
        for (int i = 0; i < 3; ++i) {
            const F8 d = abs(load(n.center[i]) - splat(at[i])), gap = max(d - load(n.half[i]), F8{});
            key += gap * gap + splat(1e-2f) * d * d;  // the centers', where p is within several
        }
        child = n.child[least(load(n.half[0]) >= F8{} ? key : splat(HUGE_VALF))];
    }
    const Leaf& leaf = s.tree.leaves[~child];
    F8 best = splat(HUGE_VALF);
    I8 corner = I8{};
    for (int k = 0; k < 3; ++k) {
        F8 squared = F8{};
        for (int i = 0; i < 3; ++i) {
            const F8 d = load(leaf.v[k][i]) - splat(at[i] - leaf.center[i]);
            squared += d * d;
        }
        corner = squared < best ? I8{} + k : corner;
        best = min(best, squared);
    }
    const int lane = least(best);
    return s.mesh.vertices[leaf.vertex[corner[lane]][lane]];
}

// A first bound and a first way: to and fro between vertices near each other.
void approach(Search& q) {
    const Rigid a_in_b = inverse(q.pose);
    const BoxF from = box_of(q.a.tree, 0);
    Vec3 on_a{from.c[0], from.c[1], from.c[2]};
    for (int i = 0; i < 8; ++i) {
        const Vec3 on_b = apply(q.pose, near_vertex(q.b, apply(a_in_b, on_a)));
        on_a = near_vertex(q.a, on_b);
        const double squared = dot(on_b - on_a, on_b - on_a) * 1.000001;
        if (!(squared < q.best)) return;
        q.best = squared;
        turn(q, on_b - on_a);
    }
}

}  // namespace

Nearest nearest_faces(const Vec3 a[3], const Vec3 b[3]) {
    Nearest out{HUGE_VAL, {0, 0, 0}, {0, 0, 0}, -1, -1};
    nearest_points({{a[0], a[1], a[2]}}, {{b[0], b[1], b[2]}}, out);
    return out;
}

Nearest nearest(const Shape& a, const Shape& b, const Rigid& pose, double bound, bool any) {
    Search q{a, b, pose, pair_frames(a, b, pose), bound, any};
    const BoxF start = placed(box_of(b.tree, 0), q.frames.b_in_a), from = box_of(a.tree, 0);
    turn(q, {double(start.c[0]) - from.c[0], double(start.c[1]) - from.c[1], double(start.c[2]) - from.c[2]});
    if (!any) approach(q);
    search(q);
    if (q.face_a < 0 && q.best < bound) {  // where rounding is all there is, the first bound may be too low
        q.best = bound;
        search(q);
    }
    Nearest out{HUGE_VAL, {0, 0, 0}, {0, 0, 0}, q.face_a, q.face_b};
    if (q.face_a < 0) return out;
    Corners on_b = corners(b, q.face_b);
    for (Vec3& v : on_b.v) v = apply(pose, v);
    nearest_points(corners(a, q.face_a), on_b, out);
    return out;
}

}  // namespace fgenv::FGENV_ISA
