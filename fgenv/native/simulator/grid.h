// Grids of cells and cheapest paths over them.
#pragma once

#include <cstdint>
#include <vector>

namespace fgenv {

constexpr int64_t n_headings = 8;

// Cells in rows, in one layer or in one per heading. Heading k points k eighths of a turn from the next row to the next
// column. A step into a cell costs the cell's cost times the length of the step in cells.
struct Grid {
    int64_t layers = 1, rows = 1, columns = 1;  // layers: 1 or n_headings
    std::vector<uint8_t> costs;                 // (layers, rows, columns); 0: closed

    int64_t layer_size() const { return rows * columns; }
    int64_t size() const { return layers * layer_size(); }
    bool closed(int64_t cell) const { return costs[cell] == 0; }
};

// The cheapest path between two cells, numbered as in `costs`; both ends included; empty if there is none. In one layer
// a step leads to one of the eight cells around. With headings a step leads ahead, or turns by an eighth in place at
// the cell's cost. A diagonal step needs both cells beside it open. A* (P. Hart, N. Nilsson, B. Raphael, 1968) with the
// octile distance; of equally cheap paths the same one on every machine.
std::vector<int64_t> cheapest_path(const Grid& grid, int64_t start, int64_t goal);

}  // namespace fgenv
