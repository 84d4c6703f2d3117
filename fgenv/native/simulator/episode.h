// The state of one world during an episode.
#pragma once

#include <vector>

#include "simulator/archive.h"
#include "world/world.h"

namespace fgenv {

enum class Status : uint8_t { moving, parked, gone };

using Waypoints = std::vector<std::vector<double>>;  // configurations

struct RobotState {
    std::vector<double> q, goal;
    std::vector<double> action;  // in force in the last step, in units of the drive
    Waypoints path;              // from the start to the goal, or the path set since
    bool has_mask = false;       // the world has a mask of the path
    Status status = Status::moving;
    double remaining = 0;  // distance to the goal, see RobotSpec::distance
    // Of the last step
    BodyId hit = -1, hit_part = -1;  // the body in contact, and the robot's own body that touches it
    double hit_time = 0;             // seconds in the step
    Vec3 hit_point{0, 0, 0};         // set in the step if robots pass, else see Simulator::hit_point
    int64_t checks = 0;              // pairs of bodies tested
    int32_t masked = 0;              // bodies that remain after the mask
    double clearance = HUGE_VAL;
    double reward = 0;
    // Of the episode
    int64_t collisions = 0, arrived = -1;  // step of arrival, -1: not yet
    double traveled = 0, least_clearance = HUGE_VAL;

    template <class A>
    void visit(A& archive) {
        archive(q, goal, action, path, has_mask, status, remaining, hit, hit_part, hit_time, hit_point, checks, masked,
                clearance, reward, collisions, arrived, traveled, least_clearance);
    }
};

struct Episode {
    explicit Episode(const World& like) : world(like) {}

    World world;
    uint64_t seed = 0;
    int64_t number = 0, steps = 0, case_number = 0;
    bool terminated = false, truncated = false;
    std::vector<RobotState> robots;

    bool over() const { return terminated || truncated; }

    template <class A>
    void visit(A& archive) {
        archive(seed, number, steps, case_number, terminated, truncated);
        for (RobotState& robot : robots) robot.visit(archive);
    }
};

}  // namespace fgenv
