// Python class of a world: records, and its state for pickling.
#include "bind/bind_world.h"

#include <algorithm>

namespace fgenv {
namespace {

using namespace nb::literals;

// Data of a body for a record or a pickle.
nb::dict record_of(const World& w, const Body& b) {
    nb::dict out;
    out["id"] = b.id;
    out["name"] = b.name;
    out["shape"] = b.shape;
    out["pose"] = pose_out({b.pose}, {});
    out["mask"] = mask_of(w, b);
    nb::list groups;
    for (int32_t g : b.groups) groups.append(w.groups()[g]);
    out["groups"] = groups;
    out["allowed"] = b.allowed;
    out["carrier"] = b.carrier;
    out["root"] = b.root;
    out["link"] = b.link;
    out["offset"] = pose_out({b.offset}, {});
    out["built_in"] = b.built_in;
    out["configuration"] = b.robot ? copy_out(b.q.data(), {static_cast<int64_t>(b.q.size())}) : nb::none();
    out["parts"] = b.parts;
    const Path* path = w.path(b.id);
    out["path"] = path ? places_out(path->places, b.robot) : nb::none();
    out["bit"] = w.own_bit(b.id);
    nb::object times = nb::none(), poses = nb::none();
    if (b.trajectory) {
        times = copy_out(b.trajectory->times.data(), {static_cast<int64_t>(b.trajectory->times.size())});
        poses = places_out(b.trajectory->places, b.robot);
    }
    out["trajectory"] = nb::make_tuple(times, poses);
    return out;
}

nb::dict record(const World& w, nb::handle body) {
    const Asked a = asked(body, "body");
    const auto lock = reading(w);
    return record_of(w, w.body(body_of(w, a, "body")));
}

template <class F>
void for_each_body(const World& w, F f) {
    for (BodyId id = 0; id < w.end_id(); ++id)
        if (const Body* b = w.find(id)) f(*b);
}

nb::object ids(const World& w) {
    const auto lock = reading(w);
    std::vector<BodyId> out;
    for_each_body(w, [&](const Body& b) { out.push_back(b.id); });
    return id_array(out);
}

nb::list names(const World& w) {
    const auto lock = reading(w);
    nb::list out;
    for_each_body(w, [&](const Body& b) { out.append(b.name); });
    return out;
}

// Name, root and link of each id's body; None, -1, 0 for an unknown id.
nb::list labels(const World& w, const std::vector<int64_t>& ids) {
    const auto lock = reading(w);
    nb::list out;
    for (int64_t id : ids) {
        const Body* b = id >= 0 && id < w.end_id() ? w.find(static_cast<BodyId>(id)) : nullptr;
        out.append(b ? nb::make_tuple(b->name, b->root, b->link) : nb::make_tuple(nb::none(), -1, 0));
    }
    return out;
}

// State of a world at one moment.
nb::dict state(const World& w) {
    const auto lock = reading(w);
    nb::list bodies, allowed_groups;
    for_each_body(w, [&](const Body& b) { bodies.append(record_of(w, b)); });
    for (const auto& [a, b] : w.allowed_groups()) allowed_groups.append(nb::make_tuple(w.groups()[a], w.groups()[b]));
    nb::dict out;
    out["masks"] = w.masks_name();
    out["end_id"] = w.end_id();
    out["allowed_groups"] = allowed_groups;
    out["bodies"] = bodies;
    return out;
}

[[noreturn]] void damaged(const std::string& text) {
    throw nb::value_error(("state: " + text + "; it is damaged, or of another version").c_str());
}

constexpr BodyId max_end_id = 1 << 24;  // the world has a table of all ids

// Ids and shapes, checked before bodies are added.
void check_bodies(const nb::list& bodies, BodyId end_id) {
    if (end_id < 0 || end_id > max_end_id) damaged("end_id: got " + std::to_string(end_id) + ", expected 0 to 2^24");
    for (nb::handle b : bodies) {
        const BodyId id = nb::cast<BodyId>(b["id"]);
        if (id < 0 || id >= end_id) damaged("id: got " + std::to_string(id) + ", expected 0 to end_id - 1");
        if (!nb::isinstance<Shape>(b["shape"])) damaged("shape of body " + std::to_string(id) + ": expected a Shape");
        if (nb::cast<std::string>(b["name"]).empty()) damaged("name of body " + std::to_string(id) + ": got none");
    }
}

// Carriers lead to the root, which alone lists the parts and alone can be a robot.
void check_bonds(const World& w) {
    for_each_body(w, [&](const Body& b) {
        const auto fail = [&](const char* what) { damaged(what + (" of body '" + b.name + "': expected another")); };
        const auto known = [&](BodyId id) { return id >= 0 && id < w.end_id() && w.find(id); };
        if (!known(b.root)) fail("root");
        const Body& root = w.body(b.root);
        BodyId top = b.id;
        for (size_t steps = root.parts.size(); w.body(top).carrier != -1; --steps) {
            if (steps == 0 || !known(w.body(top).carrier)) fail("carrier");
            top = w.body(top).carrier;
        }
        if (top != b.root) fail("carrier");
        if (std::count(root.parts.begin(), root.parts.end(), b.id) != 1) fail("parts");
        if (b.id != b.root && !b.parts.empty()) fail("parts");
        for (BodyId part : b.parts)
            if (!known(part) || w.body(part).root != b.id) fail("parts");
        if (b.robot && b.id != b.root) fail("configuration");
        if (b.link < 0 || b.link >= (root.robot ? root.robot->n_links() : 1)) fail("link");
        if (b.built_in && !root.robot) fail("built_in");
    });
}

// Fills a new world with the result of `state`. `robots`: models of the bodies that are robots, by id.
void restore(World& w, const nb::dict& state, const nb::dict& robots) {
    if (!nb::isinstance<nb::list>(state["bodies"])) damaged("bodies: expected a list");
    const nb::list bodies(state["bodies"]);
    check_bodies(bodies, nb::cast<BodyId>(state["end_id"]));
    const auto id_of = [](nb::handle b) { return nb::cast<BodyId>(b["id"]); };
    for (nb::handle b : bodies)
        w.add(nb::cast<std::shared_ptr<Shape>>(b["shape"]), pose_of(b["pose"], "pose"),
              nb::cast<std::string>(b["name"]), nb::cast<std::vector<std::string>>(b["groups"]), id_of(b));
    for (nb::handle b : bodies) {
        World::Bond bond{nb::cast<BodyId>(b["carrier"]),
                         nb::cast<BodyId>(b["root"]),
                         nb::cast<int32_t>(b["link"]),
                         pose_of(b["offset"], "offset"),
                         nb::cast<bool>(b["built_in"]),
                         nb::cast<std::vector<BodyId>>(b["parts"]),
                         nullptr,
                         {}};
        if (!b["configuration"].is_none()) {
            bond.robot = std::make_shared<const Robot>(nb::cast<const Robot&>(robots[b["id"]]));
            const Places q = places(bond.robot, b["configuration"], "configuration");
            if (!q.dims().empty()) damaged("configuration: expected one");
            bond.q = q[0].q;
        }
        w.restore(id_of(b), std::move(bond));
    }
    check_bonds(w);
    for (nb::handle b : bodies)
        for (BodyId other : nb::cast<std::vector<BodyId>>(b["allowed"])) w.allow(id_of(b), other, true);
    for (nb::handle pair : state["allowed_groups"])
        w.allow_groups(nb::cast<std::string>(pair[0]), nb::cast<std::string>(pair[1]), true);
    for (nb::handle b : bodies)
        if (!b["trajectory"][0].is_none()) {
            if (w.body(id_of(b)).root != id_of(b)) damaged("trajectory: expected one of a root");
            w.set_trajectory(id_of(b), trajectory_of(w.body(id_of(b)).robot, b["trajectory"][0], b["trajectory"][1]));
        }
    for (nb::handle b : bodies)
        if (!b["path"].is_none()) {
            const int bit = nb::cast<int>(b["bit"]);
            if (bit < 0 || bit >= nb::cast<BodyId>(state["end_id"])) damaged("bit: expected 0 to end_id - 1");
            const Places path = places(w.body(id_of(b)).robot, b["path"], "path");
            if (path.dims().size() != 1 || path.dims()[0] == 0) damaged("path: expected one or more way points");
            if (w.body(id_of(b)).root != id_of(b)) damaged("path: expected one of a root");
            w.set_path(id_of(b), path.all(), bit);
        }
    w.set_end_id(nb::cast<BodyId>(state["end_id"]));
}

}  // namespace

void bind_world_state(nb::class_<World>& c) {
    c.def("state", &state)
        .def("restore", &restore, "state"_a, "robots"_a)
        .def("record", &record, "body"_a.none())
        .def("ids", &ids)
        .def("names", &names)
        .def("labels", &labels, "ids"_a);
}

}  // namespace fgenv
