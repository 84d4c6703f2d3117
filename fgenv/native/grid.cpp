#include "grid.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace fgenv {
namespace {

constexpr double diagonal = 1.4142135623730951;

double octile(int64_t rows, int64_t columns) {
    const double longer = static_cast<double>(std::max(rows, columns)), shorter = static_cast<double>(std::min(rows, columns));
    return longer - shorter + diagonal * shorter;
}

}  // namespace

std::vector<int64_t> cheapest_way(const Grid& grid, int64_t from, int64_t to) {
    const int64_t width = grid.columns, n = grid.rows * width;
    const auto open = [&](int64_t row, int64_t column) {
        return row >= 0 && row < grid.rows && column >= 0 && column < width && std::isfinite(grid.price[row * width + column]);
    };
    const auto left = [&](int64_t cell) {
        return octile(std::abs(cell / width - to / width), std::abs(cell % width - to % width));
    };
    std::vector<double> cost(n, HUGE_VAL);
    std::vector<int64_t> before(n, -1);
    std::vector<bool> done(n);
    using Entry = std::pair<double, int64_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    cost[from] = 0;
    queue.emplace(left(from), from);
    while (!queue.empty() && !done[to]) {
        const int64_t cell = queue.top().second, row = cell / width, column = cell % width;
        queue.pop();
        if (done[cell]) continue;
        done[cell] = true;
        for (int64_t down = -1; down <= 1; ++down)
            for (int64_t right = -1; right <= 1; ++right) {
                if (!open(row + down, column + right) || !open(row + down, column) || !open(row, column + right)) continue;
                const int64_t next = cell + down * width + right;
                const double there = cost[cell] + grid.price[next] * (down && right ? diagonal : 1);
                if (there >= cost[next]) continue;
                cost[next] = there;
                before[next] = cell;
                queue.emplace(there + left(next), next);
            }
    }
    std::vector<int64_t> way;
    if (!done[to]) return way;
    for (int64_t cell = to; cell >= 0; cell = before[cell]) way.push_back(cell);
    std::reverse(way.begin(), way.end());
    return way;
}

}  // namespace fgenv
