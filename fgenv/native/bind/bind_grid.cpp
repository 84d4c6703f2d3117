// Ways over grids: prices and cells in, cells out.
#include "bind/bind.h"

#include <cmath>

#include "bind/arguments.h"
#include "simulator/grid.h"

namespace fgenv {
namespace {

using namespace nb::literals;

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

int64_t cell_of(nb::handle value, const char* name, const Grid& grid) {
    const Array<int64_t> at = indices(value, name);
    if (at.dims != Dims{3})
        fail(std::string(name) + ": shape " + to_string(at.dims) + ", expected (3,): layer, row, column");
    const int64_t within[] = {grid.layers, grid.rows, grid.columns};
    int64_t cell = 0;
    for (int k = 0; k < 3; ++k) {
        const int64_t i = at.data()[k];
        if (i < 0 || i >= within[k])
            fail(std::string(name) + "[" + std::to_string(k) + "] is " + std::to_string(i) + ", outside of the grid");
        cell = cell * within[k] + i;
    }
    return cell;
}

nb::object way(nb::handle prices, nb::handle from, nb::handle to) {
    const Array<double> p = doubles(prices, "prices");
    if (p.dims.size() != 3 || (p.dims[0] != 1 && p.dims[0] != headings))
        fail("prices: shape " + to_string(p.dims) + ", expected (1 or 8, rows, columns)");
    for (size_t i = 0; i < p.view.size(); ++i)
        if (!(p.data()[i] >= 1))
            fail("prices" + index_text(p.dims, static_cast<int64_t>(i)) + " is " + number(p.data()[i]) +
                 ", expected 1 or more");
    const Grid grid{p.dims[0], p.dims[1], p.dims[2], p.data()};
    const int64_t begin = cell_of(from, "start", grid), end = cell_of(to, "goal", grid);
    std::vector<int64_t> cells;
    {
        nb::gil_scoped_release release;
        cells = cheapest_way(grid, begin, end);
    }
    Output<int64_t> out = make_output<int64_t>({static_cast<int64_t>(cells.size())}, {3});
    for (size_t i = 0; i < cells.size(); ++i) {
        out.data[3 * i] = cells[i] / (grid.rows * grid.columns);
        out.data[3 * i + 1] = cells[i] / grid.columns % grid.rows;
        out.data[3 * i + 2] = cells[i] % grid.columns;
    }
    return nb::cast(out.array);
}

}  // namespace

void bind_grid(nb::module_& m) { m.def("cheapest_way", &way, "prices"_a.none(), "start"_a.none(), "goal"_a.none()); }

}  // namespace fgenv
