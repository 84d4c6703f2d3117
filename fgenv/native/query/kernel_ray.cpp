// Rays, segments and winding numbers on the tree of one shape.
#include "math/lanes.h"
#include "query/descent.h"
#include "query/edge_face.h"
#include "query/kernels.h"

namespace fgenv::FGENV_ISA {
namespace {

// Which boxes of a node a segment o + s d, 0 <= s <= reach, may pass; entry distances for the order.
FGENV_INLINE uint32_t boxes_on_ray(const Node& n, const double o[3], const double inv[3], double reach, F8& entry) {
    // Floats with outward slack: the entry is rounded down and the exit up by more than the error of
    // the subtraction and the product, relative to the numbers that enter.
    F8 near = splat(0.0f), far = splat(static_cast<float>(reach) * 1.000001f);
    for (int i = 0; i < 3; ++i) {
        const F8 h = load(n.half[i]);
        const F8 c = load(n.center[i]);
        const F8 origin = splat(static_cast<float>(o[i]));
        const F8 slack = (abs(c) + abs(origin) + abs(h)) * splat(0x1p-21f);
        const F8 wide = h + slack;
        const F8 inverse = splat(static_cast<float>(inv[i]));
        const F8 middle = (c - origin) * inverse;
        const F8 spread = wide * abs(inverse);
        const F8 rounding = (abs(middle) + abs(spread)) * splat(0x1p-21f);
        near = max(near, middle - spread - rounding);
        far = min(far, middle + spread + rounding);
    }
    entry = near;
    const I8 real = load(n.half[0]) >= splat(0.0f);
    return bits((near <= far) & real);
}

struct Ray {
    double o[3], d[3], inv[3];
};

Ray make_ray(Vec3 o, Vec3 d) {
    Ray ray{{o.x, o.y, o.z}, {d.x, d.y, d.z}, {}};
    for (int i = 0; i < 3; ++i) {
        // Parallel to the slab: a huge slope separates inside from outside without 0 * infinity.
        const double safe = std::fabs(ray.d[i]) > 1e-18 ? ray.d[i] : std::copysign(1e-18, ray.d[i]);
        ray.inv[i] = 1.0 / safe;
    }
    return ray;
}

// A face's corners from a ray's origin, sheared so that the ray runs along an axis (S. Woop et al., "Watertight
// ray/triangle intersection", 2013): each once and alike for every face that has it.
struct ShearedFace {
    double p[3][2], depth[3];   // across and along the ray
    double size[3], offset[3];  // of each corner: the sums of its coordinates from the origin, and across the ray
    bool forward;               // the axis and the ray have the same sign
};

FGENV_INLINE ShearedFace sheared(Vec3 o, Vec3 d, const Vec3 f[3]) {
    const double x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    const int along = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const int right = (along + 1) % 3, up = (along + 2) % 3;
    const double scale = 1.0 / coordinate(d, along);
    ShearedFace out;
    out.forward = scale > 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3 v = f[k] - o;
        out.depth[k] = scale * coordinate(v, along);
        out.p[k][0] = coordinate(v, right) - coordinate(d, right) * out.depth[k];
        out.p[k][1] = coordinate(v, up) - coordinate(d, up) * out.depth[k];
        out.size[k] = std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
        out.offset[k] = std::fabs(out.p[k][0]) + std::fabs(out.p[k][1]);
    }
    return out;
}

// Exact side on which the ray passes the edge from corner k to l; `area`: twice that of the edge and the ray, sheared.
// A coordinate across the ray has an error of at most 6 units of 2^-53 of the corner's size.
FGENV_INLINE int side_of_edge(const ShearedFace& s, int k, int l, double area, Vec3 o, Vec3 d, const Vec3 f[3]) {
    const double bound =
        0x1p-49 * (s.size[k] * s.offset[l] + s.size[l] * s.offset[k] + 0x1p-49 * s.size[k] * s.size[l]);
    if (area > bound) return 1;
    if (area < -bound) return -1;
    const int side = orient_line_exact(d, f[k], f[l], o);
    return s.forward ? side : -side;
}

// Depth at which the ray passes nearest to a side of a face that it sees almost edge-on.
double depth_at_sides(const ShearedFace& s) {
    double nearest = HUGE_VAL, depth = 0;
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const double u[2] = {s.p[l][0] - s.p[k][0], s.p[l][1] - s.p[k][1]};
        const double length = u[0] * u[0] + u[1] * u[1];
        const double at = length > 0 ? -(s.p[k][0] * u[0] + s.p[k][1] * u[1]) / length : 0;
        const double t = lesser(greater(at, 0), 1), x = s.p[k][0] + t * u[0], y = s.p[k][1] + t * u[1];
        const double squared = x * x + y * y;
        if (squared >= nearest) continue;
        nearest = squared;
        depth = s.depth[k] + t * (s.depth[l] - s.depth[k]);
    }
    return depth;
}

// Where the ray meets the closed face, its corners and sides included; negative if nowhere. The sides are decided
// exactly. A face whose plane holds the ray is not met: the ray meets its sides in the neighboring faces.
double ray_meets_face(Vec3 o, Vec3 d, const Vec3 f[3]) {
    const ShearedFace s = sheared(o, d, f);
    double sum = 0, weighted = 0, noise = 0;
    int positive = 0, negative = 0;
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const double ahead = s.p[k][0] * s.p[l][1], behind = s.p[k][1] * s.p[l][0], area = ahead - behind;
        const int side = side_of_edge(s, k, l, area, o, d, f);
        positive += side > 0;
        negative += side < 0;
        sum += area;
        noise += s.size[k] * s.offset[l] + s.size[l] * s.offset[k];  // times 2^-49: error of the area
        weighted += area * s.depth[(k + 2) % 3];
    }
    if ((positive && negative) || (!positive && !negative)) return -1;
    const double depths = std::fabs(s.depth[0]) + std::fabs(s.depth[1]) + std::fabs(s.depth[2]);
    const double at = std::fabs(sum) <= 0x1p-26 * noise ? depth_at_sides(s) : weighted / sum;
    if (at > 1e-10 * depths) return at;
    if (at < -1e-10 * depths) return -1;
    // Near the plane: on which side of it the ray begins is decided exactly; on it, the distance is 0.
    const int below = orient3d(f[0], f[1], f[2], o), leaves = (positive > 0) == s.forward ? 1 : -1;
    return below * leaves < 0 ? -1 : below == 0 ? 0 : greater(at, 0);
}

// x rounded to float, and beyond what rounding a vertex of about the same size can do.
float below(double x) {
    const float f = static_cast<float>(x);
    return f - std::fabs(f) * 0x1p-22f;
}
float above(double x) {
    const float f = static_cast<float>(x);
    return f + std::fabs(f) * 0x1p-22f;
}

// Faces of a leaf with a box that overlaps [lo, hi].
FGENV_INLINE uint32_t faces_near_bounds(const Leaf& leaf, const double lo[3], const double hi[3]) {
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i) {
        const F8 a = load(leaf.v[0][i]), b = load(leaf.v[1][i]), c = load(leaf.v[2][i]);
        meet &= (min(min(a, b), c) <= splat(above(hi[i] - leaf.center[i]))) &
                (max(max(a, b), c) >= splat(below(lo[i] - leaf.center[i])));
    }
    return leaf.valid & bits(meet);
}

// Faces of a leaf that the ray may meet: signs of the three side volumes in floats, with slack.
FGENV_INLINE uint32_t faces_near_ray(const Leaf& leaf, const Ray& ray) {
    F8 p[3][3], size = F8{};
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
            const F8 o = splat(static_cast<float>(ray.o[i] - leaf.center[i]));
            p[k][i] = load(leaf.v[k][i]) - o;
            size = max(size, abs(load(leaf.v[k][i])) + abs(o));
        }
    F8 d[3], length = F8{};
    for (int i = 0; i < 3; ++i) {
        d[i] = splat(static_cast<float>(ray.d[i]));
        length += abs(d[i]);
    }
    const F8 slack = size * size * length * splat(64 * 0x1p-24f);
    F8 lo = splat(1e30f), hi = splat(-1e30f);
    for (int k = 0; k < 3; ++k) {
        const F8 *u = p[(k + 2) % 3], *w = p[(k + 1) % 3];
        const F8 volume = d[0] * (u[1] * w[2] - u[2] * w[1]) + d[1] * (u[2] * w[0] - u[0] * w[2]) +
                          d[2] * (u[0] * w[1] - u[1] * w[0]);
        lo = min(lo, volume);
        hi = max(hi, volume);
    }
    return leaf.valid & bits((lo >= -slack) | (hi <= slack));
}

FGENV_INLINE void load_face(const Shape& s, const Leaf& leaf, int lane, Vec3 out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = s.mesh.vertices[leaf.vertex[k][lane]];
}

// Crossing of the ray p + s x, s >= 0, with a face seen along x (y to the right, z up): +1 where the
// ray leaves through it, -1 where it enters, 0 where it passes. Sides are half open in z, so that
// faces that share an edge share the decision.
int crossing(Vec3 p, const Vec3 f[3], bool& touching) {
    const double at[2] = {p.y, p.z};
    int turns = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3 a = f[k], b = f[(k + 1) % 3];
        if ((a.z <= p.z) == (b.z <= p.z)) continue;
        const double a2[2] = {a.y, a.z}, b2[2] = {b.y, b.z};
        const int side = orient2d(a2, b2, at);
        if (a.z <= p.z && side > 0) ++turns;
        if (b.z <= p.z && side < 0) --turns;
    }
    const int ahead = orient3d(f[0], f[1], f[2], p);  // > 0: p is below the plane
    if (ahead == 0) {
        // On the plane: on the face, or (seen edge-on) beside it.
        if (edge_meets_face(p, 0, p, 0, f)) touching = true;
        return 0;
    }
    // turns > 0: the normal has a positive x, so the ray leaves if p is below the plane.
    if (turns > 0) return ahead > 0 ? 1 : 0;
    if (turns < 0) return ahead < 0 ? -1 : 0;
    return 0;
}

struct TreePlace {
    int32_t child;
};

// The first hit along a ray; with `any` = true whichever is met first by the search.
template <bool any>
struct RaySearch {
    struct Entry {
        int32_t child;
        float near;
    };
    using Children = Ordered;
    static constexpr Order order = Order::rising_keys;

    const Shape& shape;
    Vec3 o, d;
    double reach;
    Ray ray = make_ray(o, d);
    RayHit hit{HUGE_VAL, -1};

    Entry entry(int32_t child, const Children& children, int lane) const { return {child, children.key[lane]}; }
    bool stop() const { return any && hit.face >= 0; }
    bool prune(const Entry& e) const { return e.near > reach; }
    Children open(const Node& node) const {
        Children out;
        out.mask = boxes_on_ray(node, ray.o, ray.inv, reach, out.key);
        return out;
    }
    void leaf(const Leaf& leaf) {
        for (uint32_t m = faces_near_ray(leaf, ray); m; m &= m - 1) {
            const int lane = __builtin_ctz(m);
            const int32_t face = leaf.face[lane];
            Vec3 f[3];
            load_face(shape, leaf, lane, f);
            const double at = ray_meets_face(o, d, f);
            if (at < 0 || at > reach || (at == hit.distance && face >= hit.face)) continue;
            reach = at;
            hit = {at, face};
            if (any) return;
        }
    }
};

template <bool any>
FGENV_INLINE RayHit cast(const Shape& s, Vec3 o, Vec3 d, double max_distance) {
    RaySearch<any> search{s, o, d, max_distance};
    descend(s.tree, search);
    return search.hit;
}

// Any face that the segment pq meets.
struct SegmentSearch {
    using Entry = TreePlace;
    using Children = Unordered;
    static constexpr Order order = Order::any;

    const Shape& shape;
    Vec3 p, q;
    Ray ray = make_ray(p, q - p);
    double lo[3] = {}, hi[3] = {};
    int32_t face = -1;

    Entry entry(int32_t child, const Children&, int) const { return {child}; }
    bool stop() const { return face >= 0; }
    bool prune(const Entry&) const { return false; }
    Children open(const Node& node) const {
        F8 entry_distance;
        return {boxes_on_ray(node, ray.o, ray.inv, 1.0, entry_distance)};
    }
    void leaf(const Leaf& leaf) {
        for (uint32_t m = faces_near_bounds(leaf, lo, hi); m; m &= m - 1) {
            const int lane = __builtin_ctz(m);
            Vec3 f[3];
            load_face(shape, leaf, lane, f);
            const int side_p = orient3d(f[0], f[1], f[2], p), side_q = orient3d(f[0], f[1], f[2], q);
            if (side_p == 0 && side_q == 0) continue;  // within the plane: no hit, as published
            if (!edge_meets_face(p, side_p, q, side_q, f)) continue;
            face = leaf.face[lane];
            return;
        }
    }
};

// Sums the crossings of the ray from p along x with the closed shells.
struct WindingSum {
    using Entry = TreePlace;
    using Children = Unordered;
    static constexpr Order order = Order::any;

    const Shape& shape;
    Vec3 p;
    double lo[3] = {p.x, p.y, p.z}, hi[3] = {1e30, p.y, p.z};
    int number = 0;
    bool touching = false;

    Entry entry(int32_t child, const Children&, int) const { return {child}; }
    bool stop() const { return false; }
    bool prune(const Entry&) const { return false; }
    Children open(const Node& node) const {
        I8 meet = I8{} == 0;
        for (int i = 0; i < 3; ++i) {
            const F8 c = load(node.center[i]), h = load(node.half[i]) * splat(1.000001f);
            const F8 slack = abs(c) * splat(0x1p-22f);
            meet &= (c - h - slack <= splat(above(hi[i]))) & (c + h + slack >= splat(below(lo[i])));
        }
        return {bits(meet)};
    }
    void leaf(const Leaf& leaf) {
        for (uint32_t m = faces_near_bounds(leaf, lo, hi); m; m &= m - 1) {
            const int lane = __builtin_ctz(m);
            if (!leaf.bounds[lane]) continue;
            Vec3 f[3];
            load_face(shape, leaf, lane, f);
            number += crossing(p, f, touching);
        }
    }
};

}  // namespace

RayHit raycast(const Shape& s, Vec3 o, Vec3 d, double max_distance) { return cast<false>(s, o, d, max_distance); }

bool obstructed(const Shape& s, Vec3 o, Vec3 d) { return cast<true>(s, o, d, HUGE_VAL).face >= 0; }

int32_t segment(const Shape& s, Vec3 p, Vec3 q) {
    SegmentSearch search{s, p, q};
    for (int i = 0; i < 3; ++i) {
        search.lo[i] = lesser(coordinate(p, i), coordinate(q, i));
        search.hi[i] = greater(coordinate(p, i), coordinate(q, i));
    }
    descend(s.tree, search);
    return search.face;
}

int winding(const Shape& s, Vec3 p, bool& touching) {
    touching = false;
    if (!inside(s.mesh.bounds, p)) return 0;
    WindingSum sum{s, p};
    descend(s.tree, sum);
    touching = sum.touching;
    return sum.number;
}

}  // namespace fgenv::FGENV_ISA
