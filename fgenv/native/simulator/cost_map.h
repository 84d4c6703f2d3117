// Grids of the plane for one robot: open cells by the exact collision check, and discs of other robots.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "simulator/grid.h"
#include "world/world.h"

namespace fgenv {

using Point2 = std::array<double, 2>;

// A robot on a planar base, as paths take it. Meters.
struct Footprint {
    std::vector<double> disc_centers;  // ahead of the base, of discs that hold the robot
    double disc_radius = 0;
    double extra = 0;              // clearance added to `disc_radius` where the discs of two robots are compared
    double width = 0;              // the shorter side
    bool turns = false;            // the robot is long and has to look along its path: one layer per heading
    Point2 low{0, 0}, high{0, 0};  // workspace
    int32_t model = 0;             // index of the first robot of the same model

    double reach() const;                                 // from the base to the farthest point of the discs
    std::vector<Point2> discs_at(const double* q) const;  // their centers at x, y, yaw
};

// A grid with its place in the plane: the center of cell (row, column) is low + side * (row, column).
struct CostMap {
    Grid grid;
    Point2 low{0, 0};
    double side = 1;

    Point2 center(int64_t cell) const;  // of a cell of any layer
    // The open cell nearest to x, y, yaw; if all are closed, the cell there.
    int64_t nearest_open(const double* q) const;
};

constexpr double full_turn = 2 * 3.14159265358979323846, heading_step = full_turn / n_headings;  // radians

// Tests the center of each cell in a world where the robot is present. Cells with little clearance cost more.
CostMap make_cost_map(const World& world, BodyId robot, const Footprint& footprint);

// Closes the cells in which a robot would overlap another one with its base at `q`, and raises the cost of those next
// to them. Without `with_extra` the discs alone count.
void block(CostMap& map, const Footprint& robot, const Footprint& other, const double* q, bool with_extra);

// The cheapest path over the cells as x, y, yaw: each point looks to the next, the ends are as given. Empty if there
// is none.
std::vector<std::vector<double>> find_path(const CostMap& map, const double* start, const double* goal);

}  // namespace fgenv
