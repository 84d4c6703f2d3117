// Finds the pairs of faces that may come close while two shapes move: dual descent with boxes that are swept
// along their velocities, then faces.
#include "math/rotation.h"
#include "motion/swept_faces.h"
#include "query/descent.h"

namespace fgenv::FGENV_ISA {
namespace {

struct SweepSearch {
    struct Pair {
        Ref a, b;
    };
    using Children = Unordered;
    static constexpr Order order = Order::any;

    const Shape &a, &b;
    const Sweep& sweep;
    const SweptView &from_a, &from_b;
    FoundPairs found;
    int opened = 0;

    Pair pair(Ref ref_a, Ref ref_b, const Children&, int) const { return {ref_a, ref_b}; }
    bool stop() {
        if (!found.full() && opened++ == sweep.budget) found.count = found.capacity + 1;
        return found.full();
    }
    bool prune(const Pair&) const { return false; }
    bool prune(const OrientedBox&, const OrientedBox&) const { return false; }
    Children open(const Oriented& node, const OrientedBox& box, const SweptView& view) const {
        return {overlapping(node, posed(box, view.frame), view)};
    }
    void leaves(const OrientedBox& box_a, const OrientedBox& box_b) {
        find_pairs(sweep.pose, from_a, a.tree.leaves[~box_a.child], b.tree.leaves[~box_b.child], found);
    }
};

}  // namespace

int sweep(const Shape& a, const Shape& b, const Sweep& s, FacePair* out, int capacity) {
    const PairFrames frames = pair_frames(a, b, s.pose);
    const float pad = static_cast<float>(s.margin) * 1.00001f + frames.b_in_a.slack * 2;
    const Rigid back = inverse(s.pose);
    const SweptView from_a{frames.b_in_a, side_motion(s.a, s.a.v, s.a.w, {0, 0, 0}),
                           side_motion(s.b, s.b.v, s.b.w, origin(s.pose)), pad};
    const SweptView from_b{frames.a_in_b, side_motion(s.b, rotate(back, s.b.v), rotate(back, s.b.w), {0, 0, 0}),
                           side_motion(s.a, rotate(back, s.a.v), rotate(back, s.a.w), origin(back)), pad};
    if (!overlapping(a.tree.oriented[0], posed(b.tree.boxes[0], from_a.frame), from_a)) return 0;
    SweepSearch search{a, b, s, from_a, from_b, {out, 0, capacity}};
    descend(a.tree, b.tree, search);
    return search.found.count;
}

}  // namespace fgenv::FGENV_ISA
