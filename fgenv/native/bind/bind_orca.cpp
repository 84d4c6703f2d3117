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
        fail(std::string(name) + ": shape " + to_string(a.dims) + ", expected " + to_string(expected));
    for (size_t i = 0; i < a.view.size(); ++i)
        if (!std::isfinite(a.data()[i]))
            fail(std::string(name) + index_text(a.dims, static_cast<int64_t>(i)) + " is not finite");
    return a;
}

double positive(double x, const char* name) {
    if (!(x > 0) || std::isinf(x)) fail(std::string(name) + ": " + number(x) + ", expected over 0");
    return x;
}

// One row: x, y, vx, vy, radius, and 1 where others have to avoid it alone; a radius below 0: it is not there.
bool present(const double* row) { return row[4] >= 0; }
Disc disc_of(const double* row) { return {row[0], row[1], row[2], row[3], row[4], row[5] != 0 ? 1.0 : 0.5}; }

nb::object orca_all(nb::handle discs, nb::handle preferred, nb::handle speeds, nb::handle points, double horizon,
                    double point_horizon, double dt, double range, nb::handle threads) {
    const Array<double> d = doubles(discs, "discs");
    if (d.dims.size() != 3 || d.dims[2] != 6)
        fail("discs: shape " + to_string(d.dims) + ", expected (worlds, discs, 6)");
    const int64_t worlds = d.dims[0], n = d.dims[1];
    array_of(discs, "discs", d.dims);
    const Array<double> w = array_of(preferred, "preferred", {worlds, n, 2}),
                        s = array_of(speeds, "speeds", {worlds, n});
    const Array<double> p = doubles(points, "points");
    if (p.dims.size() != 4 || p.dims[0] != worlds || p.dims[1] != n || p.dims[3] != 2)
        fail("points: shape " + to_string(p.dims) + ", expected (worlds, discs, points, 2), NaN where there is none");
    const int64_t n_points = p.dims[2];
    const OrcaSettings settings{positive(horizon, "horizon"), positive(dt, "dt"), positive(range, "range")};
    const double of_points = positive(point_horizon, "point_horizon");
    const int n_threads = threads_of(threads);
    Output<double> out = make_output<double>({worlds, n, 2});
    parallel_for(
        worlds * n, n_threads,
        [&](int64_t first, int64_t last) {
            std::vector<Neighbor> others;
            for (int64_t k = first; k < last; ++k) {
                const double* const row = d.data() + 6 * k;
                const double* const world = d.data() + 6 * n * (k / n);
                others.clear();
                for (int64_t j = 0; j < n_points; ++j) {
                    const double* at = p.data() + 2 * (n_points * k + j);
                    if (!std::isnan(at[0])) others.push_back({{at[0], at[1], 0, 0, 0, 1.0}, of_points});
                }
                for (int64_t j = 0; j < n; ++j)
                    if (j != k % n && present(world + 6 * j))
                        others.push_back({disc_of(world + 6 * j), settings.horizon});
                if (present(row))
                    orca(disc_of(row), others, w.data()[2 * k], w.data()[2 * k + 1], s.data()[k], settings,
                         out.data[2 * k], out.data[2 * k + 1]);
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
