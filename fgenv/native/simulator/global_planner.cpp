#include "simulator/global_planner.h"

#include <algorithm>
#include <cmath>

#include "math/lanes.h"

namespace fgenv {
namespace {

constexpr size_t most_maps = 1000, most_episodes = 10'000;

double squared_distance(const Point2& point, const std::vector<double>& from, const std::vector<double>& to) {
    const double leg[] = {to[0] - from[0], to[1] - from[1]}, by[] = {point[0] - from[0], point[1] - from[1]};
    const double squared = leg[0] * leg[0] + leg[1] * leg[1];
    const double t = squared > 0 ? std::clamp((by[0] * leg[0] + by[1] * leg[1]) / squared, 0.0, 1.0) : 0.0;
    const double x = by[0] - t * leg[0], y = by[1] - t * leg[1];
    return x * x + y * y;
}

// Meters between a path and the nearest of some points.
double distance_to(const std::vector<Point2>& points, const Waypoints& path) {
    double least = HUGE_VAL;
    for (const Point2& point : points)
        for (size_t k = 0; k < std::max<size_t>(1, path.size() - 1); ++k)
            least = std::min(least, squared_distance(point, path[k], path[std::min(k + 1, path.size() - 1)]));
    return std::sqrt(least);
}

}  // namespace

GlobalPlanner::GlobalPlanner(const std::vector<RobotSpec>& specs, const SimulatorSettings& settings,
                             std::vector<Footprint> footprints)
    : specs_(specs),
      footprints_(std::move(footprints)),
      robots_park_(!settings.vanish),
      cache_episodes_(!settings.random_starts),
      maps_(most_maps),
      episodes_(most_episodes) {}

std::vector<Waypoints> GlobalPlanner::plan(const Episode& episode) {
    const auto parked = [](const RobotState& robot) { return robot.status == Status::parked; };
    if (!cache_episodes_ || std::any_of(episode.robots.begin(), episode.robots.end(), parked)) return search(episode);
    return *episodes_.get(key_of(episode), [&] { return search(episode); });
}

GlobalPlanner::EpisodeKey GlobalPlanner::key_of(const Episode& episode) {
    EpisodeKey key{episode.case_number, {}};
    for (const RobotState& robot : episode.robots) {
        key.second.push_back(static_cast<double>(robot.status));
        key.second.insert(key.second.end(), robot.q.begin(), robot.q.end());
        key.second.insert(key.second.end(), robot.goal.begin(), robot.goal.end());
    }
    return key;
}

std::vector<Waypoints> GlobalPlanner::search(const Episode& episode) {
    std::vector<Route> routes(specs_.size());
    for (size_t i = 0; i < specs_.size(); ++i)
        if (episode.robots[i].status == Status::moving) routes[i] = route(episode, static_cast<int32_t>(i));
    const std::vector<bool> waits = waiting(episode, routes);
    std::vector<Waypoints> paths;
    for (size_t i = 0; i < specs_.size(); ++i) {
        const std::vector<double>& q = episode.robots[i].q;
        paths.push_back(waits[i] ? Waypoints{q, q} : std::move(routes[i].path));
    }
    return paths;
}

GlobalPlanner::Route GlobalPlanner::route(const Episode& episode, int32_t i) {
    const RobotState& robot = episode.robots[i];
    const std::shared_ptr<const CostMap> empty = maps_.get({episode.case_number, footprints_[i].model},
                                                           [&] { return empty_map(episode, footprints_[i].model); });
    Route out{*empty, {}};
    for (size_t j = 0; j < specs_.size(); ++j)
        if (episode.robots[j].status == Status::parked)
            block(out.map, footprints_[i], footprints_[j], episode.robots[j].q.data(), true);
    out.path = find_path(out.map, robot.q.data(), robot.goal.data());
    if (!out.path.empty()) return out;
    out.map = *empty;
    out.path = find_path(out.map, robot.q.data(), robot.goal.data());
    if (out.path.empty()) out.path = {robot.q, robot.goal};
    return out;
}

// Among the static bodies of the episode's case alone.
CostMap GlobalPlanner::empty_map(const Episode& episode, int32_t i) const {
    World world(episode.world);
    for (const RobotSpec& spec : specs_) world.set_present(spec.id, spec.id == specs_[i].id);
    return make_cost_map(world, specs_[i].id, footprints_[i]);
}

// A robot waits for each robot that it would block by parking, and for those for which that robot waits.
std::vector<bool> GlobalPlanner::waiting(const Episode& episode, const std::vector<Route>& routes) const {
    const int32_t n = static_cast<int32_t>(routes.size());
    Matrix waits(n, std::vector<bool>(n));  // [i][j]: i waits for j
    for (int32_t i = 0; i < n && robots_park_; ++i)
        for (int32_t j = 0; j < n; ++j) {
            if (i == j || routes[i].path.empty() || routes[j].path.empty() || waits[j][i]) continue;
            if (!blocks(episode, i, j, routes[j]) || !can_wait(waits, routes, i, j)) continue;
            const std::vector<bool> first = waits[j];
            for (int32_t k = 0; k < n; ++k) {
                if (k != i && !waits[k][i]) continue;
                for (int32_t m = 0; m < n; ++m)
                    if (m == j || first[m]) waits[k][m] = true;
            }
        }
    std::vector<bool> out;
    for (const std::vector<bool>& row : waits) out.push_back(std::find(row.begin(), row.end(), true) != row.end());
    return out;
}

// Whether no robot that would wait stands on the goal of a robot that would go first.
bool GlobalPlanner::can_wait(const Matrix& waits, const std::vector<Route>& routes, int32_t i, int32_t j) const {
    const int32_t n = static_cast<int32_t>(routes.size());
    for (int32_t k = 0; k < n; ++k) {
        if (k != i && !waits[k][i]) continue;
        for (int32_t m = 0; m < n; ++m)
            if ((m == j || waits[j][m]) && overlaps(k, routes[k].path.front(), m, {routes[m].path.back()}))
                return false;
    }
    return true;
}

// Whether robot i at its goal blocks the only path of robot j, or overlaps robot j where it is.
bool GlobalPlanner::blocks(const Episode& episode, int32_t i, int32_t j, const Route& route) const {
    const std::vector<double>& goal = episode.robots[i].goal;
    if (!overlaps(i, goal, j, route.path)) return false;
    if (overlaps(i, goal, j, {route.path.front()})) return true;
    CostMap map = route.map;
    block(map, footprints_[j], footprints_[i], goal.data(), false);
    return find_path(map, route.path.front().data(), route.path.back().data()).empty();
}

// Whether robot i at a configuration overlaps robot j on a path, by their discs.
bool GlobalPlanner::overlaps(int32_t i, const std::vector<double>& q, int32_t j, const Waypoints& path) const {
    return distance_to(footprints_[i].discs_at(q.data()), path) <
           footprints_[i].disc_radius + footprints_[j].disc_radius;
}

}  // namespace fgenv
