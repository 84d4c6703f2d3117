// State and motion checks for planners: joint states of several movers of a world, and the motions between them.
#pragma once

#include "robot/steering.h"
#include "world/world.h"

namespace fgenv {

// A mover's part of a state. For a robot: its configuration (a level free base has a yaw instead of the
// quaternion). For a body: x, y, yaw at its current height, or x, y, z, qx, qy, qz, qw.
struct Member {
    BodyId id;
    std::shared_ptr<const Robot> model;  // null: a body
    int32_t size;                        // numbers in the state
    Steering steering;
    double room[2][2] = {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}};  // x and y bounds of a car's arcs

    bool level() const { return model && size < model->nq(); }
};

// Not thread-safe. Methods throw std::invalid_argument. The caller holds the world's lock.
class Checker {
public:
    Checker(const World& world, std::vector<Member> members, const MotionSettings& settings);

    int32_t size() const { return size_; }
    bool valid(const double* state);
    // Checks the motion of the steering method; assumes that its start is valid.
    bool free(const double* from, const double* to);
    // Distance (meters) from the members to all other bodies and between members; 0 in collision.
    double clearance(const double* state);

    int64_t states = 0, motions = 0;  // number of checks so far

private:
    bool place(const double* state, std::vector<Place>& out) const;  // false: not finite
    void ask() const;

    const World& world_;
    std::vector<Member> members_;
    std::vector<BodyId> ids_;
    MotionSettings settings_;
    int32_t size_ = 0;
    bool straight_ = true;
    BodyPair last_pair_;
    std::vector<Place> from_, to_;
    std::vector<std::vector<double>> legs_;  // way points per member, as rows
};

}  // namespace fgenv
