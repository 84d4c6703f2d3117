// Boolean query: dual descent with oriented culling, then edges against faces, then containment.
#include "query/containment.h"
#include "query/descent.h"
#include "query/leaf_collision.h"

namespace fgenv::FGENV_ISA {

int32_t segment(const Shape& shape, Vec3 p, Vec3 q);

namespace {

// By the spheres around the boxes. In double: squares of the smallest bodies are no floats.
bool far_apart(const OrientedBox& a, const OrientedBox& b, const PairFrame& b_in_a) {
    const F4 center = turned(b_in_a.columns, b.center, b_in_a.shift);
    double squared = 0, of_a = 0, of_b = 0;
    for (int i = 0; i < 3; ++i) {
        const double d = double(center[i]) - a.center[i];
        squared += d * d;
        of_a += double(a.half[i]) * a.half[i];
        of_b += double(b.half[i]) * b.half[i];
    }
    const double reach = std::sqrt(of_a) + std::sqrt(of_b) + 2 * b_in_a.slack;
    return squared > reach * reach;
}

// Stops at the first pair of leaves with a collision.
struct CollisionSearch {
    struct Pair {
        Ref a, b;
    };
    using Children = Ordered;
    static constexpr Order order = Order::least_key_first;  // where centers are close a hit is likeliest

    const Query& q;
    const PairFrame &from_a = q.frames.b_in_a, &from_b = q.frames.a_in_b;
    bool hit = false;

    Pair pair(Ref a, Ref b, const Children&, int) const { return {a, b}; }
    bool stop() const { return hit; }
    bool prune(const Pair&) const { return false; }
    bool prune(const OrientedBox& a, const OrientedBox& b) const {
        return (a.child < 0 && size(a) > size(b) && !reaches(leaf_a(a), posed(b, from_a), from_a.slack)) ||
               (b.child < 0 && size(b) > size(a) && !reaches(leaf_b(b), posed(a, from_b), from_b.slack));
    }
    Children open(const Oriented& node, const OrientedBox& box, const PairFrame& frame) const {
        Children out;
        out.mask = overlapping(node, posed(box, frame), frame.slack, out.key);
        return out;
    }
    void leaves(const OrientedBox& a, const OrientedBox& b) {
        hit = leaves_meet(q, leaf_a(a), posed(a, from_b), leaf_b(b), posed(b, from_a));
    }
    const Leaf& leaf_a(const OrientedBox& box) const { return q.a.tree.leaves[~box.child]; }
    const Leaf& leaf_b(const OrientedBox& box) const { return q.b.tree.leaves[~box.child]; }
};

bool surfaces_meet(const Query& q) {
    CollisionSearch search{q};
    descend(q.a.tree, q.b.tree, search);
    return search.hit;
}

// The published form: the mover's head-to-tail chords against the target's faces.
bool chords_meet(const Shape& a, const Shape& b, const Rigid& pose, Witness* witness) {
    const Rigid a_in_b = inverse(pose);
    for (size_t i = 0; i < a.graph.edges.size(); ++i) {
        const Vec3 p = a.mesh.vertices[a.graph.points[a.graph.edges[i][0]]];
        const Vec3 q = a.mesh.vertices[a.graph.points[a.graph.edges[i][1]]];
        const int32_t face = segment(b, apply(a_in_b, p), apply(a_in_b, q));
        if (face < 0) continue;
        if (witness) *witness = {Witness::chord_of_a, -1, face, static_cast<int32_t>(i), {0, 0, 0}};
        return true;
    }
    return false;
}

}  // namespace

bool collide(const Shape& a, const Shape& b, const Rigid& pose, bool lossless, Witness* witness) {
    if (!lossless && (a.graph.settings.method == Method::loop || b.graph.settings.method == Method::loop))
        return chords_meet(a, b, pose, witness);
    const Query query{a, b, pose, pair_frames(a, b, pose), lossless ? 3 : 0, witness};
    const PairFrame& frame = query.frames.b_in_a;
    if (far_apart(a.tree.boxes[0], b.tree.boxes[0], frame)) return false;
    if (surfaces_meet(query)) return true;
    Vec3 point;
    Witness::Side side = Witness::none;
    if (contained(b, a, pose, frame, query.frames.a_in_b, point))
        side = Witness::b_inside_a;
    else if (contained(a, b, inverse(pose), query.frames.a_in_b, frame, point))
        side = Witness::a_inside_b;
    if (side == Witness::none) return false;
    if (witness) *witness = {side, -1, -1, -1, point};
    return true;
}

}  // namespace fgenv::FGENV_ISA
