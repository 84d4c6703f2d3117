#include "bind/configurations.h"

namespace fgenv {
namespace {

constexpr double unit_tolerance = 1e-3;  // of a quaternion's length

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

}  // namespace

Configurations configurations(const Robot& robot, nb::handle value, const char* name) {
    Configurations out{doubles(value, name), {}, robot.nq()};
    const Dims& dims = out.array.dims;
    const std::string label = name;
    if (dims.empty() || dims.back() != out.nq)
        fail(label + ": got shape " + to_string(dims) + ", expected configurations (..., " + std::to_string(out.nq) +
             ")");
    out.dims.assign(dims.begin(), dims.end() - 1);
    const auto place = [&](size_t i) {
        return label + index_text(dims, static_cast<int64_t>(i)) + " ('" + robot.names[i % out.nq] + "')";
    };
    for (size_t i = 0; i < out.array.view.size(); ++i) {
        const double x = out.array.data()[i], most = robot.most[i % out.nq];
        if (!std::isfinite(x)) fail(place(i) + ": got " + number(x) + ", expected a finite number");
        if (std::fabs(x) > most) fail(place(i) + ": got " + number(x) + ", expected at most " + number(most));
        if (robot.coordinates[i % out.nq] != Coordinate::rotation || i % out.nq != 3) continue;
        const double* q = out.array.data() + i;
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(std::fabs(length - 1) <= unit_tolerance))
            fail(place(i) + ": got a quaternion (x, y, z, w) of length " + number(length) + ", expected length 1");
    }
    return out;
}

}  // namespace fgenv
