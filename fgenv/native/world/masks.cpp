// Path-driven masks. A mover's path gives one motion box per leg. The mover owns one bit, which is set for every
// body that overlaps one of these boxes. Masks::published follows the paper (Ma Li, Wang Qiang et al., sections 2.3
// and 2.4): the path of the reference point, the positions of bodies, and one bit for all movers.
#include <algorithm>

#include "math/sorted_set.h"
#include "world/world.h"

namespace fgenv {
namespace {

void sort_unique(std::vector<BodyId>& v) {
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
}

}  // namespace

const Path* World::path(BodyId robot) const {
    const auto found = paths_.find(robot);
    return found == paths_.end() ? nullptr : &found->second;
}

int World::own_bit(BodyId robot) const {
    const Path* p = path(robot);
    return p ? p->bit : -1;
}

// Each leg's box encloses all parts of the robot along the leg. A single way point counts as a leg.
std::vector<Box> World::legs_of(const Body& robot, const std::vector<Place>& places) const {
    std::vector<Box> legs;
    if (masks_ == Masks::published) {
        Box box = empty_box();
        for (const Place& p : places) grow(box, origin(frames_at(robot.robot.get(), p)[robot.link]));
        return {box};
    }
    for (size_t i = 0; i + 1 < std::max<size_t>(places.size(), 2); ++i) {
        const MoverMotion motion(robot.robot.get(), places[i], places[std::min(i + 1, places.size() - 1)]);
        Box leg = empty_box();
        for (BodyId id : robot.parts) {
            const Body& part = body(id);
            grow(leg, swept_box(*part.shape, *motion.part(part.link, part.held_at()), 0, 1));
        }
        legs.push_back(leg);
    }
    return legs;
}

void World::set_candidates(BodyId robot, std::vector<BodyId> candidates) {
    Path& p = paths_.at(robot);
    for (BodyId id : p.candidates)
        if (!std::binary_search(candidates.begin(), candidates.end(), id)) erase(at(id).movers, robot);
    for (BodyId id : candidates) insert(at(id).movers, robot);
    p.candidates = std::move(candidates);
}

const std::vector<BodyId>& World::set_path(BodyId robot, std::vector<Place> places, int bit) {
    const Body& b = root_at(robot, "robot");
    const bool known = paths_.count(robot) != 0;
    Path& p = paths_[robot];
    if (bit >= 0) {
        p.bit = bit;
    } else if (!known && masks_ != Masks::published) {
        std::vector<int> taken;
        for (const auto& [id, other] : paths_)
            if (id != robot) taken.push_back(other.bit);
        std::sort(taken.begin(), taken.end());
        for (int other : taken) p.bit += other == p.bit;
    }
    drop_legs(p);
    p.places = std::move(places);
    p.legs = legs_of(b, p.places);
    if (masks_ == Masks::published) {
        std::vector<BodyId> found;
        for (BodyId id = 0; id < end_id(); ++id)
            if (const Body* other = find(id);
                other && other->present && !ignores(b, *other) && inside(p.legs[0], origin(other->pose)))
                found.push_back(id);
        set_candidates(robot, std::move(found));
        return p.candidates;
    }
    std::vector<BodyId> found;
    std::vector<int32_t> met;
    for (const Box& leg : p.legs) {
        index_.overlapping(leg, found);
        legs_.overlapping(leg, met);
    }
    for (int32_t item : met) {  // movers with overlapping motion boxes
        const std::vector<BodyId>& parts = body(leg_of_[item]).parts;
        found.insert(found.end(), parts.begin(), parts.end());
    }
    sort_unique(found);
    found.erase(std::remove_if(found.begin(), found.end(), [&](BodyId id) { return !meets(p, robot, body(id)); }),
                found.end());
    for (const Box& leg : p.legs) {
        int32_t item = static_cast<int32_t>(std::find(leg_of_.begin(), leg_of_.end(), -1) - leg_of_.begin());
        if (item == static_cast<int32_t>(leg_of_.size())) leg_of_.push_back(-1);
        leg_of_[item] = robot;
        legs_.set(item, leg);
        p.items.push_back(item);
    }
    set_candidates(robot, std::move(found));
    for (BodyId part : b.parts) update_masks(part);  // overlaps with other movers' boxes may have changed
    return p.candidates;
}

void World::drop_legs(Path& p) {
    for (int32_t item : p.items) {
        legs_.remove(item);
        leg_of_[item] = -1;
    }
    p.items.clear();
}

void World::clear_path(BodyId robot) {
    const auto found = paths_.find(robot);
    if (found == paths_.end()) return;
    drop_legs(found->second);
    set_candidates(robot, {});
    paths_.erase(found);
    for (BodyId part : body(robot).parts) update_masks(part);
}

// Whether a body's extent or its own path overlaps the path's motion boxes.
bool World::meets(const Path& p, BodyId robot, const Body& other) const {
    if (other.root == robot || !other.present) return false;
    bool tested = false;  // against at least one part of the robot
    for (BodyId part : body(robot).parts) tested |= !ignores(body(part), other);
    if (!tested) return false;
    const Path* theirs = path(other.root);
    for (const Box& leg : p.legs) {
        if (overlap(leg, other.extent)) return true;
        if (theirs)
            for (const Box& box : theirs->legs)
                if (overlap(leg, box)) return true;
    }
    return false;
}

// Finds the movers with a motion box that the body overlaps.
void World::find_movers(BodyId id, std::vector<BodyId>& out) const {
    const Body& b = body(id);
    if (!b.present) return;
    std::vector<int32_t> items;
    legs_.overlapping(b.extent, items);
    if (const Path* own = path(b.root))
        for (const Box& leg : own->legs) legs_.overlapping(leg, items);
    for (int32_t item : items) out.push_back(leg_of_[item]);
    sort_unique(out);
    out.erase(std::remove_if(out.begin(), out.end(), [&](BodyId robot) { return !meets(paths_.at(robot), robot, b); }),
              out.end());
}

void World::update_masks(BodyId id) {
    if (masks_ == Masks::published) return;  // in the paper, a body that moves later keeps its mask
    Body& b = at(id);
    if (paths_.empty() && b.movers.empty()) return;
    std::vector<BodyId> movers;
    find_movers(id, movers);
    if (movers == b.movers) return;
    for (BodyId robot : b.movers) erase(paths_.at(robot).candidates, id);
    for (BodyId robot : movers) insert(paths_.at(robot).candidates, id);
    b.movers = std::move(movers);
}

void World::update_all_masks() {
    if (paths_.empty()) return;
    for (BodyId id = 0; id < end_id(); ++id)
        if (find(id)) update_masks(id);
}

// Bodies that a robot may touch within a box: the candidates of its path if the box lies in one of its motion
// boxes, otherwise the bodies that the index finds.
void World::candidates(const Body& robot, const Box& box, std::vector<BodyId>& out) const {
    out.clear();
    const Path* p = path(robot.root);
    if (masks_ == Masks::off) {
        for (BodyId id = 0; id < end_id(); ++id)
            if (const Body* other = find(id); other && other->present) out.push_back(id);
    } else if (p && (masks_ == Masks::published ||
                     std::any_of(p->legs.begin(), p->legs.end(), [&](const Box& leg) { return holds(leg, box); }))) {
        out = p->candidates;
    } else {
        index_.overlapping(box, out);
        std::sort(out.begin(), out.end());
    }
}

}  // namespace fgenv
