// Shortest ways over a grid of cells.
#pragma once

#include <cstdint>
#include <vector>

namespace fgenv {

// Cells in rows; to step into one costs its price times the step's length in cells. Infinite: closed.
struct Grid {
    int64_t rows, columns;
    const double* price;  // 1 or more
};

// The cheapest way between two cells by steps to the eight around, both ends included; empty: there is none.
// A step between two cells corner to corner needs both cells beside it open. A* (P. Hart, N. Nilsson, B. Raphael,
// 1968) with the octile distance; of ways as good the one found is the same on every machine.
std::vector<int64_t> cheapest_way(const Grid& grid, int64_t from, int64_t to);

}  // namespace fgenv
