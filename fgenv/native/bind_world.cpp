// Python class of a world. Every call locks it: queries share the lock, changes have it alone. Nobody
// waits for the lock while holding the interpreter, so that whoever has it may call back into Python.
#include "bind.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>
#include <mutex>

#include "arguments.h"
#include "configurations.h"
#include "parallel.h"
#include "world.h"

namespace fgenv {
namespace {

using namespace nb::literals;

template <class Lock>
Lock locked(const World& w) {
    Lock lock(w.mutex, std::try_to_lock);
    if (!lock) {
        nb::gil_scoped_release released;
        lock.lock();
    }
    return lock;
}
auto reading(const World& w) { return locked<std::shared_lock<FairMutex>>(w); }
auto writing(const World& w) { return locked<std::unique_lock<FairMutex>>(w); }

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

// A body as asked for, by id or by name; read before the world is locked, since reading may run Python code.
struct Asked {
    std::string text;
    bool by_name;
    BodyId id = -1;
};

Asked asked(nb::handle value, const char* name) {
    if (nb::isinstance<nb::str>(value)) {
        Py_ssize_t length = 0;
        const char* text = PyUnicode_AsUTF8AndSize(value.ptr(), &length);
        if (text) return {std::string(text, length), true};
        PyErr_Clear();  // half of a surrogate pair: no name in UTF-8
        return {nb::repr(value).c_str(), true};
    }
    const nb::object index = nb::steal(PyBool_Check(value.ptr()) ? nullptr : PyNumber_Index(value.ptr()));
    if (!index.is_valid()) {
        PyErr_Clear();
        throw nb::type_error((std::string(name) + ": " + Py_TYPE(value.ptr())->tp_name + ", wanted a body's id or name").c_str());
    }
    int overflow = 0;
    const long long id = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    const bool fits = !overflow && id >= 0 && id <= std::numeric_limits<BodyId>::max();
    return {nb::str(index).c_str(), false, fits ? static_cast<BodyId>(id) : -1};
}

BodyId body_of(const World& w, const Asked& asked, const char* name) {
    const BodyId id = asked.by_name ? w.id_of(asked.text) : asked.id;
    if (w.find(id)) return id;
    if (asked.by_name) fail(std::string(name) + ": no body is named '" + asked.text + "'; world.names tells which are");
    fail(std::string(name) + ": no body " + asked.text + " in this world; world.ids tells which are");
}

BodyId root_of(const World& w, BodyId id, const char* name) {
    const Body& b = w.body(id);
    if (b.carrier >= 0)
        fail(std::string(name) + ": '" + b.name + "' is carried by '" + w.body(b.carrier).name + "'; ask for '" +
             w.body(b.root).name + "', or detach it first");
    return id;
}

BodyId robot_of(const World& w, const Asked& asked, const char* name = "robot") {
    return root_of(w, body_of(w, asked, name), name);
}

// One id or name, or a sequence of them.
struct AskedBodies {
    std::vector<Asked> items;
    bool one;

    std::vector<BodyId> ids(const World& w, const char* name) const {
        std::vector<BodyId> out;
        for (const Asked& a : items) out.push_back(body_of(w, a, name));
        return out;
    }
};

AskedBodies asked_bodies(nb::handle value, const char* name) {
    if (nb::hasattr(value, "ndim") && nb::hasattr(value, "tolist"))
        return asked_bodies(nb::object(value.attr("tolist")()), name);
    if (nb::isinstance<nb::str>(value) || PyIndex_Check(value.ptr())) return {{asked(value, name)}, true};
    if (!nb::hasattr(value, "__iter__"))
        throw nb::type_error((std::string(name) + ": " + Py_TYPE(value.ptr())->tp_name + ", wanted ids or names of bodies").c_str());
    AskedBodies out{{}, false};
    for (nb::handle item : value) out.items.push_back(asked(item, name));
    return out;
}

std::vector<std::string> names_of(nb::handle value, const char* name) {
    if (nb::isinstance<nb::str>(value)) return {nb::cast<std::string>(value)};
    std::vector<std::string> out;
    if (!nb::hasattr(value, "__iter__")) throw nb::type_error((std::string(name) + ": wanted a name or names").c_str());
    for (nb::handle item : value) {
        if (!nb::isinstance<nb::str>(item)) throw nb::type_error((std::string(name) + ": wanted a name or names").c_str());
        out.push_back(nb::cast<std::string>(item));
    }
    return out;
}

Rigid pose_of(nb::handle value, const char* name) {
    const Poses p = poses(value, name);
    if (!p.single()) fail(std::string(name) + ": " + to_string(p.dims) + " poses, wanted one, shape (4, 4)");
    return p[0];
}

nb::object pose_out(const std::vector<Rigid>& poses, const Dims& dims) {
    Output<double> out = make_output<double>(dims, {4, 4});
    for (size_t i = 0; i < poses.size(); ++i) write_pose(poses[i], out.data + 16 * i);
    return nb::cast(out.array);
}

using Tree = std::shared_ptr<const Robot>;  // null: a body that is no robot

// Places as they come: poses (..., 4, 4) of a body, configurations (..., nq) of a robot.
struct Places {
    Tree tree;
    Poses poses;
    Configurations configurations{{}, {}, 0};

    const Dims& dims() const { return tree ? configurations.dims : poses.dims; }
    bool single() const { return dims().empty(); }
    Place operator[](int64_t i) const {
        if (!tree) return {poses[i], {}};
        const double* q = configurations.row(i);
        return {identity(), {q, q + configurations.nq}};
    }
    std::vector<Place> all() const {
        std::vector<Place> out;
        for (int64_t i = 0; i < dims()[0]; ++i) out.push_back((*this)[i]);
        return out;
    }
    const char* row() const { return tree ? ", nq)" : ", 4, 4)"; }
};

Places places(const Tree& tree, nb::handle value, const char* name) {
    Places out;
    out.tree = tree;
    if (tree) out.configurations = configurations(*tree, value, name);
    else out.poses = poses(value, name);
    return out;
}

nb::object places_out(const std::vector<Place>& places, const Tree& tree) {
    const int64_t n = static_cast<int64_t>(places.size());
    if (!tree) {
        std::vector<Rigid> poses;
        for (const Place& p : places) poses.push_back(p.pose);
        return pose_out(poses, {n});
    }
    std::vector<double> rows;
    for (const Place& p : places) rows.insert(rows.end(), p.q.begin(), p.q.end());
    return copy_out(rows.data(), {n, tree->nq()});
}

// Asked before its places are read, which are checked without the lock.
Tree tree_of(const World& w, const Asked& asked, const char* name = "robot") {
    const auto lock = reading(w);
    return w.body(robot_of(w, asked, name)).robot;
}

// The one whose tree that was.
BodyId mover_of(const World& w, const Asked& asked, const Tree& tree, const char* name = "robot") {
    const BodyId id = robot_of(w, asked, name);
    if (w.body(id).robot != tree) fail(std::string(name) + ": '" + asked.text + "' was replaced by another thread");
    return id;
}

// Times (...), or now where there are none.
Array<double> times_of(nb::handle value, const char* name) {
    Array<double> t = doubles(value, name);
    for (size_t i = 0; i < t.view.size(); ++i)
        if (!std::isfinite(t.data()[i])) fail(std::string(name) + ": not finite, wanted seconds");
    return t;
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
                 const std::string& like, nb::handle groups) {
    const Configurations c = configurations(robot, q, "q");
    if (!c.dims.empty()) fail("q: " + to_string(c.dims) + " configurations, wanted one, shape (nq,)");
    std::vector<RobotPart> bodies;
    for (nb::handle p : parts)
        bodies.push_back({nb::cast<std::string>(p[0]), nb::cast<int32_t>(p[1]), nb::cast<std::shared_ptr<Shape>>(p[2]),
                          pose_of(p[3], "parts")});
    const std::vector<std::string> names = names_of(groups, "groups");
    const auto lock = writing(w);
    return w.add_robot(std::make_shared<const Robot>(robot), {c.row(0), c.row(0) + c.nq}, bodies, allowed,
                       name.empty() ? w.unused_name(like) : name, names);
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
    const Tree tree = tree_of(w, a);
    if (!tree) fail("robot: '" + a.text + "' is a body; set_pose places it");
    const Places p = places(tree, q, "q");
    if (!p.single()) fail("q: " + to_string(p.dims()) + " configurations, wanted one, shape (nq,)");
    const auto lock = writing(w);
    w.set_configuration(mover_of(w, a, tree), p[0].q);
}

nb::object configuration(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const Body& b = w.body(robot_of(w, a));
    if (!b.robot) fail("robot: '" + b.name + "' is a body; poses tells where it is");
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
    const Dims wanted = all.one ? Dims{} : Dims{static_cast<int64_t>(bodies.size())};
    const Broadcast shape = broadcast({{"ids", wanted}, {"poses", p.dims}});
    if (shape.dims != wanted) fail("poses: " + to_string(p.dims) + " poses for ids " + to_string(wanted));
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
    const Tree tree = tree_of(w, a, "body");
    Trajectory t;
    if (!times.is_none() || !poses_.is_none()) {
        const Array<double> at = times_of(times, "times");
        const Places p = places(tree, poses_, "poses");
        if (at.dims.size() != 1 || at.dims[0] < 1 || p.dims() != at.dims)
            fail("times " + to_string(at.dims) + " and poses " + to_string(p.dims()) + ": wanted (k,) and (k" + p.row() +
                 ", k at least 1");
        t.times.assign(at.data(), at.data() + at.dims[0]);
        for (size_t i = 1; i < t.times.size(); ++i)
            if (!(t.times[i] > t.times[i - 1])) fail("times[" + std::to_string(i) + "]: not after the one before");
        t.places = p.all();
    }
    const auto lock = writing(w);
    w.set_trajectory(mover_of(w, a, tree, "body"), std::move(t));
}

nb::object id_array(const std::vector<BodyId>& ids) {
    return copy_out(ids.data(), {static_cast<int64_t>(ids.size())});
}

nb::object set_path(World& w, nb::handle robot, nb::handle poses_) {
    const Asked a = asked(robot, "robot");
    const Tree tree = tree_of(w, a);
    const Places p = places(tree, poses_, "poses");
    if (p.dims().size() != 1 || p.dims()[0] == 0)
        fail("poses: " + to_string(p.dims()) + " way points, wanted (K" + p.row() + " with K at least 1");
    const auto lock = writing(w);
    return id_array(w.set_path(mover_of(w, a, tree), p.all()));
}

nb::object candidates(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const BodyId id = robot_of(w, a);
    const Path* p = w.path(id);
    if (!p) fail("robot: '" + w.body(id).name + "' has no path; set_path gives it one");
    return id_array(p->candidates);
}

nb::object motion_boxes(const World& w, nb::handle robot) {
    const Asked a = asked(robot, "robot");
    const auto lock = reading(w);
    const BodyId id = robot_of(w, a);
    const Path* p = w.path(id);
    if (!p) fail("robot: '" + w.body(id).name + "' has no path; set_path gives it one");
    return copy_out(reinterpret_cast<const double*>(p->legs.data()), {static_cast<int64_t>(p->legs.size())}, {2, 3});
}

// Bits of the movers whose motion box the body meets, its own among them.
nb::int_ mask_of(const World& w, const Body& body) {
    nb::int_ out(0);
    std::vector<BodyId> movers = body.movers;
    if (w.path(body.root)) movers.push_back(body.root);
    for (BodyId mover : movers) out = nb::int_(out | (nb::int_(1) << nb::int_(w.own_bit(mover))));
    return out;
}

nb::int_ mask(const World& w, nb::handle body) {
    const Asked a = asked(body, "body");
    const auto lock = reading(w);
    return mask_of(w, w.body(body_of(w, a, "body")));
}

struct Posed {
    Places places;
    Array<double> times;
    bool has_times;
    Broadcast shape;

    double time(int64_t i) const { return has_times ? times.data()[shape.offset(1, i)] : now; }
    Place place(int64_t i) const { return places[shape.offset(0, i)]; }
    bool single() const { return shape.dims.empty(); }
};

Posed posed(const Tree& tree, nb::handle poses_, nb::handle times) {
    Posed out{places(tree, poses_, "poses"), {}, !times.is_none(), {}};
    if (out.has_times) out.times = times_of(times, "times");
    out.shape = broadcast({{"poses", out.places.dims()}, {"times", out.times.dims}});
    return out;
}

nb::object collides(const World& w, nb::handle robot, nb::handle poses_, nb::handle times, double margin,
                    nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Tree tree = tree_of(w, a);
    const Posed p = posed(tree, poses_, times);
    metres_of(margin, "margin");
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, tree);
    if (p.single()) return nb::cast(w.collides(id, p.place(0), p.time(0), margin));
    Output<bool> out = make_output<bool>(p.shape.dims);
    parallel_for(p.shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) out.data[i] = w.collides(id, p.place(i), p.time(i), margin);
    });
    return nb::cast(out.array);
}

nb::object clearance(const World& w, nb::handle robot, nb::handle poses_, nb::handle times, nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Tree tree = tree_of(w, a);
    const Posed p = posed(tree, poses_, times);
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, tree);
    Output<double> distance = make_output<double>(p.shape.dims);
    Output<int32_t> other = make_output<int32_t>(p.shape.dims);
    parallel_for(p.shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const Clearance found = w.clearance(id, p.place(i), p.time(i));
            distance.data[i] = found.distance;
            other.data[i] = found.other;
        }
    });
    return nb::make_tuple(distance.array, other.array);
}

double resolution_of(nb::handle mode, nb::handle value) {
    std::string text;
    if (!nb::try_cast(mode, text) || (text != "continuous" && text != "discrete"))
        fail(std::string("mode: ") + nb::repr(mode).c_str() + " is unknown, wanted continuous or discrete");
    if ((text == "discrete") == value.is_none()) fail("resolution: wanted metres with mode='discrete', and only then");
    double metres = 0;
    if (!value.is_none() && (!nb::try_cast(value, metres) || !(metres > 0) || std::isinf(metres)))
        fail(std::string("resolution: ") + nb::repr(value).c_str() + ", wanted metres, over 0");
    return metres;
}

MotionSettings settings_of(double margin, double tolerance, double resolution, bool first, nb::handle t0,
                           nb::handle t1) {
    MotionSettings s;
    s.certify.margin = metres_of(margin, "margin");
    s.certify.tolerance = metres_of(tolerance, "tolerance");
    if (!(tolerance > 0)) fail("tolerance: wanted metres, over 0");
    s.resolution = resolution;
    s.certify.first = first;
    if (t0.is_none() != t1.is_none()) fail("t0, t1: wanted both (seconds), or neither");
    if (!t0.is_none() && (!nb::try_cast(t0, s.from) || !nb::try_cast(t1, s.to) || !std::isfinite(s.from) ||
                          !std::isfinite(s.to) || s.to < s.from))
        fail("t0, t1: wanted finite seconds, t1 not before t0");
    return s;
}

struct Outcomes {
    Output<bool> free;
    Output<double> contact, contact_by;
    Output<int32_t> other, part;
    Output<int64_t> checks;

    explicit Outcomes(const Dims& dims)
        : free(make_output<bool>(dims)), contact(make_output<double>(dims)), contact_by(make_output<double>(dims)),
          other(make_output<int32_t>(dims)), part(make_output<int32_t>(dims)), checks(make_output<int64_t>(dims)) {}
    void put(int64_t i, const MotionOutcome& o) {
        free.data[i] = !o.contact.found;
        contact.data[i] = o.contact.found ? o.contact.free_until : 1;
        contact_by.data[i] = o.contact.found ? o.contact.shown : HUGE_VAL;
        other.data[i] = o.other;
        part.data[i] = o.part;
        checks.data[i] = o.checks;
    }
    nb::tuple tuple() const {
        return nb::make_tuple(free.array, contact.array, contact_by.array, other.array, part.array, checks.array);
    }
};

nb::tuple check_motion(const World& w, nb::handle robot, nb::handle T0, nb::handle T1, double margin, double tolerance,
                       nb::handle mode, nb::handle resolution, bool first, nb::handle t0, nb::handle t1,
                       nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Tree tree = tree_of(w, a);
    const Places from = places(tree, T0, "T0"), to = places(tree, T1, "T1");
    const MotionSettings s = settings_of(margin, tolerance, resolution_of(mode, resolution), first, t0, t1);
    const Broadcast shape = broadcast({{"T0", from.dims()}, {"T1", to.dims()}});
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, tree);
    if (shape.dims.empty()) {
        const MotionOutcome o = w.check_motion(id, from[0], to[0], s);
        return nb::make_tuple(!o.contact.found, o.contact.found ? o.contact.free_until : 1.0,
                              o.contact.found ? o.contact.shown : HUGE_VAL, o.other, o.part, o.checks);
    }
    Outcomes out(shape.dims);
    parallel_for(shape.size, n, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i)
            out.put(i, w.check_motion(id, from[shape.offset(0, i)], to[shape.offset(1, i)], s));
    });
    return out.tuple();
}

// Of movers that are asked together: all bodies, or robots with the same coordinates.
std::vector<Tree> trees_of(const World& w, const AskedBodies& all, const char* name) {
    const auto lock = reading(w);
    std::vector<Tree> out;
    for (const Asked& a : all.items) {
        out.push_back(w.body(robot_of(w, a, name)).robot);
        const Tree &first = out[0], &last = out.back();
        if (!first != !last || (first && (first->coordinates != last->coordinates || first->most != last->most)))
            fail(std::string(name) + ": '" + a.text + "' has other coordinates than '" + all.items[0].text +
                 "', wanted bodies alone, or robots of one kind");
    }
    return out;
}

void refuse_twice(std::vector<BodyId> ids) {
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice != ids.end()) fail("robots: body " + std::to_string(*twice) + " is named twice");
}

// Of many movers, found with the interpreter free.
template <class F>
nb::tuple outcomes_of(F find) {
    std::vector<MotionOutcome> found;
    {
        nb::gil_scoped_release released;
        found = find();
    }
    Outcomes out({static_cast<int64_t>(found.size())});
    for (size_t i = 0; i < found.size(); ++i) out.put(static_cast<int64_t>(i), found[i]);
    return out.tuple();
}

nb::tuple check_motions(const World& w, nb::handle robots, nb::handle T0, nb::handle T1, double margin,
                        double tolerance, nb::handle t0, nb::handle t1) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Tree> trees = trees_of(w, all, "robots");
    const Tree tree = trees.empty() ? nullptr : trees[0];
    const Places from = places(tree, T0, "T0"), to = places(tree, T1, "T1");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, t0, t1);
    const auto lock = reading(w);
    const std::vector<BodyId> ids = all.ids(w, "robots");
    const Dims wanted{static_cast<int64_t>(ids.size())};
    const Broadcast shape = broadcast({{"robots", wanted}, {"T0", from.dims()}, {"T1", to.dims()}});
    if (all.one || shape.dims != wanted)
        fail(std::string("robots, T0, T1: wanted (n,), ") + (tree ? "(n, nq), (n, nq)" : "(n, 4, 4), (n, 4, 4)"));
    refuse_twice(ids);
    std::vector<Place> begin, end;
    for (size_t i = 0; i < ids.size(); ++i) {
        mover_of(w, all.items[i], trees[i], "robots");
        begin.push_back(from[shape.offset(1, static_cast<int64_t>(i))]);
        end.push_back(to[shape.offset(2, static_cast<int64_t>(i))]);
    }
    return outcomes_of([&] { return w.check_motions(ids, begin, end, s); });
}

nb::tuple advance(World& w, nb::handle robots, nb::handle to, double margin, double tolerance, nb::handle t0,
                  nb::handle t1) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Tree> trees = trees_of(w, all, "robots");
    const Places ends = places(trees.empty() ? nullptr : trees[0], to, "to");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, t0, t1);
    const auto lock = writing(w);
    std::vector<BodyId> ids;
    for (size_t i = 0; i < all.items.size(); ++i) ids.push_back(mover_of(w, all.items[i], trees[i], "robots"));
    refuse_twice(ids);
    if (all.one || ends.dims() != Dims{static_cast<int64_t>(ids.size())})
        fail(std::string("robots, to: wanted (n,) and (n") + ends.row());
    const std::vector<Place> there = ends.all();
    return outcomes_of([&] { return w.advance(ids, there, s); });
}

nb::object contacts(const World& w, double margin, nb::handle threads) {
    metres_of(margin, "margin");
    const int n = threads_of(threads);
    const auto lock = reading(w);
    std::vector<std::pair<BodyId, BodyId>> pairs;
    std::mutex gathering;
    parallel_for(w.blocks(), n, [&](int64_t first, int64_t last) {
        std::vector<std::pair<BodyId, BodyId>> found;
        for (int64_t block = first; block < last; ++block)
            w.contacts_of_block(static_cast<int32_t>(block), margin, found);
        const std::lock_guard<std::mutex> guard(gathering);
        pairs.insert(pairs.end(), found.begin(), found.end());
    }, 16);
    std::sort(pairs.begin(), pairs.end());
    std::vector<int32_t> rows;
    for (const auto& [a, b] : pairs) rows.insert(rows.end(), {a, b});
    return copy_out(rows.data(), {static_cast<int64_t>(rows.size() / 2)}, {2});
}

nb::object raycast(const World& w, nb::handle origins, nb::handle directions, double max_distance, nb::handle ignored,
                   nb::handle threads) {
    const Array<double> o = points(origins, "origins"), d = directions_of(directions, "directions");
    if (!(max_distance >= 0)) fail("max_distance: wanted metres, 0 or more");
    const Broadcast shape = broadcast({{"origins", rows_of(o)}, {"directions", rows_of(d)}});
    const int n = threads_of(threads);
    Output<double> distance = make_output<double>(shape.dims);
    Output<int32_t> body = make_output<int32_t>(shape.dims);
    const AskedBodies ignore = ignored.is_none() ? AskedBodies{{}, false} : asked_bodies(ignored, "ignore");
    const auto lock = reading(w);
    std::vector<BodyId> skip = ignore.ids(w, "ignore");
    std::sort(skip.begin(), skip.end());
    parallel_for(shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const double* p = o.data() + 3 * shape.offset(0, i);
            const WorldHit hit = w.raycast({p[0], p[1], p[2]}, direction_of(d.data() + 3 * shape.offset(1, i)), max_distance, skip);
            distance.data[i] = hit.distance;
            body.data[i] = hit.body;
        }
    });
    return nb::make_tuple(distance.array, body.array);
}

// All of a body that a record or a pickle needs.
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

const char* name_of(Masks masks) {
    return masks == Masks::path ? "path" : masks == Masks::off ? "off" : "published";
}

// All of a world, of one moment.
nb::dict state(const World& w) {
    const auto lock = reading(w);
    nb::list bodies, allowed_groups;
    for_each_body(w, [&](const Body& b) { bodies.append(record_of(w, b)); });
    for (const auto& [a, b] : w.allowed_groups()) allowed_groups.append(nb::make_tuple(w.groups()[a], w.groups()[b]));
    nb::dict out;
    out["masks"] = name_of(w.masks());
    out["end_id"] = w.end_id();
    out["allowed_groups"] = allowed_groups;
    out["bodies"] = bodies;
    return out;
}

// Fills a new world with what `state` told; `robots`: the trees of bodies that are robots, by id.
void restore(World& w, const nb::dict& state, const nb::dict& robots) {
    const nb::list bodies(state["bodies"]);
    const auto id_of = [](nb::handle b) { return nb::cast<BodyId>(b["id"]); };
    for (nb::handle b : bodies)
        w.add(nb::cast<std::shared_ptr<Shape>>(b["shape"]), pose_of(b["pose"], "pose"), nb::cast<std::string>(b["name"]),
              nb::cast<std::vector<std::string>>(b["groups"]), id_of(b));
    for (nb::handle b : bodies) {
        World::Bond bond{nb::cast<BodyId>(b["carrier"]), nb::cast<BodyId>(b["root"]), nb::cast<int32_t>(b["link"]),
                         pose_of(b["offset"], "offset"), nb::cast<bool>(b["built_in"]),
                         nb::cast<std::vector<BodyId>>(b["parts"]), nullptr, {}};
        if (!b["configuration"].is_none()) {
            bond.robot = std::make_shared<const Robot>(nb::cast<const Robot&>(robots[b["id"]]));
            bond.q = places(bond.robot, b["configuration"], "configuration")[0].q;
        }
        w.restore(id_of(b), std::move(bond));
    }
    for (nb::handle b : bodies)
        for (BodyId other : nb::cast<std::vector<BodyId>>(b["allowed"])) w.allow(id_of(b), other, true);
    for (nb::handle pair : state["allowed_groups"])
        w.allow_groups(nb::cast<std::string>(pair[0]), nb::cast<std::string>(pair[1]), true);
    for (nb::handle b : bodies)
        if (!b["trajectory"][0].is_none()) set_trajectory(w, b["id"], b["trajectory"][0], b["trajectory"][1]);
    for (nb::handle b : bodies)
        if (!b["path"].is_none())
            w.set_path(id_of(b), places(w.body(id_of(b)).robot, b["path"], "path").all(), nb::cast<int>(b["bit"]));
    w.set_end_id(nb::cast<BodyId>(state["end_id"]));
}

Masks masks_of(const std::string& name) {
    if (name == "path") return Masks::path;
    if (name == "published") return Masks::published;
    if (name == "off") return Masks::off;
    fail("masks: '" + name + "' is unknown, wanted path, published or off");
}

}  // namespace

void bind_world(nb::module_& m) {
    nb::class_<World>(m, "World")
        .def("__init__", [](World* self, const std::string& masks) { new (self) World(masks_of(masks)); }, "masks"_a)
        .def("copy_from", [](World* self, const World& other) {
            const auto lock = reading(other);
            self->~World();
            new (self) World(other);
        })
        .def("add_body", &add, "shape"_a, "pose"_a.none(), "name"_a, "groups"_a.none(), "id"_a)
        .def("state", &state)
        .def("restore", &restore, "state"_a, "robots"_a)
        .def("add_robot", &add_robot, "robot"_a, "q"_a.none(), "parts"_a, "allowed"_a, "name"_a, "like"_a,
             "groups"_a.none())
        .def("remove", &remove, "body"_a.none())
        .def("set_configuration", &set_configuration, "robot"_a.none(), "q"_a.none())
        .def("configuration", &configuration, "robot"_a.none())
        .def("parts", &parts, "robot"_a.none())
        .def("set_pose", &set_pose, "ids"_a.none(), "poses"_a.none())
        .def("poses", &get_poses, "ids"_a.none())
        .def("attach", [](World& w, nb::handle body, nb::handle carrier) {
            const Asked a = asked(body, "body"), b = asked(carrier, "carrier");
            const auto lock = writing(w);
            w.attach(body_of(w, a, "body"), body_of(w, b, "carrier"));
        }, "body"_a.none(), "carrier"_a.none())
        .def("detach", [](World& w, nb::handle body) {
            const Asked a = asked(body, "body");
            const auto lock = writing(w);
            w.detach(body_of(w, a, "body"));
        }, "body"_a.none())
        .def("allow", [](World& w, nb::handle a, nb::handle b, bool allowed) {
            const Asked first = asked(a, "a"), second = asked(b, "b");
            const auto lock = writing(w);
            w.allow(body_of(w, first, "a"), body_of(w, second, "b"), allowed);
        }, "a"_a.none(), "b"_a.none(), "allowed"_a)
        .def("allow_groups", [](World& w, const std::string& a, const std::string& b, bool allowed) {
            const auto lock = writing(w);
            w.allow_groups(a, b, allowed);
        }, "a"_a, "b"_a, "allowed"_a)
        .def("set_trajectory", &set_trajectory, "body"_a.none(), "times"_a.none(), "poses"_a.none())
        .def("set_path", &set_path, "robot"_a.none(), "poses"_a.none())
        .def("clear_path", [](World& w, nb::handle robot) {
            const Asked a = asked(robot, "robot");
            const auto lock = writing(w);
            w.clear_path(robot_of(w, a));
        }, "robot"_a.none())
        .def("candidates", &candidates, "robot"_a.none())
        .def("motion_boxes", &motion_boxes, "robot"_a.none())
        .def("mask", &mask, "body"_a.none())
        .def("own_bit", [](const World& w, nb::handle robot) {
            const Asked a = asked(robot, "robot");
            const auto lock = reading(w);
            return w.own_bit(robot_of(w, a));
        }, "robot"_a.none())
        .def("collides", &collides, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), "margin"_a, "threads"_a.none())
        .def("clearance", &clearance, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), "threads"_a.none())
        .def("check_motion", &check_motion, "robot"_a.none(), "T0"_a.none(), "T1"_a.none(), "margin"_a, "tolerance"_a,
             "mode"_a.none(), "resolution"_a.none(), "first"_a, "t0"_a.none(), "t1"_a.none(), "threads"_a.none())
        .def("check_motions", &check_motions, "robots"_a.none(), "T0"_a.none(), "T1"_a.none(), "margin"_a,
             "tolerance"_a, "t0"_a.none(), "t1"_a.none())
        .def("advance", &advance, "robots"_a.none(), "to"_a.none(), "margin"_a, "tolerance"_a, "t0"_a.none(), "t1"_a.none())
        .def("contacts", &contacts, "margin"_a, "threads"_a.none())
        .def("raycast", &raycast, "origins"_a.none(), "directions"_a.none(), "max_distance"_a, "ignore"_a.none(),
             "threads"_a.none())
        .def("record", &record, "body"_a.none())
        .def("ids", &ids)
        .def("names", &names)
        .def("masks", [](const World& w) { return name_of(w.masks()); })
        .def("tests", [](const World& w) { return w.tests(); })
        .def("nbytes", [](const World& w) {
            const auto lock = reading(w);
            return w.nbytes();
        })
        .def("__len__", [](const World& w) {
            const auto lock = reading(w);
            return w.size();
        });
}

}  // namespace fgenv
