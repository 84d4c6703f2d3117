// Settings of a batched simulator.
#pragma once

#include <cstdint>

namespace fgenv {

enum class CollisionResponse : uint8_t { stop, terminate, pass };

// Parts of an observation, in this order.
struct ObservationSettings {
    bool goal = true, velocity = true, configuration = false, path_hint = false, lidar = true;
    int32_t neighbors = 0;
    double neighbor_range = 0;  // meters over which neighbors fade to zeros; 0: they do not fade
    bool intent = false;        // neighbors include the direction to their goals
    bool priority = false;      // two groups of neighbors: those before the robot in the scenario, those after it
    double look_ahead = 1;      // of the path hint along the path: meters, or radians of joints
};

// Factors of the terms of the reward.
struct RewardWeights {
    double progress = 0;   // decrease of the distance to the goal, meters (radians of joints)
    double arrival = 0;    // 1 in the step of arrival
    double collision = 0;  // 1 in a step with a collision
    double obstacle = 0;   // 1 in a step with a collision with a body that is no robot
    double time = 0;       // 1 in each step before arrival
    double effort = 0;     // mean square of the action, in [0, 1]
    double closeness = 0;  // 1 in contact, falling to 0 at `closeness_range`
};

struct SimulatorSettings {
    double dt = 0.1;
    int64_t horizon = 600;  // steps of an episode
    CollisionResponse response = CollisionResponse::stop;
    bool vanish = false;             // robots disappear at the goal; else they park
    bool waypoint_actions = false;   // actions are waypoints; else of the drive
    double waypoint_seconds = 1;     // at full speed, to the farthest waypoint
    bool random_starts = false;      // starts and goals are drawn per episode; else they are of a case
    bool case_by_seed = false;       // the case is (seed + episode) modulo the number of cases; else random
    bool measure_clearance = false;  // after each step
    double closeness_range = 0.5;    // meters
    double tolerance = 1e-4;         // meters before a contact at which a robot may stop
    ObservationSettings observation;
    RewardWeights reward;

    bool needs_clearance() const { return measure_clearance || reward.closeness != 0; }
};

}  // namespace fgenv
