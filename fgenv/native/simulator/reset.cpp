// The beginning of episodes.
#include "simulator/simulator.h"

namespace fgenv {
namespace {

constexpr int most_tries = 1000;       // per robot
constexpr double start_margin = 0.02;  // meters between a sampled robot of one part and everything else
constexpr double quarter_turn = 0.5 * 3.14159265358979323846;

// Angles in [-pi, pi] and quaternions of length 1.
std::vector<double> normalized(const Robot& robot, const std::vector<double>& q) {
    std::vector<double> out(q.size());
    interpolate(robot, q.data(), q.data(), 1, out.data());
    return out;
}

// Uniform within the limits; a free base is level.
std::vector<double> sample_configuration(const RobotSpec& spec, Rng& rng) {
    std::vector<double> q;
    for (int32_t k = 0; k < spec.robot->nq(); ++k) q.push_back(rng.between(spec.drive.lower[k], spec.drive.upper[k]));
    if (spec.base_size() == 7) {
        double sine, cosine;
        sin_cos(rng.between(-quarter_turn, quarter_turn), sine, cosine);
        q[3] = q[4] = 0, q[5] = sine, q[6] = cosine;
    }
    return q;
}

}  // namespace

void Simulator::reset(int32_t e, const uint64_t* seed) {
    Episode& episode = *episodes_[e];
    if (seed) episode.seed = *seed;
    episode.number = seed ? 0 : episode.number + 1;
    Rng rng(episode.seed, static_cast<uint64_t>(episode.number));
    const int64_t cases = static_cast<int64_t>(specs_[0].starts.size());
    const uint64_t next = episode.seed + static_cast<uint64_t>(episode.number);
    episode.case_number = cases < 2                ? 0
                          : settings_.case_by_seed ? static_cast<int64_t>(next % cases)
                                                   : rng.below(cases);
    if (!bodies_.ids.empty()) episode.world.set_poses(bodies_.ids, bodies_.poses[episode.case_number]);
    Targets starts, goals;
    if (!settings_.random_starts || !sample(episode, rng, goals) || !sample(episode, rng, starts)) {
        starts.clear(), goals.clear();
        for (const RobotSpec& spec : specs_) {
            starts.push_back(spec.starts[episode.case_number]);
            goals.push_back(spec.goals[episode.case_number]);
        }
    }
    episode.steps = 0;
    episode.terminated = episode.truncated = false;
    for (int32_t i = 0; i < n_robots(); ++i) place(episode, i, starts[i], goals[i]);
    plan(episode);
}

// Configurations without collisions; false if there is no room for a robot.
bool Simulator::sample(Episode& episode, Rng& rng, Targets& out) const {
    for (const RobotSpec& spec : specs_) episode.world.set_present(spec.id, false);
    for (const RobotSpec& spec : specs_) {
        const double margin = spec.parts.size() == 1 ? start_margin : 0;
        int tries = most_tries;
        Place place;
        do {
            if (tries-- == 0) return false;
            place.q = sample_configuration(spec, rng);
        } while (episode.world.collides(spec.id, place, now, margin));
        episode.world.set_configuration(spec.id, place.q);
        episode.world.set_present(spec.id, true);
        out.push_back(std::move(place.q));
    }
    return true;
}

void Simulator::place(int32_t e, int32_t i, const std::vector<double>& start, const std::vector<double>& goal) {
    place(*episodes_[e], i, start, goal);
    plan(*episodes_[e]);
}

void Simulator::place(Episode& episode, int32_t i, const std::vector<double>& start,
                      const std::vector<double>& goal) const {
    const RobotSpec& spec = specs_[i];
    RobotState robot;
    robot.action.resize(spec.drive.n_actions());
    robot.q = normalized(*spec.robot, start);
    robot.goal = normalized(*spec.robot, goal);
    robot.path = {robot.q, robot.goal};
    robot.remaining = spec.distance(robot.q.data(), robot.goal.data());
    episode.world.clear_path(spec.id);
    episode.world.set_configuration(spec.id, robot.q);
    episode.world.set_present(spec.id, true);
    episode.robots[i] = std::move(robot);
}

}  // namespace fgenv
