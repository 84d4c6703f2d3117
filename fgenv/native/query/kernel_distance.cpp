// Distance of two surfaces: branch and bound over the two trees, faces four at a time in double.
#include "query/descent.h"
#include "query/distance_bounds.h"
#include "query/face_distance.h"
#include "query/tree_heights.h"

namespace fgenv::FGENV_ISA {
namespace {

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
    // Unit vector in a's frame, from a to b along the shortest segment known: faces that are farther apart along
    // it cannot be nearer.
    float towards_b[3] = {0, 0, 0};
    float towards_a[3] = {0, 0, 0};  // the opposite in b's frame
    Vec3 way{0, 0, 0};               // as towards_b, in double
};

void set_direction(Search& q, Vec3 way) {
    const Vec3 n = unit(way);
    q.way = n;
    q.towards_b[0] = static_cast<float>(n.x);
    q.towards_b[1] = static_cast<float>(n.y);
    q.towards_b[2] = static_cast<float>(n.z);
    const auto& r = q.frames.a_in_b.r;
    for (int i = 0; i < 3; ++i)
        q.towards_a[i] = -(r[i][0] * q.towards_b[0] + r[i][1] * q.towards_b[1] + r[i][2] * q.towards_b[2]);
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
        nearest_points({point(c.a[0], best), point(c.a[1], best), point(c.a[2], best)},
                       {point(c.b[0], best), point(c.b[1], best), point(c.b[2], best)}, found);
        set_direction(q, found.on_b - found.on_a);
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

// The float above the root of the bound.
FGENV_INLINE float limit_of(const Search& q) {
    return q.best < 1e30 ? static_cast<float>(std::sqrt(q.best)) * 1.000001f : 1e15f;
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
    const uint32_t in_b = faces_near_box(b, lo, hi, local, lb.valid);
    if (!in_b) return;
    bounds_of(b, in_b, lo, hi);
    for (int i = 0; i < 3; ++i) {
        lo[i] -= radius;
        hi[i] += radius;
    }
    Candidates candidates;
    for (uint32_t in_a = faces_near_box(a, lo, hi, local, la.valid); in_a; in_a &= in_a - 1) {
        const int i = __builtin_ctz(in_a);
        const uint32_t ahead = in_b & bits(b_start <= splat(a_end[i] + radius));
        if (!ahead) continue;
        for (uint32_t m = faces_within(a, i, b, local, radius, ahead); m; m &= m - 1)
            add_candidate(q, candidates, la, i, lb, __builtin_ctz(m));
        const float now = limit_of(q);
        if (now < limit) radius = (limit = now) + 4 * local.slack;
    }
    measure(q, candidates);
}

// Branch and bound: pairs of boxes by rising bounds, until no bound is below the best distance.
struct DistanceSearch {
    struct Pair {
        Ref a, b;
        float bound;
    };
    struct Viewpoint {
        const PairFrame& frame;
        const float (&towards)[3];
    };
    struct Children {
        uint32_t mask;
        F8 key, bound;
    };
    static constexpr Order order = Order::rising_keys;

    Search& q;
    Viewpoint from_a{q.frames.b_in_a, q.towards_b}, from_b{q.frames.a_in_b, q.towards_a};
    // Float bounds do not separate faces that nearly coincide: after more leaves than other shapes need, heights along
    // the shortest segment do. They are measured again each time that the number of leaves doubles.
    TreeHeights* heights = nullptr;
    size_t opened = 0, next = 64 + 8 * (q.a.tree.leaves.size() + q.b.tree.leaves.size());

    Pair pair(Ref a, Ref b, const Children& children, int lane) const { return {a, b, children.bound[lane]}; }
    bool stop() const { return !(q.best > 0) || (q.any && q.face_a >= 0); }
    bool prune(const Pair& pair) const {
        return pair.bound > q.best || (heights && apart(*heights, pair.a, pair.b, q.best));
    }
    bool prune(const OrientedBox&, const OrientedBox&) const { return false; }
    Children open(const Oriented& node, const OrientedBox& box, const Viewpoint& view) const {
        Children out;
        out.bound = lower_bounds(node, posed(box, view.frame), view.towards, view.frame.slack, out.key);
        const float limit = q.best < 1e38 ? static_cast<float>(q.best) * 1.000001f : 1e38f;
        out.mask = bits(out.bound <= splat(limit));
        return out;
    }
    void leaves(const OrientedBox& a, const OrientedBox& b) {
        if (++opened == next) {
            next *= 2;
            if (!heights) heights = new_heights(q.a, q.b, q.pose);
            measure(*heights, q.way);
        }
        search_leaves(q, q.a.tree.leaves[~a.child], q.b.tree.leaves[~b.child]);
    }
};

void search(Search& q) {
    DistanceSearch search{q};
    descend(q.a.tree, q.b.tree, search);
    if (search.heights) free_heights(search.heights);
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
void find_first_bound(Search& q) {
    const Rigid a_in_b = inverse(q.pose);
    const BoxF from = box_of(q.a.tree, 0);
    Vec3 on_a{from.c[0], from.c[1], from.c[2]};
    for (int i = 0; i < 8; ++i) {
        const Vec3 on_b = apply(q.pose, near_vertex(q.b, apply(a_in_b, on_a)));
        on_a = near_vertex(q.a, on_b);
        const double squared = dot(on_b - on_a, on_b - on_a) * 1.000001;
        if (!(squared < q.best)) return;
        q.best = squared;
        set_direction(q, on_b - on_a);
    }
}

}  // namespace

Nearest nearest_faces(const Vec3 a[3], const Vec3 b[3]) {
    Nearest out{HUGE_VAL, {0, 0, 0}, {0, 0, 0}, -1, -1};
    nearest_points({a[0], a[1], a[2]}, {b[0], b[1], b[2]}, out);
    return out;
}

Nearest nearest(const Shape& a, const Shape& b, const Rigid& pose, double bound, bool any) {
    Search q{a, b, pose, pair_frames(a, b, pose), bound, any};
    const BoxF start = posed(box_of(b.tree, 0), q.frames.b_in_a), from = box_of(a.tree, 0);
    set_direction(q, {double(start.c[0]) - from.c[0], double(start.c[1]) - from.c[1], double(start.c[2]) - from.c[2]});
    if (!any) find_first_bound(q);
    search(q);
    if (q.face_a < 0 && q.best < bound) {  // where rounding is all there is, the first bound may be too low
        q.best = bound;
        search(q);
    }
    Nearest out{HUGE_VAL, {0, 0, 0}, {0, 0, 0}, q.face_a, q.face_b};
    if (q.face_a < 0) return out;
    Triangle on_b = triangle(b.mesh, q.face_b);
    for (Vec3& v : on_b) v = apply(pose, v);
    nearest_points(triangle(a.mesh, q.face_a), on_b, out);
    return out;
}

}  // namespace fgenv::FGENV_ISA
