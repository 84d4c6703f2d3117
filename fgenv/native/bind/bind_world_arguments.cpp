#include "bind/bind_world.h"

#include <limits>

namespace fgenv {

Asked asked(nb::handle value, const char* name) {
    if (nb::isinstance<nb::str>(value)) {
        Py_ssize_t length = 0;
        const char* text = PyUnicode_AsUTF8AndSize(value.ptr(), &length);
        if (text) return {true, -1, std::string(text, length)};
        PyErr_Clear();  // half of a surrogate pair: no name in UTF-8
        return {true, -1, nb::repr(value).c_str()};
    }
    const nb::object index = nb::steal(PyBool_Check(value.ptr()) ? nullptr : PyNumber_Index(value.ptr()));
    if (!index.is_valid()) {
        PyErr_Clear();
        throw nb::type_error(
            (std::string(name) + ": got " + Py_TYPE(value.ptr())->tp_name + ", expected a body's id or name").c_str());
    }
    int overflow = 0;
    const long long id = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    if (!overflow && id >= 0 && id <= std::numeric_limits<BodyId>::max()) return {false, static_cast<BodyId>(id), {}};
    return {false, -1, nb::str(index).c_str()};
}

BodyId body_of(const World& w, const Asked& asked, const char* name) {
    const BodyId id = asked.by_name ? w.id_of(asked.words) : asked.id;
    if (w.find(id)) return id;
    if (asked.by_name)
        fail(std::string(name) + ": got '" + asked.text() + "', expected the name of a body; world.names lists them");
    fail(std::string(name) + ": got " + asked.text() + ", expected the id of a body; world.ids lists them");
}

BodyId root_of(const World& w, BodyId id, const char* name) {
    const Body& b = w.body(id);
    if (b.carrier >= 0)
        fail(std::string(name) + ": got '" + b.name + "', carried by '" + w.body(b.carrier).name +
             "', expected a root; use '" + w.body(b.root).name + "', or detach the body first");
    return id;
}

BodyId robot_of(const World& w, const Asked& asked, const char* name) {
    return root_of(w, body_of(w, asked, name), name);
}

std::vector<BodyId> AskedBodies::ids(const World& w, const char* name) const {
    std::vector<BodyId> out;
    for (const Asked& a : items) out.push_back(body_of(w, a, name));
    return out;
}

AskedBodies asked_bodies(nb::handle value, const char* name) {
    if (nb::hasattr(value, "ndim") && nb::hasattr(value, "tolist"))
        return asked_bodies(nb::object(value.attr("tolist")()), name);
    if (nb::isinstance<nb::str>(value) || PyIndex_Check(value.ptr())) return {{asked(value, name)}, true};
    if (!nb::hasattr(value, "__iter__"))
        throw nb::type_error(
            (std::string(name) + ": got " + Py_TYPE(value.ptr())->tp_name + ", expected ids or names of bodies")
                .c_str());
    AskedBodies out{{}, false};
    for (nb::handle item : value) out.items.push_back(asked(item, name));
    return out;
}

Rigid pose_of(nb::handle value, const char* name) {
    const Poses p = poses(value, name);
    if (!p.single()) fail(std::string(name) + ": got " + to_string(p.dims) + " poses, expected one, shape (4, 4)");
    return p[0];
}

nb::object pose_out(const std::vector<Rigid>& poses, const Dims& dims) {
    Output<double> out = make_output<double>(dims, {4, 4});
    for (size_t i = 0; i < poses.size(); ++i) write_pose(poses[i], out.data + 16 * i);
    return nb::cast(out.array);
}

Places places(const Model& model, nb::handle value, const char* name) {
    Places out;
    out.model = model;
    if (model)
        out.configurations = configurations(*model, value, name);
    else
        out.poses = poses(value, name);
    return out;
}

nb::object places_out(const std::vector<Place>& places, const Model& model) {
    const int64_t n = static_cast<int64_t>(places.size());
    if (!model) {
        std::vector<Rigid> poses;
        for (const Place& p : places) poses.push_back(p.pose);
        return pose_out(poses, {n});
    }
    std::vector<double> rows;
    for (const Place& p : places) rows.insert(rows.end(), p.q.begin(), p.q.end());
    return copy_out(rows.data(), {n, model->nq()});
}

Model model_of(const World& w, const Asked& asked, const char* name) {
    const auto lock = reading(w);
    return w.body(robot_of(w, asked, name)).robot;
}

BodyId mover_of(const World& w, const Asked& asked, const Model& model, const char* name) {
    const BodyId id = robot_of(w, asked, name);
    if (w.body(id).robot != model)
        fail(std::string(name) + ": got '" + asked.text() +
             "', replaced by another thread, expected the same body during the call");
    return id;
}

Array<double> times_of(nb::handle value, const char* name) {
    Array<double> t = doubles(value, name);
    for (size_t i = 0; i < t.view.size(); ++i)
        if (!std::isfinite(t.data()[i]))
            fail(std::string(name) + ": got " + number(t.data()[i]) + ", expected finite seconds");
    return t;
}

Trajectory trajectory_of(const Model& model, nb::handle times, nb::handle poses) {
    Trajectory t;
    const Array<double> at = times_of(times, "times");
    const Places p = places(model, poses, "poses");
    if (at.dims.size() != 1 || at.dims[0] < 1 || p.dims() != at.dims)
        fail("times, poses: got " + to_string(at.dims) + " and " + to_string(p.dims()) + ", expected (k,) and (k" +
             p.row() + ", k at least 1");
    t.times.assign(at.data(), at.data() + at.dims[0]);
    for (size_t i = 1; i < t.times.size(); ++i)
        if (!(t.times[i] > t.times[i - 1]))
            fail("times[" + std::to_string(i) + "]: got a time not after the previous one, expected ascending times");
    t.places = p.all();
    return t;
}

nb::object id_array(const std::vector<BodyId>& ids) { return copy_out(ids.data(), {static_cast<int64_t>(ids.size())}); }

nb::int_ mask_of(const World& w, const Body& body) {
    nb::int_ out(0);
    std::vector<BodyId> movers = body.movers;
    if (w.path(body.root)) movers.push_back(body.root);
    for (BodyId mover : movers) out = nb::int_(out | (nb::int_(1) << nb::int_(w.own_bit(mover))));
    return out;
}

}  // namespace fgenv
