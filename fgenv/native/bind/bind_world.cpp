// Python class of a world: its bodies and how they are changed.
#include "bind/bind_world.h"

#include "bind/bind.h"

namespace fgenv {
namespace {

using namespace nb::literals;

std::vector<std::string> names_of(nb::handle value, const char* name) {
    if (nb::isinstance<nb::str>(value)) return {nb::cast<std::string>(value)};
    std::vector<std::string> out;
    if (!nb::hasattr(value, "__iter__"))
        throw nb::type_error((std::string(name) + ": expected a name or names").c_str());
    for (nb::handle item : value) {
        if (!nb::isinstance<nb::str>(item))
            throw nb::type_error((std::string(name) + ": expected a name or names").c_str());
        out.push_back(nb::cast<std::string>(item));
    }
    return out;
}

BodyId add(World& w, std::shared_ptr<Shape> shape, nb::handle pose, const std::string& name, nb::handle groups,
           BodyId id) {
    const Rigid at = pose_of(pose, "pose");
    const std::vector<std::string> names = names_of(groups, "groups");
    const auto lock = writing(w);
    return w.add(std::move(shape), at, name, names, id);
}

BodyId add_robot(World& w, const Robot& robot, nb::handle q, const nb::list& parts,
                 const std::vector<std::pair<int32_t, int32_t>>& allowed, const std::string& name,
                 const std::string& default_name, nb::handle groups) {
    const Configurations c = configurations(robot, q, "q");
    if (!c.dims.empty()) fail("q: got " + to_string(c.dims) + " configurations, expected one, shape (nq,)");
    std::vector<RobotPart> bodies;
    for (nb::handle p : parts)
        bodies.push_back({nb::cast<std::string>(p[0]), nb::cast<int32_t>(p[1]), nb::cast<std::shared_ptr<Shape>>(p[2]),
                          pose_of(p[3], "parts")});
    const std::vector<std::string> names = names_of(groups, "groups");
    const auto lock = writing(w);
    return w.add_robot(std::make_shared<const Robot>(robot), {c.row(0), c.row(0) + c.nq}, bodies, allowed,
                       name.empty() ? w.unused_name(default_name) : name, names);
}

BodyId remove(World& w, nb::handle body) {
    const Asked a = asked(body, "body");
    std::vector<std::shared_ptr<Shape>> last;  // dropped after the lock
    const auto lock = writing(w);
    const BodyId id = body_of(w, a, "body");
    last = w.remove(id);
    return id;
}

void set_configuration(World& w, nb::handle robot, nb::handle q) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    if (!model) fail("robot: got body '" + a.text() + "', expected a robot; use set_pose");
    const Places p = places(model, q, "q");
    if (!p.single()) fail("q: got " + to_string(p.dims()) + " configurations, expected one, shape (nq,)");
    const auto lock = writing(w);
    w.set_configuration(mover_of(w, a, model), p[0].q);
}

nb::object configuration(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const Body& b = w.body(robot_of(w, a));
    if (!b.robot) fail("robot: got body '" + b.name + "', expected a robot; use poses");
    return copy_out(b.q.data(), {static_cast<int64_t>(b.q.size())});
}

nb::object parts(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const std::vector<BodyId>& ids = w.body(robot_of(w, a)).parts;
    return copy_out(ids.data(), {static_cast<int64_t>(ids.size())});
}

void set_pose(World& w, nb::handle ids, nb::handle poses_) {
    const Poses p = poses(poses_, "poses");
    const AskedBodies all = asked_bodies(ids, "ids");
    const auto lock = writing(w);
    const std::vector<BodyId> bodies = all.ids(w, "ids");
    for (BodyId id : bodies) root_of(w, id, "ids");
    const Dims expected = all.one ? Dims{} : Dims{static_cast<int64_t>(bodies.size())};
    const Broadcast shape = broadcast({{"ids", expected}, {"poses", p.dims}});
    if (shape.dims != expected)
        fail("poses: got " + to_string(p.dims) + " poses for ids " + to_string(expected) +
             ", expected one pose, or one per id");
    std::vector<Rigid> each;
    for (size_t i = 0; i < bodies.size(); ++i) each.push_back(p[shape.offset(1, static_cast<int64_t>(i))]);
    w.set_poses(bodies, each);
}

nb::object get_poses(const World& w, nb::handle ids) {
    const AskedBodies all = asked_bodies(ids, "ids");
    const auto lock = reading(w);
    std::vector<Rigid> out;
    for (BodyId id : all.ids(w, "ids")) out.push_back(w.body(id).pose);
    return pose_out(out, all.one ? Dims{} : Dims{static_cast<int64_t>(out.size())});
}

void set_trajectory(World& w, nb::handle body, nb::handle times, nb::handle poses_) {
    const Asked a = asked(body, "body");
    const Model model = model_of(w, a, "body");
    Trajectory t;
    if (!times.is_none() || !poses_.is_none()) t = trajectory_of(model, times, poses_);
    const auto lock = writing(w);
    w.set_trajectory(mover_of(w, a, model, "body"), std::move(t));
}

nb::object set_path(World& w, nb::handle robot, nb::handle poses_) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Places p = places(model, poses_, "poses");
    if (p.dims().size() != 1 || p.dims()[0] == 0)
        fail("poses: got " + to_string(p.dims()) + " way points, expected (K" + p.row() + " with K at least 1");
    const auto lock = writing(w);
    return id_array(w.set_path(mover_of(w, a, model), p.all()));
}

nb::object candidates(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const BodyId id = robot_of(w, a);
    const Path* p = w.path(id);
    if (!p) fail("robot: got '" + w.body(id).name + "' without a path, expected one with a path; use set_path");
    return id_array(p->candidates);
}

nb::object motion_boxes(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const BodyId id = robot_of(w, a);
    const Path* p = w.path(id);
    if (!p) fail("robot: got '" + w.body(id).name + "' without a path, expected one with a path; use set_path");
    return copy_out(reinterpret_cast<const double*>(p->legs.data()), {static_cast<int64_t>(p->legs.size())}, {2, 3});
}

nb::int_ mask(const World& w, nb::handle body) {
    const Asked a = asked(body, "body");
    const auto lock = reading(w);
    return mask_of(w, w.body(body_of(w, a, "body")));
}

Masks masks_of(const std::string& name) {
    if (name == "path") return Masks::path;
    if (name == "published") return Masks::published;
    if (name == "off") return Masks::off;
    fail("masks: got '" + name + "', expected path, published or off");
}

void bind_bodies(nb::class_<World>& c) {
    c.def(
         "__init__", [](World* self, const std::string& masks) { new (self) World(masks_of(masks)); }, "masks"_a)
        .def("copy_from",
             [](World* self, const World& other) {
                 const auto lock = reading(other);
                 self->~World();
                 new (self) World(other);
             })
        .def("add_body", &add, "shape"_a, "pose"_a.none(), "name"_a, nb::kw_only(), "groups"_a.none(), "id"_a)
        .def("add_robot", &add_robot, "robot"_a, "q"_a.none(), "parts"_a, nb::kw_only(), "allowed"_a, "name"_a,
             "default_name"_a, "groups"_a.none())
        .def("remove", &remove, "body"_a.none())
        .def("set_configuration", &set_configuration, "robot"_a.none(), "q"_a.none())
        .def("configuration", &configuration, "robot"_a.none())
        .def("parts", &parts, "robot"_a.none())
        .def("set_pose", &set_pose, "ids"_a.none(), "poses"_a.none())
        .def("poses", &get_poses, "ids"_a.none())
        .def(
            "attach",
            [](World& w, nb::handle body, nb::handle carrier) {
                const Asked a = asked(body, "body"), b = asked(carrier, "carrier");
                const auto lock = writing(w);
                w.attach(body_of(w, a, "body"), body_of(w, b, "carrier"));
            },
            "body"_a.none(), "carrier"_a.none())
        .def(
            "detach",
            [](World& w, nb::handle body) {
                const Asked a = asked(body, "body");
                const auto lock = writing(w);
                w.detach(body_of(w, a, "body"));
            },
            "body"_a.none());
}

void bind_masks(nb::class_<World>& c) {
    c.def(
         "allow",
         [](World& w, nb::handle a, nb::handle b, bool allowed) {
             const Asked first = asked(a, "a"), second = asked(b, "b");
             const auto lock = writing(w);
             w.allow(body_of(w, first, "a"), body_of(w, second, "b"), allowed);
         },
         "a"_a.none(), "b"_a.none(), "allowed"_a)
        .def(
            "allow_groups",
            [](World& w, const std::string& a, const std::string& b, bool allowed) {
                const auto lock = writing(w);
                w.allow_groups(a, b, allowed);
            },
            "a"_a, "b"_a, "allowed"_a)
        .def("set_trajectory", &set_trajectory, "body"_a.none(), "times"_a.none(), "poses"_a.none())
        .def("set_path", &set_path, "robot"_a.none(), "poses"_a.none())
        .def(
            "clear_path",
            [](World& w, nb::handle robot) {
                const Asked a = asked(robot, "robot");
                const auto lock = writing(w);
                w.clear_path(robot_of(w, a));
            },
            "robot"_a.none())
        .def("candidates", &candidates, "robot"_a.none())
        .def("motion_boxes", &motion_boxes, "robot"_a.none())
        .def("mask", &mask, "body"_a.none())
        .def(
            "own_bit",
            [](const World& w, nb::handle robot) {
                const Asked a = asked(robot, "robot");
                const auto lock = reading(w);
                return w.own_bit(robot_of(w, a));
            },
            "robot"_a.none());
}

}  // namespace

void bind_world(nb::module_& m) {
    nb::class_<World> c(m, "World");
    bind_bodies(c);
    bind_masks(c);
    c.def("masks", [](const World& w) { return w.masks_name(); })
        .def("tests", [](const World& w) { return w.tests(); })
        .def("motion_steps", [](const World& w) { return w.motion_steps(); })
        .def("nbytes",
             [](const World& w) {
                 const auto lock = reading(w);
                 return w.nbytes();
             })
        .def("__len__", [](const World& w) {
            const auto lock = reading(w);
            return w.size();
        });
    bind_world_queries(c);
    bind_world_motions(c);
    bind_world_state(c);
}

}  // namespace fgenv
