// Paths over grids: costs and cells in, cells out.
#include "bind/bind.h"

#include "bind/arguments.h"
#include "simulator/grid.h"

namespace fgenv {
namespace {

using namespace nb::literals;

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

int64_t cell_of(nb::handle value, const char* name, const Grid& grid) {
    const Array<int64_t> at = indices(value, name);
    if (at.dims != Dims{3})
        fail(std::string(name) + ": got shape " + to_string(at.dims) + ", expected (3,): layer, row, column");
    const int64_t dims[] = {grid.layers, grid.rows, grid.columns};
    int64_t cell = 0;
    for (int k = 0; k < 3; ++k) {
        const int64_t i = at.data()[k];
        if (i < 0 || i >= dims[k])
            fail(std::string(name) + index_text({3}, k) + ": got " + std::to_string(i) + ", expected 0 to " +
                 std::to_string(dims[k] - 1));
        cell = cell * dims[k] + i;
    }
    return cell;
}

Grid grid_of(nb::handle costs) {
    const Array<int64_t> a = indices(costs, "costs");
    if (a.dims.size() != 3 || (a.dims[0] != 1 && a.dims[0] != n_headings))
        fail("costs: got shape " + to_string(a.dims) + ", expected (1 or 8, rows, columns)");
    Grid grid{a.dims[0], a.dims[1], a.dims[2], {}};
    for (size_t i = 0; i < a.view.size(); ++i) {
        const int64_t cost = a.data()[i];
        if (cost < 0 || cost > 255)
            fail("costs" + index_text(a.dims, static_cast<int64_t>(i)) + ": got " + std::to_string(cost) +
                 ", expected 0 (closed) to 255");
        grid.costs.push_back(static_cast<uint8_t>(cost));
    }
    return grid;
}

nb::object path(nb::handle costs, nb::handle start, nb::handle goal) {
    const Grid grid = grid_of(costs);
    const int64_t from = cell_of(start, "start", grid), to = cell_of(goal, "goal", grid);
    std::vector<int64_t> cells;
    {
        nb::gil_scoped_release release;
        cells = cheapest_path(grid, from, to);
    }
    Output<int64_t> out = make_output<int64_t>({static_cast<int64_t>(cells.size())}, {3});
    for (size_t i = 0; i < cells.size(); ++i) {
        out.data[3 * i] = cells[i] / grid.layer_size();
        out.data[3 * i + 1] = cells[i] / grid.columns % grid.rows;
        out.data[3 * i + 2] = cells[i] % grid.columns;
    }
    return nb::cast(out.array);
}

}  // namespace

void bind_grid(nb::module_& m) { m.def("cheapest_path", &path, "costs"_a.none(), "start"_a.none(), "goal"_a.none()); }

}  // namespace fgenv
