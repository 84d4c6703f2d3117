// Worlds of one scenario, stepped at once: drives, collision checks, goals, rewards, observations and paths.
// Meters, seconds, radians.
#pragma once

#include "math/rng.h"
#include "simulator/global_planner.h"
#include "simulator/observations.h"

namespace fgenv {

// Static bodies with a pose per case.
struct CaseBodies {
    std::vector<BodyId> ids;
    std::vector<std::vector<Rigid>> poses;  // (cases, ids)
};

class Simulator {
public:
    // `like` has all bodies and robots. With footprints, path hints are the shortest paths; without, straight lines.
    Simulator(const World& like, std::vector<RobotSpec> specs, const SimulatorSettings& settings, int32_t worlds,
              CaseBodies bodies, std::vector<Footprint> footprints);

    Simulator(const Simulator&) = delete;

    int32_t n_worlds() const { return static_cast<int32_t>(episodes_.size()); }
    int32_t n_robots() const { return static_cast<int32_t>(specs_.size()); }
    const RobotSpec& spec(int32_t i) const { return specs_[i]; }
    const Episode& episode(int32_t e) const { return *episodes_[e]; }
    const Observer& observer() const { return observer_; }
    int32_t robot_of(BodyId body) const;  // -1: the body is no robot's

    int32_t action_size(int32_t i) const;
    int32_t action_size() const { return action_size_; }  // of the longest action

    // All of one world; different worlds may run on different threads.
    void reset(int32_t e, const uint64_t* seed);  // null: the next episode
    void place(int32_t e, int32_t i, const std::vector<double>& start, const std::vector<double>& goal);
    void set_path(int32_t e, int32_t i, Waypoints path);
    void step(int32_t e, const double* actions);  // (robots, action_size())
    void observe(int32_t e, float* rows) const;   // (robots, observer().size())
    void toward(int32_t e, int32_t i, const double* target, double* action) const;
    Vec3 hit_point(int32_t e, int32_t i) const;  // of the last step, world frame
    void save(int32_t e, Writer& out);
    void load(int32_t e, Reader& in);

    // Whether each robot would collide in a step with these actions; nothing changes.
    std::vector<bool> would_collide(int32_t e, const double* actions) const;
    // Replaces the actions of robots that would collide by `rest`, until no other robot would.
    void make_safe(int32_t e, const double* rest, double* actions) const;

private:
    using Targets = std::vector<std::vector<double>>;  // by robot

    bool sample(Episode& episode, Rng& rng, Targets& out) const;
    void place(Episode& episode, int32_t i, const std::vector<double>& start, const std::vector<double>& goal) const;
    void set_path(Episode& episode, int32_t i, Waypoints path) const;
    void plan(Episode& episode);
    void move(Episode& episode, const double* actions) const;
    bool drive(Episode& episode, int32_t i, const double* action, Place& to) const;
    struct Motions;
    void record_hit(Episode& episode, const Motions& motions, size_t k, const MotionOutcome& outcome) const;
    void finish(Episode& episode, int32_t i, const double* action) const;
    double reward(const RobotState& robot, int32_t i, double before, const double* action) const;
    void rewind(Episode& ahead, const Episode& episode) const;
    bool arrived(const RobotSpec& spec, const RobotState& robot) const;

    std::vector<RobotSpec> specs_;
    SimulatorSettings settings_;
    CaseBodies bodies_;
    Observer observer_;
    std::unique_ptr<GlobalPlanner> planner_;
    std::vector<std::unique_ptr<Episode>> episodes_;
    int32_t action_size_ = 0;
};

}  // namespace fgenv
