#include "simulator/cost_map.h"

#include <algorithm>
#include <cmath>

#include "math/trig.h"

namespace fgenv {
namespace {

constexpr double cell_size = 1.0 / 3;  // of the radius of a robot's circle
constexpr double most_cells = 200;     // along a side of the workspace
constexpr double narrow = 1.0 / 3;     // of half the width: less clearance makes a cell narrow
constexpr uint8_t plain_cost = 1, narrow_cost = 2;

uint8_t cost_at(const World& world, BodyId robot, const Place& place, double margin) {
    if (world.collides(robot, place, now, 0)) return 0;
    return world.collides(robot, place, now, margin) ? narrow_cost : plain_cost;
}

// Of closed (0) and open cells the cheapest.
uint8_t cheaper(uint8_t a, uint8_t b) { return a == 0 ? b : b == 0 ? a : std::min(a, b); }

// The cells where a path starts, changes its direction and ends, without turns in place.
std::vector<int64_t> corners(const Grid& grid, const std::vector<int64_t>& path) {
    std::vector<int64_t> cells, out;
    for (int64_t cell : path) {
        const int64_t at = cell % grid.layer_size();
        if (cells.empty() || cells.back() != at) cells.push_back(at);
    }
    const auto step = [&](size_t k) {
        const int64_t a = cells[k], b = cells[k + 1], n = grid.columns;
        return std::pair{b / n - a / n, b % n - a % n};
    };
    for (size_t k = 0; k < cells.size(); ++k)
        if (k == 0 || k + 1 == cells.size() || step(k) != step(k - 1)) out.push_back(cells[k]);
    return out;
}

// The difference of two headings in eighths of a turn, in [-4, 4).
double wrapped(double x) {
    const double half = n_headings / 2, r = std::fmod(x + half, n_headings);
    return (r < 0 ? r + n_headings : r) - half;
}

// Covers the workspace with square cells.
CostMap closed_map(const Footprint& footprint) {
    const Point2& low = footprint.low;
    const Point2 size{footprint.high[0] - low[0], footprint.high[1] - low[1]};
    CostMap map;
    map.side = std::max(cell_size * (footprint.reach() + footprint.extra), std::max(size[0], size[1]) / most_cells);
    double cells[2];
    for (int k = 0; k < 2; ++k) {
        cells[k] = std::max(1.0, std::floor(size[k] / map.side));
        map.low[k] = low[k] + 0.5 * (size[k] - (cells[k] - 1) * map.side);
    }
    Grid& grid = map.grid;
    grid.layers = footprint.turns ? n_headings : 1;
    grid.rows = static_cast<int64_t>(cells[0]);
    grid.columns = static_cast<int64_t>(cells[1]);
    grid.costs.resize(grid.size());
    return map;
}

// Closes the cells of a layer within `apart` of a point, and raises the cost of those within `near`.
void block_circle(CostMap& map, int64_t layer, const Point2& center, double apart, double near) {
    const Grid& grid = map.grid;
    for (int64_t row = 0; row < grid.rows; ++row) {
        const double x = map.low[0] + map.side * static_cast<double>(row) - center[0];
        if (std::fabs(x) >= near) continue;
        for (int64_t column = 0; column < grid.columns; ++column) {
            const double y = map.low[1] + map.side * static_cast<double>(column) - center[1];
            const double squared = x * x + y * y;
            uint8_t& cost = map.grid.costs[layer * grid.layer_size() + row * grid.columns + column];
            if (squared < apart * apart) cost = 0;
            if (squared < near * near && cost != 0) cost = narrow_cost;
        }
    }
}

}  // namespace

double Footprint::reach() const {
    double farthest = 0;
    for (double x : disc_centers) farthest = std::max(farthest, std::fabs(x));
    return farthest + disc_radius;
}

std::vector<Point2> Footprint::discs_at(const double* q) const {
    double sine, cosine;
    sin_cos(q[2], sine, cosine);
    std::vector<Point2> out;
    for (double ahead : disc_centers) out.push_back({q[0] + ahead * cosine, q[1] + ahead * sine});
    return out;
}

Point2 CostMap::center(int64_t cell) const {
    const int64_t at = cell % grid.layer_size();
    return {low[0] + side * static_cast<double>(at / grid.columns),
            low[1] + side * static_cast<double>(at % grid.columns)};
}

int64_t CostMap::nearest_open(const double* q) const {
    const double heading = grid.layers > 1 ? q[2] * n_headings / full_turn : 0;
    const double row = (q[0] - low[0]) / side, column = (q[1] - low[1]) / side;
    int64_t nearest = -1;
    double least = HUGE_VAL;
    for (int64_t cell = 0; cell < grid.size(); ++cell) {
        if (grid.closed(cell)) continue;
        const int64_t layer = cell / grid.layer_size(), at = cell % grid.layer_size();
        const double turn = wrapped(static_cast<double>(layer) - heading);
        const double down = static_cast<double>(at / grid.columns) - row,
                     right = static_cast<double>(at % grid.columns) - column;
        const double squared = turn * turn + down * down + right * right;
        if (squared < least) least = squared, nearest = cell;
    }
    if (nearest >= 0) return nearest;
    const auto index = [](double x, int64_t n) {
        return std::clamp(static_cast<int64_t>(std::nearbyint(x)), int64_t(0), n - 1);
    };
    return (index(heading, grid.layers) * grid.rows + index(row, grid.rows)) * grid.columns +
           index(column, grid.columns);
}

CostMap make_cost_map(const World& world, BodyId robot, const Footprint& footprint) {
    CostMap map = closed_map(footprint);
    const double margin = narrow * 0.5 * footprint.width;
    // A robot that need not turn fits in a cell if it fits at one of half of the headings.
    const int64_t headings = footprint.turns ? 1 : n_headings / 2;
    for (int64_t cell = 0; cell < map.grid.size(); ++cell) {
        const Point2 at = map.center(cell);
        const int64_t layer = cell / map.grid.layer_size();
        uint8_t& cost = map.grid.costs[cell];
        for (int64_t k = layer; k < layer + headings && cost != plain_cost; ++k) {
            const Place place{identity(), {at[0], at[1], static_cast<double>(k) * heading_step}};
            cost = cheaper(cost, cost_at(world, robot, place, margin));
        }
    }
    return map;
}

void block(CostMap& map, const Footprint& robot, const Footprint& other, const double* q, bool with_extra) {
    const double apart = robot.disc_radius + other.disc_radius + (with_extra ? robot.extra + other.extra : 0.0);
    const double near = apart + narrow * (robot.disc_radius + robot.extra);
    const std::vector<Point2> theirs = other.discs_at(q);
    for (int64_t layer = 0; layer < map.grid.layers; ++layer) {
        const double turned[3] = {0, 0, static_cast<double>(layer) * heading_step};
        for (const Point2& own : robot.discs_at(turned))
            for (const Point2& disc : theirs)  // the discs coincide if the base is at their difference
                block_circle(map, layer, {disc[0] - own[0], disc[1] - own[1]}, apart, near);
    }
}

std::vector<std::vector<double>> find_path(const CostMap& map, const double* start, const double* goal) {
    const std::vector<int64_t> cells = cheapest_path(map.grid, map.nearest_open(start), map.nearest_open(goal));
    std::vector<std::vector<double>> path;
    if (cells.empty()) return path;
    const std::vector<int64_t> turns = corners(map.grid, cells);
    path.push_back({start, start + 3});
    for (size_t k = 1; k + 1 < turns.size(); ++k) {
        const Point2 at = map.center(turns[k]);
        path.push_back({at[0], at[1], 0});
    }
    path.push_back({goal, goal + 3});
    for (size_t k = 1; k + 1 < path.size(); ++k)
        path[k][2] = arc_tangent(path[k + 1][1] - path[k][1], path[k + 1][0] - path[k][0]);
    return path;
}

}  // namespace fgenv
