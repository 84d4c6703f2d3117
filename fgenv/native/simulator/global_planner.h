// Shortest paths of planar robots among static bodies and parked robots: the path hint `shortest`.
#pragma once

#include <utility>
#include <vector>

#include "simulator/bounded_cache.h"
#include "simulator/cost_map.h"
#include "simulator/episode.h"
#include "simulator/robot_spec.h"
#include "simulator/settings.h"

namespace fgenv {

// The exact collision check of a cell's center stands for the whole cell: a path is a hint, not a proof. A parked robot
// blocks the discs that hold it. A robot that would block another one's only path by parking waits until that robot has
// parked. Threads may plan for different episodes at the same time.
class GlobalPlanner {
public:
    GlobalPlanner(const std::vector<RobotSpec>& specs, const SimulatorSettings& settings,
                  std::vector<Footprint> footprints);

    // Paths as x, y, yaw per robot; empty for those that do not move. Around parked robots, else through them, else
    // straight. The path of a waiting robot begins and ends where the robot stands.
    std::vector<Waypoints> plan(const Episode& episode);

private:
    struct Route {
        CostMap map;     // on which the path was found
        Waypoints path;  // empty: the robot does not move
    };
    using Matrix = std::vector<std::vector<bool>>;
    using EpisodeKey = std::pair<int64_t, std::vector<double>>;

    static EpisodeKey key_of(const Episode& episode);
    std::vector<Waypoints> search(const Episode& episode);
    Route route(const Episode& episode, int32_t i);
    CostMap empty_map(const Episode& episode, int32_t i) const;
    std::vector<bool> waiting(const Episode& episode, const std::vector<Route>& routes) const;
    bool blocks(const Episode& episode, int32_t i, int32_t j, const Route& route) const;
    bool overlaps(int32_t i, const std::vector<double>& q, int32_t j, const Waypoints& path) const;
    bool can_wait(const Matrix& waits, const std::vector<Route>& routes, int32_t i, int32_t j) const;

    const std::vector<RobotSpec>& specs_;
    std::vector<Footprint> footprints_;
    bool robots_park_, cache_episodes_;
    BoundedCache<std::pair<int64_t, int32_t>, CostMap> maps_;    // by case and model
    BoundedCache<EpisodeKey, std::vector<Waypoints>> episodes_;  // of the beginnings of cases
};

}  // namespace fgenv
