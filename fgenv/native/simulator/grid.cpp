#include "simulator/grid.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace fgenv {
namespace {

constexpr double diagonal = 1.4142135623730951;

// Rows and columns of a step along heading k.
constexpr int64_t directions[n_headings][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

double octile(int64_t rows, int64_t columns) {
    const double longer = static_cast<double>(std::max(rows, columns)),
                 shorter = static_cast<double>(std::min(rows, columns));
    return longer - shorter + diagonal * shorter;
}

class AStar {
public:
    AStar(const Grid& grid, int64_t start, int64_t goal)
        : grid_(grid),
          goal_(goal),
          cost_(grid.costs.size(), HUGE_VAL),
          parent_(grid.costs.size(), -1),
          expanded_(grid.costs.size()) {
        cost_[start] = 0;
        queue_.emplace(heuristic(start), start);
    }

    std::vector<int64_t> path() {
        while (!queue_.empty() && !expanded_[goal_]) {
            const int64_t cell = queue_.top().second;
            queue_.pop();
            if (expanded_[cell]) continue;
            expanded_[cell] = true;
            expand(cell);
        }
        std::vector<int64_t> out;
        if (!expanded_[goal_]) return out;
        for (int64_t cell = goal_; cell >= 0; cell = parent_[cell]) out.push_back(cell);
        std::reverse(out.begin(), out.end());
        return out;
    }

private:
    using Entry = std::pair<double, int64_t>;

    double heuristic(int64_t cell) const {
        const int64_t a = cell % grid_.layer_size(), b = goal_ % grid_.layer_size(), n = grid_.columns;
        return octile(std::abs(a / n - b / n), std::abs(a % n - b % n));
    }

    void expand(int64_t cell) {
        const int64_t heading = cell / grid_.layer_size();
        if (grid_.layers == 1) {
            for (int64_t k = 0; k < n_headings; ++k) step(cell, k);
            return;
        }
        step(cell, heading);
        for (int64_t turn : {int64_t(1), n_headings - 1}) {
            const int64_t next = cell + ((heading + turn) % n_headings - heading) * grid_.layer_size();
            if (!grid_.closed(next)) relax(cell, next, 1);
        }
    }

    void step(int64_t cell, int64_t heading) {
        const int64_t at = cell % grid_.layer_size(), first = cell - at;
        const int64_t row = at / grid_.columns, column = at % grid_.columns;
        const auto [down, right] = directions[heading];
        if (open(first, row + down, column + right) && open(first, row + down, column) &&
            open(first, row, column + right))
            relax(cell, cell + down * grid_.columns + right, down && right ? diagonal : 1);
    }

    bool open(int64_t first, int64_t row, int64_t column) const {
        return row >= 0 && row < grid_.rows && column >= 0 && column < grid_.columns &&
               !grid_.closed(first + row * grid_.columns + column);
    }

    void relax(int64_t cell, int64_t next, double length) {
        const double cost = cost_[cell] + static_cast<double>(grid_.costs[next]) * length;
        if (cost >= cost_[next]) return;
        cost_[next] = cost;
        parent_[next] = cell;
        queue_.emplace(cost + heuristic(next), next);
    }

    const Grid& grid_;
    const int64_t goal_;
    std::vector<double> cost_;
    std::vector<int64_t> parent_;
    std::vector<bool> expanded_;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

std::vector<int64_t> cheapest_path(const Grid& grid, int64_t start, int64_t goal) {
    return AStar(grid, start, goal).path();
}

}  // namespace fgenv
