// A world's bodies: adding, moving, carrying, filtering.
#include <algorithm>
#include <stdexcept>

#include "math/sorted_set.h"
#include "world/world.h"

namespace fgenv {
World::World(const World& other)
    : masks_(other.masks_),
      names_(other.names_),
      groups_(other.groups_),
      allowed_groups_(other.allowed_groups_),
      index_(other.index_),
      legs_(other.legs_),
      leg_of_(other.leg_of_),
      paths_(other.paths_),
      tests_(other.tests_.load()),
      motion_steps_(other.motion_steps_.load()) {
    for (const auto& body : other.bodies_) {
        bodies_.push_back(nullptr);
        if (!body) continue;
        const Body& b = *body;
        bodies_.back().reset(new Body{b.id,
                                      b.shape,
                                      b.name,
                                      b.pose,
                                      b.box,
                                      b.extent,
                                      b.groups,
                                      b.allowed,
                                      b.carrier,
                                      b.root,
                                      b.link,
                                      b.offset,
                                      b.built_in,
                                      b.present,
                                      b.parts,
                                      b.movers,
                                      b.trajectory ? std::make_unique<Trajectory>(*b.trajectory) : nullptr,
                                      b.robot,
                                      b.q,
                                      b.own_pairs});
    }
}

World::~World() = default;

const Body* World::find(BodyId id) const { return id >= 0 && id < end_id() ? bodies_[id].get() : nullptr; }

const Body& World::body(BodyId id) const {
    if (const Body* found = find(id)) return *found;
    throw std::invalid_argument("body: got id " + std::to_string(id) +
                                ", expected a body of this world; world.ids lists them");
}

Body& World::at(BodyId id) { return const_cast<Body&>(body(id)); }

Body& World::root_at(BodyId id, const char* what) {
    Body& b = at(id);
    if (b.carrier >= 0)
        throw std::invalid_argument(std::string(what) + ": got body " + std::to_string(id) + " ('" + b.name +
                                    "'), carried by '" + body(b.carrier).name +
                                    "', expected a root; move the carrier, or detach the body first");
    return b;
}

BodyId World::id_of(const std::string& name) const {
    const auto found = names_.find(name);
    return found == names_.end() ? -1 : found->second;
}

int32_t World::group(const std::string& name) {
    const auto found = std::find(groups_.begin(), groups_.end(), name);
    if (found == groups_.end()) groups_.push_back(name);
    return static_cast<int32_t>(std::find(groups_.begin(), groups_.end(), name) - groups_.begin());
}

std::string World::unused_name(const std::string& like) const {
    std::string name = like;
    for (int i = 2; names_.count(name); ++i) name = like + " (" + std::to_string(i) + ")";
    return name;
}

BodyId World::add(std::shared_ptr<Shape> shape, const Rigid& pose, std::string name,
                  const std::vector<std::string>& groups, BodyId id) {
    if (id < 0) id = end_id();
    if (name.empty()) name = unused_name("body " + std::to_string(id));
    if (names_.count(name))
        throw std::invalid_argument("name: got '" + name + "', taken by body " + std::to_string(names_[name]) +
                                    ", expected an unused name");
    if (find(id))
        throw std::invalid_argument("id: got " + std::to_string(id) + ", which is taken, expected an unused id");
    set_end_id(id + 1);
    auto body = std::make_unique<Body>();
    body->id = id;
    body->shape = std::move(shape);
    body->name = name;
    body->root = id;
    body->parts = {id};
    for (const std::string& g : groups) insert(body->groups, group(g));
    names_[std::move(name)] = id;
    bodies_[id] = std::move(body);
    refresh(*bodies_[id], pose);
    settle(id);
    return id;
}

BodyId World::add_robot(std::shared_ptr<const Robot> robot, std::vector<double> q, const std::vector<RobotPart>& parts,
                        const std::vector<std::pair<int32_t, int32_t>>& allowed, const std::string& name,
                        const std::vector<std::string>& groups) {
    if (parts.empty()) throw std::invalid_argument("robot: got no shapes, expected at least one");
    const Place place{identity(), std::move(q)};
    const Frames frames = frames_at(robot.get(), place);
    std::vector<BodyId> ids;
    try {
        for (const RobotPart& p : parts)
            ids.push_back(add(p.shape, compose(frames[p.link], p.offset),
                              ids.empty() ? name : unused_name(name + "/" + p.link_name), groups));
    } catch (...) {
        for (BodyId id : ids) remove(id);
        throw;
    }
    for (size_t i = 0; i < ids.size(); ++i) {
        Body& b = at(ids[i]);
        b.carrier = i ? ids[0] : -1;
        b.root = ids[0];
        b.link = parts[i].link;
        b.offset = parts[i].offset;
        b.built_in = true;
        b.parts.clear();
    }
    for (const auto& [i, j] : allowed) {
        insert(at(ids[i]).allowed, ids[j]);
        insert(at(ids[j]).allowed, ids[i]);
    }
    Body& root = at(ids[0]);
    root.parts = ids;
    root.robot = std::move(robot);
    root.q = place.q;
    bonds_changed(root.id);
    return root.id;
}

std::vector<std::shared_ptr<Shape>> World::remove(BodyId id) {
    Body& b = at(id);
    if (b.built_in && b.carrier >= 0)
        throw std::invalid_argument("body: got '" + b.name + "', a part of robot '" + body(b.root).name +
                                    "', expected a whole robot or another body; remove the robot");
    const auto goes = [&](const Body& x) { return x.id == id || (b.robot && x.built_in && x.root == id); };
    const std::vector<BodyId> family = body(b.root).parts;  // b may be carried and also carry other bodies
    std::vector<BodyId> going;
    for (BodyId part : family)
        if (goes(body(part))) going.push_back(part);
    for (BodyId part : family)
        if (const BodyId carrier = body(part).carrier; carrier >= 0 && !goes(body(part)) && goes(body(carrier)))
            detach(part);
    if (b.carrier >= 0) detach(id);
    clear_path(id);
    std::vector<std::shared_ptr<Shape>> shapes;
    for (BodyId part : going) erase_body(part, shapes);
    return shapes;
}

void World::erase_body(BodyId id, std::vector<std::shared_ptr<Shape>>& shapes) {
    Body& b = at(id);
    for (BodyId mover : b.movers) erase(paths_.at(mover).candidates, id);
    for (BodyId other : b.allowed) erase(at(other).allowed, id);
    if (b.present) index_.remove(id);
    names_.erase(b.name);
    shapes.push_back(std::move(b.shape));
    bodies_[id].reset();
}

// Places a body; the caller updates the index and the masks.
void World::refresh(Body& body, const Rigid& pose) {
    body.pose = pose;
    body.box = body.extent = posed_box(*body.shape, pose);
    const Body& root = *bodies_[body.root];
    if (!root.trajectory) return;
    const std::vector<Place>& places = root.trajectory->places;
    for (size_t i = 0; i < places.size(); ++i) {
        const MoverMotion leg(root.robot.get(), places[i], places[std::min(i + 1, places.size() - 1)]);
        grow(body.extent, swept_box(*body.shape, *leg.part(body.link, body.held_at()), 0, 1));
    }
}

// Updates index and masks after a body was added or moved.
void World::settle(BodyId id) {
    if (body(id).present) index_.set(id, body(id).extent);
    update_masks(id);
}

void World::set_poses(const std::vector<BodyId>& ids, const std::vector<Rigid>& poses) {
    for (BodyId id : ids)  // all or nothing
        if (const Body& b = root_at(id, "ids"); b.robot)
            throw std::invalid_argument("ids: got robot '" + b.name + "', expected bodies; use set_configuration");
    std::vector<Place> places;
    for (const Rigid& pose : poses) places.push_back({pose, {}});
    put(ids, places);
}

void World::set_configuration(BodyId robot, std::vector<double> q) {
    if (!root_at(robot, "robot").robot)
        throw std::invalid_argument("robot: got body '" + body(robot).name + "', expected a robot; use set_pose");
    put({robot}, {{identity(), std::move(q)}});
}

void World::put(const std::vector<BodyId>& roots, const std::vector<Place>& places) {
    std::vector<BodyId> moved;
    for (size_t i = 0; i < roots.size(); ++i) {
        Body& root = at(roots[i]);
        root.q = places[i].q;
        const Frames frames = frames_at(root.robot.get(), places[i]);
        for (BodyId id : root.parts) {
            Body& part = at(id);
            refresh(part, part.in(frames));
            if (part.present) moved.push_back(id);
        }
    }
    reindex(moved);
}

void World::reindex(const std::vector<BodyId>& moved) {
    std::vector<Box> extents;
    for (BodyId id : moved) extents.push_back(body(id).extent);
    index_.set_many(moved, extents);
    if (!paths_.empty())
        for (BodyId id : moved) update_masks(id);
}

void World::set_present(BodyId robot, bool present) {
    Body& root = root_at(robot, "robot");
    if (root.present == present) return;
    if (!present) clear_path(robot);
    for (BodyId id : root.parts) {
        at(id).present = present;
        if (present) continue;
        index_.remove(id);
        update_masks(id);
    }
    if (present) reindex(root.parts);
}

// Moves a body and all bodies that it carries to a root.
void World::adopt(BodyId id, BodyId root, int32_t link, const Rigid& offset) {
    Body& b = at(id);
    const Rigid back = inverse(b.offset);
    std::vector<BodyId> family;
    for (BodyId part : body(b.root).parts) {
        BodyId up = part;
        while (up >= 0 && up != id) up = body(up).carrier;
        if (up == id) family.push_back(part);
    }
    std::vector<BodyId>& left = at(b.root).parts;
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](BodyId p) { return std::find(family.begin(), family.end(), p) != family.end(); }),
               left.end());
    for (BodyId part : family) {
        Body& p = at(part);
        p.offset = part == id ? offset : compose(offset, compose(back, p.offset));
        p.link = link;
        p.root = root;
    }
    std::vector<BodyId>& parts = at(root).parts;
    parts.insert(parts.end(), family.begin(), family.end());
}

// Updates a mover after its parts changed.
void World::bonds_changed(BodyId root) {
    Body& r = at(root);
    for (BodyId part : r.parts) {
        refresh(at(part), body(part).pose);
        if (body(part).present) index_.set(part, body(part).extent);
    }
    find_own_pairs(r);
    if (path(root)) set_path(root, std::vector<Place>(paths_.at(root).places));
}

void World::find_own_pairs(Body& robot) {
    robot.own_pairs.clear();
    if (!robot.robot) return;
    const int32_t n = static_cast<int32_t>(robot.parts.size());
    for (int32_t i = 0; i < n; ++i)
        for (int32_t j = i + 1; j < n; ++j)
            if (!ignores(body(robot.parts[i]), body(robot.parts[j]))) robot.own_pairs.emplace_back(i, j);
}

void World::attach(BodyId id, BodyId carrier) {
    Body& b = root_at(id, "body");
    const Body& c = body(carrier);
    if (b.robot)
        throw std::invalid_argument("body: got robot '" + b.name + "', expected a body; build one robot from both");
    if (c.root == id)
        throw std::invalid_argument("carrier: got '" + c.name + "', expected a body other than '" + b.name +
                                    "' that it does not carry");
    clear_path(id);
    b.trajectory.reset();
    b.carrier = carrier;
    const Body& root = body(c.root);
    const Frames frames = frames_at(root.robot.get(), root.place());
    adopt(id, c.root, c.link, compose(inverse(frames[c.link]), b.pose));
    bonds_changed(c.root);
    update_all_masks();
}

void World::detach(BodyId id) {
    Body& b = at(id);
    if (b.carrier < 0)
        throw std::invalid_argument("body: got '" + b.name + "', which is not carried, expected a carried body");
    if (b.built_in)
        throw std::invalid_argument("body: got '" + b.name + "', a part of robot '" + body(b.root).name +
                                    "', expected an attached body");
    const BodyId root = b.root;
    b.carrier = -1;
    adopt(id, id, 0, identity());
    bonds_changed(id);
    bonds_changed(root);
    update_all_masks();
}

void World::restore(BodyId id, Bond bond) {
    Body& b = at(id);
    b.carrier = bond.carrier;
    b.root = bond.root;
    b.link = bond.link;
    b.offset = bond.offset;
    b.built_in = bond.built_in;
    b.parts = std::move(bond.parts);
    b.robot = std::move(bond.robot);
    b.q = std::move(bond.q);
}

void World::allow(BodyId a, BodyId b, bool allowed) {
    Body &first = at(a), &second = at(b);
    if (a == b) throw std::invalid_argument("allow: got '" + first.name + "' twice, expected two bodies");
    if (allowed) {
        insert(first.allowed, b);
        insert(second.allowed, a);
    } else {
        erase(first.allowed, b);
        erase(second.allowed, a);
    }
    if (first.root == second.root) find_own_pairs(at(first.root));
    update_all_masks();
}

void World::allow_groups(const std::string& a, const std::string& b, bool allowed) {
    const int32_t i = group(a), j = group(b);
    const std::pair<int32_t, int32_t> pair{std::min(i, j), std::max(i, j)};
    if (allowed)
        insert(allowed_groups_, pair);
    else
        erase(allowed_groups_, pair);
    for (const auto& body : bodies_)
        if (body) find_own_pairs(*body);
    update_all_masks();
}

bool World::ignores(const Body& a, const Body& b) const {
    if (a.root == b.root && (a.link == b.link || !robot_of(a))) return true;
    if (contains(a.allowed, b.id)) return true;
    if (allowed_groups_.empty()) return false;
    for (int32_t i : a.groups)
        for (int32_t j : b.groups)
            if (contains(allowed_groups_, {std::min(i, j), std::max(i, j)})) return true;
    return false;
}

void World::set_trajectory(BodyId id, Trajectory trajectory) {
    Body& b = root_at(id, "body");
    b.trajectory = trajectory.times.empty() ? nullptr : std::make_unique<Trajectory>(std::move(trajectory));
    for (BodyId part : b.parts) {
        refresh(at(part), body(part).pose);
        settle(part);
    }
}

size_t World::nbytes() const {
    size_t n = sizeof(World) + index_.nbytes() + legs_.nbytes() + bodies_.capacity() * sizeof(bodies_[0]);
    for (const auto& b : bodies_)
        if (b)
            n += sizeof(Body) + 2 * b->name.capacity() + 48 +
                 sizeof(int32_t) *
                     (b->groups.capacity() + b->allowed.capacity() + b->parts.capacity() + b->movers.capacity());
    return n;
}

Trajectory::Leg Trajectory::leg(double time) const {
    const size_t next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
    if (next == 0) return {places.front(), places.front(), time, 0};
    if (next == times.size()) return {places.back(), places.back(), time, 0};
    return {places[next - 1], places[next], times[next - 1], times[next] - times[next - 1]};
}

}  // namespace fgenv
