#include "simulator/grid.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace fgenv {
namespace {

constexpr double diagonal = 1.4142135623730951;

double octile(int64_t rows, int64_t columns) {
    const double longer = static_cast<double>(std::max(rows, columns)),
                 shorter = static_cast<double>(std::min(rows, columns));
    return longer - shorter + diagonal * shorter;
}

// Where heading k looks: rows and columns.
constexpr int64_t ahead[headings][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

}  // namespace

std::vector<int64_t> cheapest_way(const Grid& grid, int64_t from, int64_t to) {
    const int64_t width = grid.columns, layer = grid.rows * width, n = grid.layers * layer;
    const auto open = [&](int64_t first, int64_t row, int64_t column) {
        return row >= 0 && row < grid.rows && column >= 0 && column < width &&
               std::isfinite(grid.price[first + row * width + column]);
    };
    const auto left = [&](int64_t cell) {
        const int64_t a = cell % layer, b = to % layer;
        return octile(std::abs(a / width - b / width), std::abs(a % width - b % width));
    };
    std::vector<double> cost(n, HUGE_VAL);
    std::vector<int64_t> before(n, -1);
    std::vector<bool> done(n);
    using Entry = std::pair<double, int64_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto reach = [&](int64_t cell, int64_t next, double length) {
        const double there = cost[cell] + grid.price[next] * length;
        if (there >= cost[next]) return;
        cost[next] = there;
        before[next] = cell;
        queue.emplace(there + left(next), next);
    };
    cost[from] = 0;
    queue.emplace(left(from), from);
    while (!queue.empty() && !done[to]) {
        const int64_t cell = queue.top().second;
        queue.pop();
        if (done[cell]) continue;
        done[cell] = true;
        const int64_t heading = cell / layer, first = heading * layer, at = cell - first, row = at / width,
                      column = at % width;
        const auto step = [&](int64_t k) {
            const auto [down, right] = ahead[k];
            if (open(first, row + down, column + right) && open(first, row + down, column) &&
                open(first, row, column + right))
                reach(cell, cell + down * width + right, down && right ? diagonal : 1);
        };
        if (grid.layers == 1) {
            for (int64_t k = 0; k < headings; ++k) step(k);
            continue;
        }
        step(heading);
        for (int64_t turn : {int64_t(1), headings - 1}) {
            const int64_t next = (heading + turn) % headings * layer + at;
            if (std::isfinite(grid.price[next])) reach(cell, next, 1);
        }
    }
    std::vector<int64_t> way;
    if (!done[to]) return way;
    for (int64_t cell = to; cell >= 0; cell = before[cell]) way.push_back(cell);
    std::reverse(way.begin(), way.end());
    return way;
}

}  // namespace fgenv
