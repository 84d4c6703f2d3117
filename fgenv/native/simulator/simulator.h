// Many worlds of one scenario, stepped at once: robots drive, meet, sense and arrive without Python in
// the loop. Meters, seconds, radians.
#pragma once

#include "math/rng.h"
#include "robot/drive.h"
#include "simulator/archive.h"
#include "world/world.h"

namespace fgenv {

enum class Response : uint8_t { stop, terminate, pass };  // to a collision
enum class Status : uint8_t { moving, parked, gone };

struct Lidar {
    double range = 0;
    Vec3 position{0, 0, 0};        // on the root link
    std::vector<Vec3> directions;  // in its frame
};

// A robot, the same in all worlds.
struct Agent {
    BodyId id = -1;
    std::shared_ptr<const Robot> robot;
    Drive drive;
    Lidar lidar;
    double position_tolerance = 0.1, angle_tolerance = 0.2;  // of the goal
    double radius = 0;                                       // of its farthest point from its base
    std::vector<std::vector<double>> starts, goals;          // by case
    std::vector<BodyId> parts;                               // sorted

    // A base that moves has a position of two or three coordinates; else its joints are what gets it there.
    bool moves() const { return size(robot->joints[0].kind) > 0; }
    int32_t base() const { return size(robot->joints[0].kind); }
    int32_t axes() const { return base() == 3 ? 2 : base() == 7 ? 3 : robot->nq(); }
};

// What a row of observations holds, in this order.
struct Senses {
    bool goal = true, velocity = true, configuration = false, path_hint = false, lidar = true;
    int32_t neighbors = 0;
    double neighbor_range = 0;  // meters over which neighbors fade; 0: they do not
    bool intent = false;        // of neighbors is told: where they are headed
    bool priority = false;      // neighbors that go before the robot, then those that go after it
    double look_ahead = 1;      // meters, or radians of joints, along the path
};

// What a reward is the sum of, times these.
struct Weights {
    double progress = 0;   // meters (radians of joints) nearer to the goal
    double arrival = 0;    // 1 once
    double collision = 0;  // 1 where the robot met something
    double obstacle = 0;   // 1 more where that is no robot
    double time = 0;       // 1 each step on the way
    double effort = 0;     // mean square of the action, in [0, 1]
    double closeness = 0;  // 1 in contact, falling to 0 at `near` meters of clearance
};

struct SimulatorSettings {
    double dt = 0.1;
    int64_t horizon = 600;  // steps of an episode
    Response response = Response::stop;
    bool vanish = false;           // at the goal
    bool way_points = false;       // are what an action asks for
    double way_point_seconds = 1;  // at full speed, to the farthest
    bool random = false;           // starts and goals anew for each episode, else those of a case
    bool in_order = false;         // world of seed s begins with case s, and goes on from there; else at random
    bool clearance = false;        // is measured after each step
    double near = 0.5;
    double tolerance = 1e-4;  // meters that a robot may stop before a contact
    Senses senses;
    Weights weights;
};

using Way = std::vector<std::vector<double>>;  // configurations

// A robot in its episode.
struct Runner {
    std::vector<double> q, goal;
    std::vector<double> action;  // in force in the last step, units of the drive
    Way path;                    // from the start to the goal, or what was set since
    bool has_mask = false;       // of the path
    Status status = Status::moving;
    double remaining = 0;  // to the goal: meters, or radians of joints
    // Of the last step
    BodyId hit = -1, hit_part = -1;  // whom it met, with which of its bodies
    double hit_time = 0;             // seconds in the step
    Vec3 hit_point{0, 0, 0};         // found at once where robots pass, else when it is asked for
    int64_t checks = 0;
    int32_t masked = 0;
    double clearance = HUGE_VAL;
    double reward = 0;
    // Of the episode
    int64_t collisions = 0, arrived = -1;  // -1: not yet; else the step
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
    int64_t number = 0, steps = 0, of_case = 0;
    bool terminated = false, truncated = false;
    std::vector<Runner> runners;

    template <class A>
    void visit(A& archive) {
        archive(seed, number, steps, of_case, terminated, truncated);
        for (Runner& runner : runners) runner.visit(archive);
    }
};

// A part of an agent's row of observations.
struct Slice {
    std::string name;
    int32_t begin, size;
};

class Simulator {
public:
    // `like` has all bodies and robots. `stands`: bodies that stand elsewhere in each case, at `poses[case]`.
    Simulator(const World& like, std::vector<Agent> agents, SimulatorSettings settings, int32_t worlds,
              std::vector<BodyId> stands, std::vector<std::vector<Rigid>> poses);

    Simulator(const Simulator&) = delete;

    int32_t n_worlds() const { return static_cast<int32_t>(episodes_.size()); }
    int32_t n_agents() const { return static_cast<int32_t>(agents_.size()); }
    const Agent& agent(int32_t i) const { return agents_[i]; }
    const SimulatorSettings& settings() const { return settings_; }
    const Episode& episode(int32_t e) const { return *episodes_[e]; }
    int32_t robot_of(BodyId body) const;  // -1: it is none

    int32_t action_size(int32_t i) const;
    std::vector<Slice> slices(int32_t i) const;
    int32_t action_size() const { return action_size_; }            // greatest
    int32_t observation_size() const { return observation_size_; }  // greatest

    // Of one world; those of different worlds may run side by side.
    void reset(int32_t e, const uint64_t* seed);  // null: the next episode
    void place(int32_t e, int32_t i, const std::vector<double>& start, const std::vector<double>& goal);
    void set_path(int32_t e, int32_t i, Way path);
    void step(int32_t e, const double* actions);  // (agents, action_size())
    void observe(int32_t e, float* rows) const;   // (agents, observation_size())
    void toward(int32_t e, int32_t i, const double* target, double* action) const;
    Vec3 hit_point(int32_t e, int32_t i) const;  // of the last step, world
    void save(int32_t e, Writer& out);
    void load(int32_t e, Reader& in);

private:
    using Targets = std::vector<std::vector<double>>;  // by agent

    void begin(Episode& episode, const Targets& starts, const Targets& goals);
    void put(Episode& episode, int32_t i, const std::vector<double>& start, const std::vector<double>& goal);
    void set_path(Episode& episode, int32_t i, Way path);
    bool scatter(Episode& episode, Rng& rng, Targets& out) const;
    bool drive(Episode& episode, int32_t i, const double* asked, Place& to);
    void meet(Episode& episode, int32_t i, const MotionOutcome& outcome, const std::vector<int32_t>& order,
              const std::vector<Place>& from, const std::vector<Place>& to);
    void settle(Episode& episode, int32_t i, const double* asked);
    double remaining(const Agent& agent, const Runner& runner) const;
    bool arrived(const Agent& agent, const Runner& runner) const;
    struct Bodies;
    Rigid base_frame(const Agent& agent, const double* q) const;
    void sense_goal(const Agent& agent, const Runner& runner, float*& out) const;
    void sense_path(const Agent& agent, const Runner& runner, float*& out) const;
    void sense_neighbors(const Episode& episode, int32_t i, const Bodies& bodies, float*& out) const;
    void sense_neighbor(const Episode& episode, int32_t i, int32_t j, double far, const Bodies& bodies,
                        float*& out) const;
    void sense_lidar(const Episode& episode, int32_t i, const Rigid& base, float*& out) const;

    std::vector<Agent> agents_;
    SimulatorSettings settings_;
    std::vector<std::unique_ptr<Episode>> episodes_;
    std::vector<BodyId> stands_;
    std::vector<std::vector<Rigid>> poses_;
    int32_t action_size_ = 0, observation_size_ = 0;
    bool flat_ = true;  // all on planar bases
};

}  // namespace fgenv
