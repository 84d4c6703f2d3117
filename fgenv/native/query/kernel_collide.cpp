// Boolean query: dual descent with oriented culling, then edges against faces, then containment.
#include "query/box_culling.h"
#include "query/containment.h"
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

bool surfaces_meet(const Query& q) {
    struct Pair {
        Ref a, b;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    const Tree &ta = q.a.tree, &tb = q.b.tree;
    const OrientedBox *boxes_a = ta.boxes.data(), *boxes_b = tb.boxes.data();
    const PairFrame &b_in_a = q.frames.b_in_a, &a_in_b = q.frames.a_in_b;
    F8 centers;
    stack[top++] = {0, 0};
    while (top) {
        const Pair pair = stack[--top];
        const OrientedBox &a = boxes_a[pair.a], &b = boxes_b[pair.b];
        const int32_t ca = a.child, cb = b.child;
        if (ca < 0 && cb < 0) {
            if (leaves_meet(q, ta.leaves[~ca], placed(a, a_in_b), tb.leaves[~cb], placed(b, b_in_a))) return true;
            continue;
        }
        if (ca < 0 && size(a) > size(b) && !reaches(ta.leaves[~ca], placed(b, b_in_a), b_in_a.slack)) continue;
        if (cb < 0 && size(b) > size(a) && !reaches(tb.leaves[~cb], placed(a, a_in_b), a_in_b.slack)) continue;
        const bool split_a = cb < 0 || (ca >= 0 && size(a) >= size(b));
        uint32_t m = split_a ? meeting(ta.oriented[ca], placed(b, b_in_a), b_in_a.slack, centers)
                             : meeting(tb.oriented[cb], placed(a, a_in_b), a_in_b.slack, centers);
        // The nearest comes first off the stack: that is where a hit is likeliest.
        for (float nearest = HUGE_VALF; m; m &= m - 1) {
            const int k = __builtin_ctz(m);
            stack[top] = split_a ? Pair{static_cast<Ref>(lanes * ca + k), pair.b}
                                 : Pair{pair.a, static_cast<Ref>(lanes * cb + k)};
            __builtin_prefetch(split_a ? &boxes_a[stack[top].a] : &boxes_b[stack[top].b]);
            if (centers[k] < nearest)
                nearest = centers[k];
            else {
                const Pair last = stack[top];
                stack[top] = stack[top - 1];
                stack[top - 1] = last;
            }
            ++top;
        }
    }
    return false;
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
