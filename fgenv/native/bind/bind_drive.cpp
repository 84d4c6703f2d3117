// Python class of a drive: limits of actions, and the motion of a robot by them.
#include "bind/bind_drive.h"

#include <nanobind/stl/vector.h>

#include "bind/arguments.h"
#include "bind/bind.h"
#include "bind/configurations.h"

namespace fgenv {
namespace {

using namespace nb::literals;

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

// Rows (..., n) of numbers.
Array<double> rows(nb::handle value, const char* name, int32_t n) {
    Array<double> out = doubles(value, name);
    if (out.dims.empty() || out.dims.back() != n)
        fail(std::string(name) + ": got shape " + to_string(out.dims) + ", expected (..., " + std::to_string(n) + ")");
    return out;
}

void make_drive(Drive* self, const std::string& kind, std::vector<double> parameters, nb::handle limits,
                std::vector<double> lower, std::vector<double> upper) {
    Drive drive{find_drive_kernel(kind), std::move(parameters), {}, std::move(lower), std::move(upper)};
    if (!drive.kernel && kind != "none") fail("drive: got '" + kind + "', expected none, " + drive_kernel_names());
    const Array<double> table = rows(limits, "limits", 3);
    for (size_t i = 0; i < table.view.size(); i += 3)
        drive.limits.push_back({table.data()[i], table.data()[i + 1], table.data()[i + 2]});
    const int32_t n = drive.kernel ? drive.kernel->n_parameters : 0;
    if (static_cast<int32_t>(drive.parameters.size()) != n)
        fail("parameters: got " + std::to_string(drive.parameters.size()) + ", expected " + std::to_string(n));
    if (drive.n_actions() < drive.n_base_actions() || drive.lower.size() != drive.upper.size())
        fail("limits, lower, upper: got lists of wrong lengths, expected one entry per action or coordinate");
    new (self) Drive(std::move(drive));
}

nb::object limit_all(const Drive& drive, nb::handle command, nb::handle before, double dt) {
    const int32_t n = drive.n_actions();
    const Array<double> c = rows(command, "command", n), b = rows(before, "before", n);
    if (c.dims != b.dims) fail("command, before: got different shapes, expected equal ones");
    Output<double> out = make_output<double>(c.dims);
    for (size_t i = 0; i < c.view.size(); i += n) limit_action(drive, c.data() + i, b.data() + i, dt, out.data + i);
    return nb::cast(out.array);
}

nb::object forward_all(const Drive& drive, const Robot& robot, nb::handle action, nb::handle q, double dt) {
    check_fits(robot, drive);
    const Configurations from = configurations(robot, q, "q");
    const Array<double> a = rows(action, "action", drive.n_actions());
    const Broadcast shape = broadcast({{"action", rows_of(a)}, {"q", from.dims}});
    Output<double> out = make_output<double>(shape.dims, {robot.nq()});
    for (int64_t i = 0; i < shape.size; ++i)
        drive_forward(robot, drive, a.data() + shape.offset(0, i) * drive.n_actions(), from.row(shape.offset(1, i)), dt,
                      out.data + i * robot.nq());
    return nb::cast(out.array);
}

}  // namespace

void check_fits(const Robot& robot, const Drive& drive) {
    const JointKind base = robot.joints[0].kind;
    const int32_t joints = drive.n_actions() - drive.n_base_actions();
    const bool moves = base == JointKind::planar || (base == JointKind::free && drive.n_base_actions() == 4);
    if ((drive.kernel && !moves) || (joints != 0 && joints != robot.nq() - size(base)) ||
        static_cast<int32_t>(drive.lower.size()) != robot.nq())
        fail("drive: got one of another robot, expected one made for this robot");
}

void bind_drive(nb::module_& m) {
    nb::class_<Drive>(m, "Drive")
        .def("__init__", &make_drive, "kind"_a, "parameters"_a, "limits"_a, nb::kw_only(), "lower"_a, "upper"_a)
        .def("limit", &limit_all, "command"_a, "before"_a, "dt"_a)
        .def("forward", &forward_all, "robot"_a, "action"_a, "q"_a, "dt"_a);
}

}  // namespace fgenv
