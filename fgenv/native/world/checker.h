// A world as a planner sees it: states of some of its movers, all at once, and whether they and the ways
// between them are free.
#pragma once

#include "robot/steering.h"
#include "world/world.h"

namespace fgenv {

// A mover's part of a state: a robot's configuration, of a level one with a yaw in place of the quaternion; of a
// body x, y, yaw at the height where it is, or x, y, z, qx, qy, qz, qw.
struct Member {
    BodyId id;
    std::shared_ptr<const Robot> model;  // null: a body
    int32_t size;                        // how many numbers
    Steering steering;
    double room[2][2] = {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}};  // that a car's arcs must not leave

    bool level() const { return model && size < model->nq(); }
};

// Not for several threads at once. Methods throw std::invalid_argument; whoever calls holds the world's lock.
class Checker {
public:
    Checker(const World& world, std::vector<Member> members, const MotionSettings& settings);

    int32_t size() const { return size_; }
    bool valid(const double* state);
    // The way that steering takes; its beginning is taken to be valid.
    bool free(const double* from, const double* to);
    // Meters to the nearest of all others, the members among each other apart; 0 in collision.
    double clearance(const double* state);

    int64_t states = 0, motions = 0;  // asked so far

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
    std::vector<std::vector<double>> legs_;  // of each member, rows
};

}  // namespace fgenv
