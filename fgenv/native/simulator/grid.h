// Shortest ways over a grid of cells.
#pragma once

#include <cstdint>
#include <vector>

namespace fgenv {

constexpr int64_t headings = 8;

// Cells in rows, in one layer or one for each heading: heading k looks k eighths of a turn from the next row to the
// next column. To step into a cell costs its price times the step's length in cells. Infinite: closed.
struct Grid {
    int64_t layers, rows, columns;  // layers: 1 or `headings`
    const double* price;            // 1 or more
};

// The cheapest way between two cells, numbered as prices are; both ends included; empty: there is none. In one layer
// by steps to the eight around; with headings by steps ahead, and by an eighth of a turn in place, which costs the
// price. A step between two cells corner to corner needs both cells beside it open. A* (P. Hart, N. Nilsson,
// B. Raphael, 1968) with the octile distance; of ways as good the one found is the same on every machine.
std::vector<int64_t> cheapest_way(const Grid& grid, int64_t from, int64_t to);

}  // namespace fgenv
