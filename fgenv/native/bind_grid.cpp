// Ways over grids: prices and cells in, cells out.
#include "bind.h"

#include <cmath>

#include "arguments.h"
#include "grid.h"

namespace fgenv {
namespace {

using namespace nb::literals;

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

int64_t cell_of(nb::handle value, const char* name, const Grid& grid) {
    const Array<int64_t> at = indices(value, name);
    if (at.dims != Dims{2}) fail(std::string(name) + ": shape " + to_string(at.dims) + ", wanted (2,), row and column");
    const int64_t row = at.data()[0], column = at.data()[1];
    if (row < 0 || row >= grid.rows || column < 0 || column >= grid.columns)
        fail(std::string(name) + ": [" + std::to_string(row) + ", " + std::to_string(column) + "] is outside of the grid");
    return row * grid.columns + column;
}

nb::object way(nb::handle prices, nb::handle from, nb::handle to) {
    const Array<double> p = doubles(prices, "prices");
    if (p.dims.size() != 2) fail("prices: shape " + to_string(p.dims) + ", wanted (rows, columns)");
    for (size_t i = 0; i < p.view.size(); ++i)
        if (!(p.data()[i] >= 1))
            fail("prices" + index_text(p.dims, static_cast<int64_t>(i)) + " is " + number(p.data()[i]) + ", wanted 1 or more");
    const Grid grid{p.dims[0], p.dims[1], p.data()};
    const int64_t begin = cell_of(from, "start", grid), end = cell_of(to, "goal", grid);
    std::vector<int64_t> cells;
    {
        nb::gil_scoped_release release;
        cells = cheapest_way(grid, begin, end);
    }
    Output<int64_t> out = make_output<int64_t>({static_cast<int64_t>(cells.size())}, {2});
    for (size_t i = 0; i < cells.size(); ++i) {
        out.data[2 * i] = cells[i] / grid.columns;
        out.data[2 * i + 1] = cells[i] % grid.columns;
    }
    return nb::cast(out.array);
}

}  // namespace

void bind_grid(nb::module_& m) { m.def("cheapest_way", &way, "prices"_a.none(), "start"_a.none(), "goal"_a.none()); }

}  // namespace fgenv
