// A world's bodies: adding, moving, carrying, filtering.
#include <algorithm>
#include <stdexcept>

#include "world.h"

namespace fgenv {
namespace {

template <class T>
bool contains(const std::vector<T>& sorted, const T& x) {
    return std::binary_search(sorted.begin(), sorted.end(), x);
}
template <class T>
void insert(std::vector<T>& sorted, const T& x) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), x);
    if (at == sorted.end() || *at != x) sorted.insert(at, x);
}
template <class T>
void erase(std::vector<T>& sorted, const T& x) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), x);
    if (at != sorted.end() && *at == x) sorted.erase(at);
}

}  // namespace

World::World(const World& other)
    : masks_(other.masks_), names_(other.names_), groups_(other.groups_), allowed_groups_(other.allowed_groups_),
      index_(other.index_), legs_(other.legs_), leg_of_(other.leg_of_), paths_(other.paths_), tests_(other.tests_.load()) {
    for (const auto& body : other.bodies_) {
        bodies_.push_back(nullptr);
        if (!body) continue;
        const Body& b = *body;
        bodies_.back().reset(new Body{b.id, b.shape, b.name, b.pose, b.box, b.extent, b.groups, b.allowed, b.carrier, b.root,
                                      b.offset, b.parts, b.movers,
                                      b.trajectory ? std::make_unique<Trajectory>(*b.trajectory) : nullptr});
    }
}

World::~World() = default;

const Body* World::find(BodyId id) const {
    return id >= 0 && id < end_id() ? bodies_[id].get() : nullptr;
}

const Body& World::body(BodyId id) const {
    if (const Body* found = find(id)) return *found;
    throw std::invalid_argument("body " + std::to_string(id) + ": not in this world; world.ids tells which are");
}

Body& World::at(BodyId id) { return const_cast<Body&>(body(id)); }

Body& World::root_at(BodyId id, const char* what) {
    Body& b = at(id);
    if (b.carrier >= 0)
        throw std::invalid_argument(std::string(what) + ": body " + std::to_string(id) + " ('" + b.name +
                                    "') is carried by '" + body(b.carrier).name + "'; move that, or detach it first");
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

BodyId World::add(std::shared_ptr<Shape> shape, const Rigid& pose, std::string name,
                  const std::vector<std::string>& groups, BodyId id) {
    if (id < 0) id = end_id();
    if (name.empty()) {
        const std::string plain = "body " + std::to_string(id);
        name = plain;
        for (int i = 2; names_.count(name); ++i) name = plain + " (" + std::to_string(i) + ")";
    }
    if (names_.count(name))
        throw std::invalid_argument("name: '" + name + "' is taken by body " + std::to_string(names_[name]) +
                                    ", wanted one that no body of this world has");
    if (find(id)) throw std::invalid_argument("id: " + std::to_string(id) + " is taken");
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

std::shared_ptr<Shape> World::remove(BodyId id) {
    Body& b = at(id);
    const std::vector<BodyId> family = body(b.root).parts;  // b may be carried and carry in its turn
    for (BodyId part : family)
        if (body(part).carrier == id) detach(part);
    if (b.carrier >= 0) detach(id);
    clear_path(id);
    for (BodyId mover : b.movers) erase(paths_.at(mover).candidates, id);
    for (BodyId other : b.allowed) erase(at(other).allowed, id);
    index_.remove(id);
    names_.erase(b.name);
    std::shared_ptr<Shape> shape = std::move(b.shape);
    bodies_[id].reset();
    return shape;
}

// Places a body; its entry in the index and the masks are for whoever calls.
void World::refresh(Body& body, const Rigid& pose) {
    body.pose = pose;
    body.box = body.extent = posed_box(*body.shape, pose);
    const Body& root = *bodies_[body.root];
    if (!root.trajectory) return;
    const Trajectory& t = *root.trajectory;
    const Rigid* offset = &body == &root ? nullptr : &body.offset;
    for (size_t i = 0; i < t.times.size(); ++i) {
        const size_t j = std::min(i + 1, t.times.size() - 1);
        grow(body.extent, swept_box(*body.shape, RigidMotion(t.poses[i], t.poses[j], offset), 0, 1));
    }
}

// After a body has come or changed its place.
void World::settle(BodyId id) {
    index_.set(id, body(id).extent);
    update_masks(id);
}

void World::set_poses(const std::vector<BodyId>& ids, const std::vector<Rigid>& poses) {
    for (BodyId id : ids) root_at(id, "ids");  // all or nothing
    std::vector<BodyId> moved;
    std::vector<Box> extents;
    for (size_t i = 0; i < ids.size(); ++i)
        for (BodyId id : body(ids[i]).parts) {
            Body& part = at(id);
            refresh(part, id == ids[i] ? poses[i] : compose(poses[i], part.offset));
            moved.push_back(id);
            extents.push_back(part.extent);
        }
    index_.set_many(moved, extents);
    if (!paths_.empty())
        for (BodyId id : moved) update_masks(id);
}

// Puts a body and all that it carries under a root.
void World::adopt(BodyId id, BodyId root, const Rigid& offset) {
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
        p.root = root;
        if (part == root) p.offset = identity();
    }
    std::vector<BodyId>& parts = at(root).parts;
    parts.insert(parts.end(), family.begin(), family.end());
}

void World::attach(BodyId id, BodyId carrier) {
    Body& b = root_at(id, "body");
    const Body& c = body(carrier);
    if (c.root == id)
        throw std::invalid_argument("carrier: '" + c.name + "' is '" + b.name + "' or carried by it");
    clear_path(id);
    b.trajectory.reset();
    b.carrier = carrier;
    const Body& root = body(c.root);
    adopt(id, c.root, compose(inverse(root.pose), b.pose));
    for (BodyId part : body(c.root).parts) {
        refresh(at(part), body(part).pose);
        index_.set(part, body(part).extent);
    }
    if (path(c.root)) set_path(c.root, std::vector<Rigid>(paths_.at(c.root).poses));
    update_all_masks();
}

void World::detach(BodyId id) {
    Body& b = at(id);
    if (b.carrier < 0) throw std::invalid_argument("body: '" + b.name + "' is not carried");
    const BodyId root = b.root;
    b.carrier = -1;
    adopt(id, id, identity());
    for (BodyId part : body(id).parts) {
        refresh(at(part), body(part).pose);
        index_.set(part, body(part).extent);
    }
    if (path(root)) set_path(root, std::vector<Rigid>(paths_.at(root).poses));
    update_all_masks();
}

void World::restore(BodyId id, BodyId carrier, BodyId root, const Rigid& offset, std::vector<BodyId> parts) {
    Body& b = at(id);
    b.carrier = carrier;
    b.root = root;
    b.offset = offset;
    b.parts = std::move(parts);
}

void World::allow(BodyId a, BodyId b, bool allowed) {
    Body &first = at(a), &second = at(b);
    if (a == b) throw std::invalid_argument("allow: '" + first.name + "' with itself");
    if (allowed) {
        insert(first.allowed, b);
        insert(second.allowed, a);
    } else {
        erase(first.allowed, b);
        erase(second.allowed, a);
    }
    update_all_masks();
}

void World::allow_groups(const std::string& a, const std::string& b, bool allowed) {
    const int32_t i = group(a), j = group(b);
    const std::pair<int32_t, int32_t> pair{std::min(i, j), std::max(i, j)};
    if (allowed) insert(allowed_groups_, pair);
    else erase(allowed_groups_, pair);
    update_all_masks();
}

bool World::ignores(const Body& a, const Body& b) const {
    if (a.root == b.root) return true;
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
                 sizeof(int32_t) * (b->groups.capacity() + b->allowed.capacity() + b->parts.capacity() + b->movers.capacity());
    return n;
}

Rigid Trajectory::pose(double time) const {
    const size_t next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
    if (next == 0) return poses.front();
    if (next == times.size()) return poses.back();
    const double begin = times[next - 1], length = times[next] - begin;
    return RigidMotion(poses[next - 1], poses[next]).pose((time - begin) / length);
}

RigidMotion Trajectory::between(double from, double to, const Rigid* offset) const {
    const size_t next = std::upper_bound(times.begin(), times.end(), from) - times.begin();
    if (next == 0) return RigidMotion(poses.front(), poses.front(), offset);
    if (next == times.size()) return RigidMotion(poses.back(), poses.back(), offset);
    const double begin = times[next - 1], length = times[next] - begin;
    return RigidMotion(poses[next - 1], poses[next], offset).retimed((from - begin) / length, (to - from) / length);
}

}  // namespace fgenv
