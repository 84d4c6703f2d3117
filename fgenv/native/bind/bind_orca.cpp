// Python function of ORCA: discs of all worlds in, velocities out.
#include "bind/bind.h"

#include "bind/arguments.h"
#include "bind/parallel.h"
#include "policy/orca.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr int64_t chunk = 16;  // discs

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

Array<double> array_of(nb::handle value, const char* name, const Dims& expected) {
    Array<double> a = doubles(value, name);
    if (a.dims != expected)
        fail(std::string(name) + ": got shape " + to_string(a.dims) + ", expected " + to_string(expected));
    for (size_t i = 0; i < a.view.size(); ++i)
        if (!std::isfinite(a.data()[i]))
            fail(std::string(name) + index_text(a.dims, static_cast<int64_t>(i)) + ": got " + number(a.data()[i]) +
                 ", expected a finite number");
    return a;
}

double positive(double x, const char* name) {
    if (!(x > 0) || std::isinf(x)) fail(std::string(name) + ": got " + number(x) + ", expected a positive number");
    return x;
}

// A row: x, y, vx, vy, radius (negative: absent), and 1 if the disc rests.
bool present(const double* row) { return row[4] >= 0; }
Disc disc_of(const double* row) { return {{row[0], row[1]}, {row[2], row[3]}, row[4], row[5] != 0 ? 1.0 : 0.5}; }

struct OrcaArguments {
    Array<double> discs, preferred, speeds, points;
    double horizon, point_horizon;
    OrcaSettings settings;
};

OrcaArguments arguments_of(nb::handle discs, nb::handle preferred, nb::handle speeds, nb::handle points, double horizon,
                           double point_horizon, double dt, double range) {
    const Dims dims = doubles(discs, "discs").dims;
    if (dims.size() != 3 || dims[2] != 6) fail("discs: got shape " + to_string(dims) + ", expected (worlds, discs, 6)");
    const int64_t worlds = dims[0], n = dims[1];
    Array<double> p = doubles(points, "points");
    if (p.dims.size() != 4 || p.dims[0] != worlds || p.dims[1] != n || p.dims[3] != 2)
        fail("points: got shape " + to_string(p.dims) +
             ", expected (worlds, discs, points, 2), NaN for missing points");
    return {array_of(discs, "discs", dims),
            array_of(preferred, "preferred", {worlds, n, 2}),
            array_of(speeds, "speeds", {worlds, n}),
            std::move(p),
            positive(horizon, "horizon"),
            positive(point_horizon, "point_horizon"),
            {positive(dt, "dt"), positive(range, "range")}};
}

// Points of its own, then the other discs of its world.
std::vector<Neighbor> neighbors_of(const OrcaArguments& a, int64_t disc) {
    const int64_t n = a.discs.dims[1], n_points = a.points.dims[2];
    const double* const world = a.discs.data() + 6 * n * (disc / n);
    std::vector<Neighbor> out;
    for (int64_t j = 0; j < n_points; ++j) {
        const double* at = a.points.data() + 2 * (n_points * disc + j);
        if (!std::isnan(at[0])) out.push_back({{{at[0], at[1]}, {0, 0}, 0, 1.0}, a.point_horizon});
    }
    for (int64_t j = 0; j < n; ++j)
        if (j != disc % n && present(world + 6 * j)) out.push_back({disc_of(world + 6 * j), a.horizon});
    return out;
}

nb::object orca_all(nb::handle discs, nb::handle preferred, nb::handle speeds, nb::handle points, double horizon,
                    double point_horizon, double dt, double range, nb::handle threads) {
    const OrcaArguments a = arguments_of(discs, preferred, speeds, points, horizon, point_horizon, dt, range);
    const int64_t worlds = a.discs.dims[0], n = a.discs.dims[1];
    Output<double> out = make_output<double>({worlds, n, 2});
    parallel_for(
        worlds * n, threads_of(threads),
        [&](int64_t first, int64_t last) {
            for (int64_t k = first; k < last; ++k) {
                const double *row = a.discs.data() + 6 * k, *v = a.preferred.data() + 2 * k;
                if (!present(row)) continue;
                const Vec2 velocity =
                    orca_velocity(disc_of(row), neighbors_of(a, k), {v[0], v[1]}, a.speeds.data()[k], a.settings);
                out.data[2 * k] = velocity.x, out.data[2 * k + 1] = velocity.y;
            }
        },
        chunk);
    return nb::cast(out.array);
}

}  // namespace

void bind_orca(nb::module_& m) {
    m.def("orca", &orca_all, "discs"_a.none(), "preferred"_a.none(), "speeds"_a.none(), nb::kw_only(),
          "points"_a.none(), "horizon"_a, "point_horizon"_a, "dt"_a, "range"_a, "threads"_a.none(),
          "Velocities by optimal reciprocal collision avoidance.");
}

}  // namespace fgenv
