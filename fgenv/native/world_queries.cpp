// A world's queries at one instant: collision, clearance, rays, all pairs.
#include <algorithm>

#include "box_walk.h"
#include "kernels.h"
#include "world.h"

namespace fgenv {
namespace {

bool hits(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb, double margin) {
    const Rigid pose = relative(ta, tb);
    if (kernels().collide(a, b, pose, margin > 0, nullptr)) return true;
    return margin > 0 && kernels().nearest(a, b, pose, margin * margin, true).face_a >= 0;
}

// Above a squared distance, in floats.
float float_bound(double squared) {
    return squared < 1e30 ? rounded_up(squared) * 1.00001f + 1e-30f : 1e30f;
}

}  // namespace

Rigid World::pose_of(const Body& b, double time) const {
    const Body& root = body(b.root);
    if (std::isnan(time) || !root.trajectory) return b.pose;
    const Rigid pose = root.trajectory->pose(time);
    return &b == &root ? pose : compose(pose, b.offset);
}

Box World::box_of(const Body& b, double time) const {
    return std::isnan(time) || !body(b.root).trajectory ? b.box : posed_box(*b.shape, pose_of(b, time));
}

bool World::collides(BodyId id, const Rigid& pose, double time, double margin) const {
    const Body& robot = body(id);
    std::vector<Rigid> poses;
    std::vector<Box> boxes;
    Box around = empty_box();
    for (BodyId part : robot.parts) {
        poses.push_back(part == id ? pose : compose(pose, body(part).offset));
        boxes.push_back(widened(posed_box(*body(part).shape, poses.back()), margin));
        grow(around, boxes.back());
    }
    std::vector<BodyId> near;
    candidates(robot, around, near);
    int64_t n = 0;
    bool hit = false;
    for (BodyId other : near) {
        const Body& b = body(other);
        if (b.root == id) continue;
        const Box box = box_of(b, time);
        for (size_t i = 0; i < poses.size() && !hit; ++i) {
            const Body& part = body(robot.parts[i]);
            if ((masks_ == Masks::path && !overlap(box, boxes[i])) || ignores(part, b)) continue;
            ++n;
            hit = hits(*part.shape, poses[i], *b.shape, pose_of(b, time), margin);
        }
        if (hit) break;
    }
    tests_.fetch_add(n, std::memory_order_relaxed);
    return hit;
}

Clearance World::clearance(BodyId id, const Rigid& pose, double time) const {
    const Body& robot = body(id);
    Clearance best;
    double squared = HUGE_VAL;
    float bound = float_bound(squared);  // not infinite: so are the keys of lanes without a body
    int64_t n = 0;
    for (BodyId part_id : robot.parts) {
        const Body& part = body(part_id);
        const Rigid placed = part_id == id ? pose : compose(pose, part.offset);
        const Box box = posed_box(*part.shape, placed);
        const float lo[3] = {rounded_down(box.lo.x), rounded_down(box.lo.y), rounded_down(box.lo.z)};
        const float hi[3] = {rounded_up(box.hi.x), rounded_up(box.hi.y), rounded_up(box.hi.z)};
        walk_nearest(
            index_.packed(), bound, [&](const BoxBlock& b) { return squared_gaps(b, lo, hi); },
            [&](BodyId other) {
                const Body& b = body(other);
                if (b.root == id || ignores(part, b)) return;
                ++n;
                const Rigid there = relative(placed, pose_of(b, time));
                double found;
                if (overlap(box, box_of(b, time)) && kernels().collide(*part.shape, *b.shape, there, true, nullptr))
                    found = 0;
                else
                    found = kernels().nearest(*part.shape, *b.shape, there, squared * (1 + 1e-15), false).squared;
                // Which of two as near comes first must not depend on how the index was built.
                if (found > squared || (found == squared && best.other >= 0 && other > best.other)) return;
                if (found == HUGE_VAL) return;
                squared = found;
                bound = float_bound(squared);
                best = {std::sqrt(squared), other};
            });
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

std::vector<std::pair<BodyId, BodyId>> World::near_pairs(double margin) const {
    std::vector<std::pair<BodyId, BodyId>> pairs;
    std::vector<BodyId> near;
    for (BodyId id = 0; id < end_id(); ++id) {
        const Body* a = find(id);
        if (!a) continue;
        near.clear();
        const Box box = widened(a->box, margin);
        index_.overlapping(box, near);
        std::sort(near.begin(), near.end());
        for (BodyId other : near) {
            if (other <= id) continue;
            const Body& b = body(other);
            if (overlap(box, b.box) && !ignores(*a, b)) pairs.emplace_back(id, other);
        }
    }
    return pairs;
}

bool World::pair_collides(BodyId a, BodyId b, double margin) const {
    const Body &first = body(a), &second = body(b);
    return hits(*first.shape, first.pose, *second.shape, second.pose, margin);
}

}  // namespace fgenv
