// Queries at one instant: collision, clearance, rays, all pairs.
#include <algorithm>

#include "world/box_walk.h"
#include "world/pair_loop.h"

namespace fgenv {
namespace {

// Float above a squared distance.
float float_bound(double squared) { return squared < 1e30 ? rounded_up(squared) * 1.00001f + 1e-30f : 1e30f; }

constexpr Box everywhere{{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};

}  // namespace

Rigid World::pose_of(const Body& b, double time) const {
    const Body& root = body(b.root);
    if (std::isnan(time) || !root.trajectory) return b.pose;
    const Robot* robot = root.robot.get();
    const Trajectory::Leg leg = root.trajectory->leg(time);
    const Frames frames =
        frames_at(robot, leg.length > 0 ? between(robot, leg.from, leg.to, (time - leg.begin) / leg.length) : leg.from);
    return b.in(frames);
}

Box World::box_of(const Body& b, double time) const {
    return std::isnan(time) || !body(b.root).trajectory ? b.box : posed_box(*b.shape, pose_of(b, time));
}

bool World::collides(BodyId id, const Place& place, double time, double margin) const {
    const PlacedMover mover = placed(body(id), place, margin);
    int64_t checks = 0;
    BodyPair pair;
    const bool free = free_of_contact(
        std::span<const PlacedMover>(&mover, 1), nullptr, PairOrder::by_body,
        [&](const Body& other) { return masks_ == Masks::path ? box_of(other, time) : everywhere; },
        {time, margin, margin, false}, pair, checks);
    tests_.fetch_add(checks, std::memory_order_relaxed);
    return !free;
}

Clearance World::clearance(const std::vector<BodyId>& robots, const std::vector<Place>& places, double time) const {
    std::vector<PlacedMover> movers;
    for (size_t i = 0; i < robots.size(); ++i) movers.push_back(placed(body(robots[i]), places[i], 0));
    Clearance best;
    double squared = HUGE_VAL;
    float bound = float_bound(squared);  // finite, since lanes without a body have infinite keys
    int64_t n = 0;
    const auto measure = [&](const PlacedPart& a, const Body& b, const Rigid& pose, const Box& box) {
        ++n;
        const Rigid there = relative(a.pose, pose);
        double found;
        if (overlap(a.box, box) && kernels().collide(*a.body->shape, *b.shape, there, true, nullptr))
            found = 0;
        else
            found = greater(kernels().nearest(*a.body->shape, *b.shape, there, squared * (1 + 1e-15), false).squared,
                            0x1p-1022);  // above 0, also where rounding hides the gap
        // The order of equally near bodies must not depend on how the index was built.
        if (found > squared || (found == squared && best.other >= 0 && b.id > best.other)) return;
        if (found == HUGE_VAL) return;
        squared = found;
        bound = float_bound(squared);
        best = {std::sqrt(squared), b.id};
    };
    for (size_t i = 0; i < movers.size(); ++i)
        for (const PlacedPart& a : movers[i].parts) {
            const float lo[3] = {rounded_down(a.box.lo.x), rounded_down(a.box.lo.y), rounded_down(a.box.lo.z)};
            const float hi[3] = {rounded_up(a.box.hi.x), rounded_up(a.box.hi.y), rounded_up(a.box.hi.z)};
            walk_nearest(
                index_.packed(), bound, [&](const BoxBlock& b) { return squared_gaps(b, lo, hi); },
                [&](BodyId other) {
                    const Body& b = body(other);
                    if (std::find(robots.begin(), robots.end(), b.root) != robots.end() || ignores(*a.body, b)) return;
                    measure(a, b, pose_of(b, time), box_of(b, time));
                });
            for (size_t j = i + 1; j < movers.size(); ++j)
                for (const PlacedPart& b : movers[j].parts)
                    if (!ignores(*a.body, *b.body)) measure(a, *b.body, b.pose, b.box);
        }
    tests_.fetch_add(n, std::memory_order_relaxed);
    return best;
}

WorldHit World::raycast(Vec3 o, Vec3 d, double max_distance, const std::vector<BodyId>& ignored) const {
    WorldHit best;
    best.distance = HUGE_VAL;
    double reach = max_distance;
    const float origin[3] = {float(o.x), float(o.y), float(o.z)};
    float inv[3];
    for (int i = 0; i < 3; ++i) {
        const double along = coordinate(d, i);
        inv[i] = static_cast<float>(1 / (std::fabs(along) > 1e-18 ? along : std::copysign(1e-18, along)));
    }
    float bound = float_bound(reach);
    walk_nearest(
        index_.packed(), bound, [&](const BoxBlock& b) { return ray_entries(b, origin, inv, bound); },
        [&](BodyId other) {
            if (std::binary_search(ignored.begin(), ignored.end(), other)) return;
            const Body& b = body(other);
            const Rigid back = inverse(b.pose);
            const RayHit hit = kernels().raycast(*b.shape, apply(back, o), rotate(back, d), reach);
            if (hit.face < 0 || hit.distance > best.distance || (hit.distance == best.distance && other > best.body))
                return;
            reach = hit.distance;
            bound = float_bound(reach);
            best = {hit.distance, other};
        });
    return best;
}

// Visits bodies once for all rays, nearest boxes first, and tests eight rays at a time against each box.
void World::scan(Vec3 o, const std::vector<Vec3>& directions, double range, const std::vector<BodyId>& ignored,
                 double* distances) const {
    struct Eight {
        F8 inverse[3];
    };
    const size_t n = directions.size();
    std::vector<Eight> rays((n + 7) / 8);
    bool flat = true;  // all rays are horizontal
    for (size_t k = 0; k < 8 * rays.size(); ++k) {
        const Vec3& d = directions[std::min(k, n - 1)];
        flat &= d.z == 0;
        for (int i = 0; i < 3; ++i) {
            const double along = coordinate(d, i);
            rays[k / 8].inverse[i][k % 8] =
                static_cast<float>(1 / (std::fabs(along) > 1e-18 ? along : std::copysign(1e-18, along)));
        }
    }
    std::fill(distances, distances + n, range);
    std::vector<BodyId> near;
    index_.overlapping(widened({o, o}, range), near);
    std::vector<std::pair<double, BodyId>> order;
    for (BodyId id : near) {
        const Box& box = body(id).box;
        if ((flat && (o.z < box.lo.z || o.z > box.hi.z)) || std::binary_search(ignored.begin(), ignored.end(), id))
            continue;
        double squared = 0;
        for (int i = 0; i < 3; ++i) {
            const double x = coordinate(o, i);
            const double gap = greater(greater(coordinate(box.lo, i) - x, x - coordinate(box.hi, i)), 0);
            squared += gap * gap;
        }
        if (squared <= range * range) order.emplace_back(squared, id);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [squared, id] : order) {
        const Body& b = body(id);
        float lo[3],
            hi[3];  // relative to the origin, widened by more than the rounding of float differences and products
        for (int i = 0; i < 3; ++i) {
            const double x = coordinate(o, i), low = coordinate(b.box.lo, i), high = coordinate(b.box.hi, i);
            const double slack = (std::fabs(low) + std::fabs(high) + std::fabs(x)) * 0x1p-21;
            lo[i] = rounded_down(low - x - slack);
            hi[i] = rounded_up(high - x + slack);
        }
        Rigid back;
        Vec3 seen;
        bool placed = false;
        for (size_t block = 0; block < rays.size(); ++block) {
            F8 entry = F8{}, exit = splat(rounded_up(range));
            for (int i = 0; i < (flat ? 2 : 3); ++i) {
                const F8 a = splat(lo[i]) * rays[block].inverse[i], c = splat(hi[i]) * rays[block].inverse[i];
                entry = max(entry, min(a, c));
                exit = min(exit, max(a, c));
            }
            for (uint32_t m = bits(entry <= exit * splat(1.000001f)); m; m &= m - 1) {
                const size_t k = 8 * block + __builtin_ctz(m);
                if (k >= n || entry[k % 8] > distances[k] * 1.000001) continue;
                if (!placed) {
                    back = inverse(b.pose);
                    seen = apply(back, o);
                    placed = true;
                }
                distances[k] =
                    lesser(distances[k],
                           kernels().raycast(*b.shape, seen, rotate(back, directions[k]), distances[k]).distance);
            }
        }
    }
}

// Tests the bodies of one block against this and later blocks, with one search for eight bodies.
void World::contact_pairs_of_block(int32_t block, double margin, std::vector<std::pair<BodyId, BodyId>>& out) const {
    const PackedBoxes& packed = index_.packed();
    const BoxBlock& own = packed.levels[0][block];
    const float wide = rounded_up(margin);
    Box around = empty_box();
    for (int k = 0; k < 8; ++k)
        if (own.lo[0][k] <= own.hi[0][k])
            grow(around, Box{{own.lo[0][k], own.lo[1][k], own.lo[2][k]}, {own.hi[0][k], own.hi[1][k], own.hi[2][k]}});
    if (!(around.lo.x <= around.hi.x)) return;
    around = widened(around, wide);
    int64_t n = 0;
    const auto against = [&](int32_t other) {
        const BoxBlock& theirs = packed.levels[0][other];
        for (int k = 0; k < 8; ++k) {
            I8 meet = I8{} == 0;
            for (int i = 0; i < 3; ++i)
                meet &= (load(theirs.lo[i]) <= splat(rounded_up(own.hi[i][k] + wide))) &
                        (load(theirs.hi[i]) >= splat(rounded_down(own.lo[i][k] - wide)));
            uint32_t m = bits(meet);
            if (other == block) m &= ~((2u << k) - 1);
            if (!m) continue;
            const BodyId id = packed.items[8 * block + k];
            if (id < 0) continue;
            const Body& a = *bodies_[id];
            for (; m; m &= m - 1) {
                const Body& b = *bodies_[packed.items[8 * other + __builtin_ctz(m)]];
                if (!overlap(widened(a.box, margin), b.box) || ignores(a, b)) continue;
                ++n;
                // The body that was added first is `a` of the query, independent of the index.
                const Body &first = a.id < b.id ? a : b, &second = a.id < b.id ? b : a;
                if (hits(*first.shape, *second.shape, relative(first.pose, second.pose), margin, false))
                    out.emplace_back(first.id, second.id);
            }
        }
    };
    if (packed.levels.size() == 1) {
        against(0);
    } else {
        BoxSearch search = search_boxes(packed, around);
        for (int32_t other; (other = next_of_level(search, 1)) >= 0;)
            if (other >= block) against(other);
    }
    tests_.fetch_add(n, std::memory_order_relaxed);
}

int32_t World::blocks() const {
    return index_.packed().levels.empty() ? 0 : static_cast<int32_t>(index_.packed().levels[0].size());
}

}  // namespace fgenv
