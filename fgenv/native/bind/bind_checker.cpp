// A world's checker as callbacks for OMPL. The state space's `serialize` writes states directly into buffers of
// the checker, without Python code in between.
#include "bind/bind.h"

#include <nanobind/stl/vector.h>

#include "bind/bind_world.h"
#include "world/checker.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr int64_t hear = 64;  // callbacks between checks for Ctrl-C

// An error in a callback is stored and raised after the planner returns: some planners call back from code in
// which an exception would end the process.
class BoundChecker {
public:
    BoundChecker(nb::object world, std::vector<Member> members, const MotionSettings& settings)
        : world_(nb::cast<const World&>(world)),
          kept_(std::move(world)),
          checker(world_, std::move(members), settings),
          from_(checker.size()),
          to_(checker.size()) {}

    void serve(nb::object serialize) {
        serialize_ = std::move(serialize);
        // nanobind takes a capsule of this name for a void*; it keeps the pointer to the name.
        into_from_ = nb::steal(PyCapsule_New(from_.data(), "nb_handle", nullptr));
        into_to_ = nb::steal(PyCapsule_New(to_.data(), "nb_handle", nullptr));
    }
    // Calls `stop` after an error, or after this number of calls (0: no limit). Clears a stored error.
    void watch(nb::object stop, int64_t most) {
        stop_ = std::move(stop);
        last_ = most ? calls_ + most : 0;
        error = nb::none();
    }

    bool valid(PyObject* state) {
        return guarded([&] {
            const auto lock = reading(world_);  // first, because waiting for it lets other threads run
            read(state, into_to_);
            return checker.valid(to_.data());
        });
    }
    bool free(PyObject* from, PyObject* to) {
        return guarded([&] {
            const auto lock = reading(world_);
            read(from, into_from_);
            read(to, into_to_);
            return checker.free(from_.data(), to_.data());
        });
    }
    double clearance(PyObject* state) {
        double found = 0;
        guarded([&] {
            const auto lock = reading(world_);
            read(state, into_to_);
            found = checker.clearance(to_.data());
            return true;
        });
        return found;
    }

    const World& world_;
    nb::object kept_;
    Checker checker;
    nb::object error = nb::none();

private:
    template <class F>
    bool guarded(const F& ask) {
        if (!error.is_none()) return false;
        try {
            if (++calls_ % hear == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
            if (calls_ == last_) end();
            return ask();
        } catch (nb::python_error& e) {
            keep(nb::borrow(e.value()));
        } catch (const std::exception& e) {
            keep(nb::handle(PyExc_ValueError)(e.what()));
        }
        return false;
    }
    void keep(nb::object raised) {
        error = std::move(raised);
        end();
    }
    void end() {
        if (stop_.is_none()) return;
        PyObject* done = PyObject_CallNoArgs(stop_.ptr());
        if (done)
            Py_DECREF(done);
        else
            PyErr_Clear();
    }
    void read(PyObject* state, const nb::object& into) {
        if (!serialize_.is_valid())
            throw std::invalid_argument("serve: got a callback before the first call, expected serve first");
        PyObject* args[2] = {into.ptr(), state};
        PyObject* done = PyObject_Vectorcall(serialize_.ptr(), args, 2, nullptr);
        if (!done) throw nb::python_error();
        Py_DECREF(done);
    }

    std::vector<double> from_, to_;
    nb::object serialize_, stop_ = nb::none(), into_from_, into_to_;
    int64_t calls_ = 0, last_ = 0;
};

BoundChecker& bound(PyObject* self) { return *nb::inst_ptr<BoundChecker>(self); }

bool takes(Py_ssize_t n, Py_ssize_t expected) {
    if (n == expected) return true;
    PyErr_Format(PyExc_TypeError, "%zd arguments, expected %zd", n, expected);
    return false;
}

PyObject* call_valid(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    return takes(n, 1) ? PyBool_FromLong(bound(self).valid(args[0])) : nullptr;
}
PyObject* call_free(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    return takes(n, 2) ? PyBool_FromLong(bound(self).free(args[0], args[1])) : nullptr;
}
PyObject* call_clearance(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    return takes(n, 1) ? PyFloat_FromDouble(bound(self).clearance(args[0])) : nullptr;
}

template <auto F>
nb::object callable(nb::handle self, const char* name) {
    static PyMethodDef def{name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(F)), METH_FASTCALL,
                           nullptr};
    return nb::steal(PyCFunction_NewEx(&def, self.ptr(), nullptr));
}

std::vector<Member> members_of(const World& w, const std::vector<Asked>& all, const std::vector<int>& sizes,
                               const std::vector<int>& ways, const std::vector<double>& radii,
                               const std::vector<bool>& reverse, const std::vector<std::vector<double>>& regions) {
    if (sizes.size() != all.size() || ways.size() != all.size() || radii.size() != all.size() ||
        reverse.size() != all.size())
        fail("sizes, ways, radii, reverse: got another length, expected one entry per robot");
    if (!regions.empty() && regions.size() != all.size())
        fail("regions: got " + std::to_string(regions.size()) + ", expected one per robot");
    std::vector<Member> out;
    const auto lock = reading(w);
    for (size_t i = 0; i < all.size(); ++i) {
        const BodyId id = robot_of(w, all[i], "robots");
        const Model model = w.body(id).robot;
        if (ways[i] < 0 || ways[i] > 3 || !(radii[i] > 0))
            fail("ways, radii: got " + std::to_string(ways[i]) + ", " + number(radii[i]) +
                 ", expected 0 to 3, and meters above 0");
        const bool free = model && model->joints[0].kind == JointKind::free;
        const bool fits =
            model ? sizes[i] == model->nq() || (free && sizes[i] == model->nq() - 3) : sizes[i] == 3 || sizes[i] == 7;
        if (!fits)
            fail("sizes: got " + std::to_string(sizes[i]) + " for '" + w.body(id).name + "', expected " +
                 (model ? std::to_string(model->nq()) : std::string("3 (SE2) or 7 (SE3)")));
        const bool planar = model && model->joints[0].kind == JointKind::planar;
        if (ways[i] != 0 && !planar)
            fail("ways: got " + std::to_string(ways[i]) + " for '" + w.body(id).name +
                 "' without a planar base, expected 0 (straight)");
        for (const Member& m : out)
            if (m.id == id) fail("robots: got '" + w.body(id).name + "' twice, expected distinct robots");
        out.push_back({id, model, sizes[i], {static_cast<SteeringMethod>(ways[i]), radii[i], reverse[i]}});
        if (regions.empty()) continue;
        if (regions[i].size() != 4)
            fail("regions: got " + std::to_string(regions[i].size()) +
                 " numbers, expected 4: minimum x, y, maximum x, y");
        for (int k = 0; k < 4; ++k) out.back().room[k / 2][k % 2] = regions[i][k];
    }
    return out;
}

void make_checker(BoundChecker* self, nb::object world, nb::handle robots, const std::vector<int>& sizes,
                  const std::vector<int>& ways, const std::vector<double>& radii, const std::vector<bool>& reverse,
                  double margin, double tolerance, double resolution, const std::vector<std::vector<double>>& regions) {
    const World& w = nb::cast<const World&>(world);
    MotionSettings s;
    if (!(margin >= 0) || std::isinf(margin)) fail("margin: got " + number(margin) + ", expected at least 0 meters");
    if (!(tolerance > 0) || std::isinf(tolerance))
        fail("tolerance: got " + number(tolerance) + ", expected meters above 0");
    if (!(resolution >= 0) || std::isinf(resolution))
        fail("resolution: got " + number(resolution) + ", expected meters above 0");
    s.certify.margin = margin;
    s.certify.tolerance = tolerance;
    s.resolution = resolution;
    const AskedBodies all = asked_bodies(robots, "robots");
    std::vector<Member> members = members_of(w, all.items, sizes, ways, radii, reverse, regions);
    if (members.empty()) fail("robots: got none, expected at least one");
    new (self) BoundChecker(std::move(world), std::move(members), s);
}

// States (..., n) from NumPy.
struct States {
    Array<double> array;
    Dims dims;
    const double* row(int64_t i, int32_t n) const { return array.data() + i * n; }
};
States states(nb::handle value, int32_t n, const char* name) {
    States out{doubles(value, name), {}};
    const Dims& dims = out.array.dims;
    if (dims.empty() || dims.back() != n)
        fail(std::string(name) + ": got shape " + to_string(dims) + ", expected (..., " + std::to_string(n) + ")");
    out.dims.assign(dims.begin(), dims.end() - 1);
    return out;
}

constexpr int64_t pause = 16;  // rows between checks for Ctrl-C

// One result per row as an array, or a scalar for a single row.
template <class T, class F>
nb::object answers(const BoundChecker& b, const Broadcast& shape, const F& ask) {
    Output<T> out = make_output<T>(shape.dims);
    for (int64_t i = 0; i < shape.size; ++i) {
        if (i % pause == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
        const auto lock = reading(b.world_);
        out.data[i] = ask(i);
    }
    return shape.dims.empty() ? nb::cast(out.data[0]) : nb::cast(out.array);
}

nb::object valid_all(BoundChecker& b, nb::handle q) {
    const States at = states(q, b.checker.size(), "q");
    return answers<bool>(b, broadcast({{"q", at.dims}}),
                         [&](int64_t i) { return b.checker.valid(at.row(i, b.checker.size())); });
}

nb::object clearance_all(BoundChecker& b, nb::handle q) {
    const States at = states(q, b.checker.size(), "q");
    return answers<double>(b, broadcast({{"q", at.dims}}),
                           [&](int64_t i) { return b.checker.clearance(at.row(i, b.checker.size())); });
}

nb::object free_all(BoundChecker& b, nb::handle q0, nb::handle q1) {
    const int32_t n = b.checker.size();
    const States from = states(q0, n, "q0"), to = states(q1, n, "q1");
    const Broadcast shape = broadcast({{"q0", from.dims}, {"q1", to.dims}});
    return answers<bool>(b, shape, [&](int64_t i) {
        return b.checker.free(from.row(shape.offset(0, i), n), to.row(shape.offset(1, i), n));
    });
}

nb::object legs_of(const Robot& robot, nb::handle q0, nb::handle q1, int way, double radius, bool reverse) {
    const Configurations from = configurations(robot, q0, "q0"), to = configurations(robot, q1, "q1");
    if (!from.dims.empty() || !to.dims.empty())
        fail("q0, q1: got arrays of configurations, expected one configuration each");
    if (way < 0 || way > 3 || !(radius > 0))
        fail("way, radius: got " + std::to_string(way) + ", " + number(radius) +
             ", expected 0 to 3, and meters above 0");
    if (way != 0 && robot.joints[0].kind != JointKind::planar)
        fail("way: got " + std::to_string(way) + " for a robot without a planar base, expected 0 (straight)");
    std::vector<double> rows;
    legs(robot, {static_cast<SteeringMethod>(way), radius, reverse}, from.row(0), to.row(0), rows);
    return copy_out(rows.data(), {static_cast<int64_t>(rows.size()) / robot.nq()}, {robot.nq()});
}

}  // namespace

void bind_checker(nb::module_& m) {
    nb::class_<BoundChecker>(m, "Checker")
        .def("__init__", &make_checker, "world"_a, "robots"_a.none(), "sizes"_a, nb::kw_only(), "ways"_a, "radii"_a,
             "reverse"_a, "margin"_a, "tolerance"_a, "resolution"_a, "regions"_a)
        .def(
            "serve",
            [](nb::handle self, nb::object serialize) {
                nb::cast<BoundChecker&>(self).serve(std::move(serialize));
                return nb::make_tuple(callable<&call_valid>(self, "isValid"), callable<&call_free>(self, "checkMotion"),
                                      callable<&call_clearance>(self, "clearance"));
            },
            "serialize"_a)
        .def("watch", &BoundChecker::watch, "stop"_a.none(), "most"_a)
        .def("valid", &valid_all, "q"_a.none())
        .def("free", &free_all, "q0"_a.none(), "q1"_a.none())
        .def("clearance", &clearance_all, "q"_a.none())
        .def("error", [](const BoundChecker& b) { return b.error; })
        .def("size", [](const BoundChecker& b) { return b.checker.size(); })
        .def("counts", [](const BoundChecker& b) { return std::make_pair(b.checker.states, b.checker.motions); });
    m.def("legs", &legs_of, "robot"_a, "q0"_a.none(), "q1"_a.none(), nb::kw_only(), "way"_a, "radius"_a, "reverse"_a);
}

}  // namespace fgenv
