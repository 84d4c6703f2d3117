// Loops over pairs of bodies that may be in contact.
#pragma once

#include <algorithm>

#include "world/movers.h"

namespace fgenv {

// A part of a mover paired with a part of the same or a later mover, or with a body that belongs to no mover.
template <class Part>
struct CandidatePair {
    const Part* part;
    const Part* other_part;  // null for a body that belongs to no mover
    const Body* other;
    int32_t mover, other_mover;  // indices, or -1

    bool itself() const { return mover == other_mover; }
};

// Loop order for the pairs of a mover's parts with bodies that belong to no mover.
enum class PairOrder : uint8_t { by_part, by_body };

// Visits the pairs of parts of two movers with overlapping boxes. Stops and returns false when `visit` does.
template <class Mover, class Visit>
bool World::pairs_between(const Mover& a, int32_t index_a, const Mover& b, int32_t index_b, const Visit& visit) const {
    for (const auto& p : a.parts)
        for (const auto& q : b.parts)
            if (overlap(p.box, q.box) && !ignores(*p.body, *q.body) &&
                !visit(CandidatePair<typename Mover::Part>{&p, &q, q.body, index_a, index_b}))
                return false;
    return true;
}

// Visits the pairs of a mover's parts and bodies, except those of which `skips` is true; box_of(body) returns a box
// that encloses the body's motion.
template <class Mover, class Skips, class BoxOf, class Visit>
bool World::pairs_with_bodies(const Mover& mover, int32_t index, std::span<const BodyId> bodies, const Skips& skips,
                              PairOrder order, const BoxOf& box_of, const Visit& visit) const {
    using Pair = CandidatePair<typename Mover::Part>;
    if (order == PairOrder::by_body) {
        for (BodyId id : bodies) {
            const Body& other = body(id);
            if (skips(other)) continue;
            const Box& box = box_of(other);
            for (const auto& part : mover.parts)
                if (overlap(part.box, box) && !ignores(*part.body, other) &&
                    !visit(Pair{&part, nullptr, &other, index, -1}))
                    return false;
        }
        return true;
    }
    for (const auto& part : mover.parts)
        for (BodyId id : bodies) {
            const Body& other = body(id);
            if (!skips(other) && !ignores(*part.body, other) && overlap(part.box, box_of(other)) &&
                !visit(Pair{&part, nullptr, &other, index, -1}))
                return false;
        }
    return true;
}

// Visits, per mover, the pairs of its own parts, then its parts with bodies that belong to no mover, then with parts
// of later movers. `bodies` lists the bodies to test; null selects the mover's candidates.
template <class Mover, class BoxOf, class Visit>
bool World::for_each_pair(std::span<const Mover> movers, const std::vector<BodyId>* bodies, PairOrder order,
                          const BoxOf& box_of, const Visit& visit) const {
    std::vector<BodyId> found;
    const auto is_part = [&](const Body& b) {
        return !bodies &&
               std::any_of(movers.begin(), movers.end(), [&](const Mover& m) { return m.robot->id == b.root; });
    };
    for (int32_t m = 0; m < static_cast<int32_t>(movers.size()); ++m) {
        const Mover& mover = movers[m];
        for (const auto& [i, j] : mover.own_pairs())
            if (overlap(mover.own_box(i), mover.own_box(j)) &&
                !visit(
                    CandidatePair<typename Mover::Part>{&mover.parts[i], &mover.parts[j], mover.parts[j].body, m, m}))
                return false;
        if (!bodies) candidates(*mover.robot, mover.around, found);
        if (!pairs_with_bodies(mover, m, bodies ? *bodies : found, is_part, order, box_of, visit)) return false;
        for (int32_t k = m + 1; k < static_cast<int32_t>(movers.size()); ++k)
            if (overlap(mover.around, movers[k].around) && !pairs_between(mover, m, movers[k], k, visit)) return false;
    }
    return true;
}

// Collision test of a pair at one instant.
struct InstantTest {
    double time, margin, own_margin;  // seconds or `now`; meters
    bool lossless;
};

// Returns whether no pair of placed movers collides; otherwise stores the first colliding pair in `pair`. Counts
// tests in `checks`.
template <class Mover, class BoxOf>
bool World::free_of_contact(std::span<const Mover> movers, const std::vector<BodyId>* bodies, PairOrder order,
                            const BoxOf& box_of, const InstantTest& test, BodyPair& pair, int64_t& checks) const {
    return for_each_pair(movers, bodies, order, box_of, [&](const CandidatePair<PlacedPart>& p) {
        ++checks;
        const Body& a = *p.part->body;
        const Rigid pose = p.other_part ? p.other_part->pose : pose_of(*p.other, test.time);
        if (!hits(*a.shape, *p.other->shape, relative(p.part->pose, pose), p.itself() ? test.own_margin : test.margin,
                  test.lossless))
            return true;
        pair = {a.id, p.other->id};
        return false;
    });
}

}  // namespace fgenv
