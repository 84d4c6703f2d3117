// Episodes: how they begin, and how they are kept.
#include "simulator/simulator.h"

#include <algorithm>

#include "math/constants.h"

namespace fgenv {
namespace {

constexpr int tries = 1000;    // for the place of one robot
constexpr double room = 0.02;  // meters that a robot of one shape, put at random, is apart from all else

// Angles in [-pi, pi], quaternions of length 1: what a robot that rests is left at.
std::vector<double> canonical(const Robot& robot, const std::vector<double>& q) {
    std::vector<double> out(q.size());
    interpolate(robot, q.data(), q.data(), 1, out.data());
    return out;
}

// Uniform within the limits; a free base is level.
std::vector<double> anywhere(const Agent& agent, Rng& rng) {
    std::vector<double> q;
    for (int32_t k = 0; k < agent.robot->nq(); ++k)
        q.push_back(rng.between(agent.drive.lower[k], agent.drive.upper[k]));
    if (agent.base() == 7) {
        double s, c;
        sin_cos(rng.between(-0.5 * pi, 0.5 * pi), s, c);
        q[3] = q[4] = 0, q[5] = s, q[6] = c;
    }
    return q;
}

}  // namespace

Simulator::Simulator(const World& like, std::vector<Agent> agents, SimulatorSettings settings, int32_t worlds,
                     std::vector<BodyId> stands, std::vector<std::vector<Rigid>> poses)
    : agents_(std::move(agents)), settings_(settings), stands_(std::move(stands)), poses_(std::move(poses)) {
    for (Agent& agent : agents_) {
        const Body& body = like.body(agent.id);
        agent.robot = body.robot;
        agent.parts = body.parts;
        std::sort(agent.parts.begin(), agent.parts.end());
        flat_ &= agent.base() == 3;
    }
    for (int32_t i = 0; i < n_agents(); ++i) {
        action_size_ = std::max(action_size_, action_size(i));
        const Slice last = slices(i).back();
        observation_size_ = std::max(observation_size_, last.begin + last.size);
    }
    for (int32_t e = 0; e < worlds; ++e) {
        episodes_.push_back(std::make_unique<Episode>(like));
        Episode& episode = *episodes_.back();
        episode.seed = e;
        episode.number = -1;
        for (const Agent& agent : agents_) {
            episode.runners.emplace_back();
            episode.runners.back().action.resize(agent.drive.n_actions());
        }
    }
}

int32_t Simulator::robot_of(BodyId body) const {
    for (int32_t i = 0; i < n_agents(); ++i)
        if (std::binary_search(agents_[i].parts.begin(), agents_[i].parts.end(), body)) return i;
    return -1;
}

int32_t Simulator::action_size(int32_t i) const {
    const Agent& agent = agents_[i];
    return settings_.way_points ? waypoint_size(*agent.robot, agent.drive) : agent.drive.n_actions();
}

void Simulator::reset(int32_t e, const uint64_t* seed) {
    Episode& episode = *episodes_[e];
    if (seed) episode.seed = *seed;
    episode.number = seed ? 0 : episode.number + 1;
    Rng rng(episode.seed, static_cast<uint64_t>(episode.number));
    const int64_t cases = static_cast<int64_t>(agents_[0].starts.size());
    const uint64_t turn = episode.seed + static_cast<uint64_t>(episode.number);
    episode.of_case = cases < 2 ? 0 : settings_.in_order ? static_cast<int64_t>(turn % cases) : rng.below(cases);
    if (!stands_.empty()) episode.world.set_poses(stands_, poses_[episode.of_case]);
    Targets starts, goals;
    if (!settings_.random || !scatter(episode, rng, goals) || !scatter(episode, rng, starts)) {
        starts.clear(), goals.clear();
        for (const Agent& agent : agents_) {
            starts.push_back(agent.starts[episode.of_case]);
            goals.push_back(agent.goals[episode.of_case]);
        }
    }
    begin(episode, starts, goals);
}

// Where nobody meets anybody; false if no room is found.
bool Simulator::scatter(Episode& episode, Rng& rng, Targets& out) const {
    for (const Agent& agent : agents_) episode.world.set_present(agent.id, false);
    for (const Agent& agent : agents_) {
        const double margin = agent.parts.size() == 1 ? room : 0;
        int left = tries;
        Place place;
        do {
            if (left-- == 0) return false;
            place.q = anywhere(agent, rng);
        } while (episode.world.collides(agent.id, place, now, margin));
        episode.world.set_configuration(agent.id, place.q);
        episode.world.set_present(agent.id, true);
        out.push_back(std::move(place.q));
    }
    return true;
}

void Simulator::begin(Episode& episode, const Targets& starts, const Targets& goals) {
    episode.steps = 0;
    episode.terminated = episode.truncated = false;
    for (int32_t i = 0; i < n_agents(); ++i) put(episode, i, starts[i], goals[i]);
}

void Simulator::put(Episode& episode, int32_t i, const std::vector<double>& start, const std::vector<double>& goal) {
    const Agent& agent = agents_[i];
    Runner runner;
    runner.action.resize(agent.drive.n_actions());
    runner.q = canonical(*agent.robot, start);
    runner.goal = canonical(*agent.robot, goal);
    runner.path = {runner.q, runner.goal};
    runner.remaining = remaining(agent, runner);
    episode.world.clear_path(agent.id);
    episode.world.set_configuration(agent.id, runner.q);
    episode.world.set_present(agent.id, true);
    episode.runners[i] = std::move(runner);
}

void Simulator::place(int32_t e, int32_t i, const std::vector<double>& start, const std::vector<double>& goal) {
    put(*episodes_[e], i, start, goal);
}

void Simulator::set_path(int32_t e, int32_t i, Way path) { set_path(*episodes_[e], i, std::move(path)); }

// For who is on the way; else nobody goes along it.
void Simulator::set_path(Episode& episode, int32_t i, Way path) {
    Runner& runner = episode.runners[i];
    if (runner.status != Status::moving) return;
    std::vector<Place> places;
    for (const std::vector<double>& q : path) places.push_back({identity(), q});
    episode.world.set_path(agents_[i].id, std::move(places));
    runner.path = std::move(path);
    runner.has_mask = true;
}

void Simulator::save(int32_t e, Writer& out) { episodes_[e]->visit(out); }

void Simulator::load(int32_t e, Reader& in) {
    Episode& episode = *episodes_[e];
    episode.visit(in);
    const auto damaged = [] { throw std::invalid_argument("state: damaged, or of another simulator"); };
    if (episode.of_case < 0 || episode.of_case >= static_cast<int64_t>(agents_[0].starts.size())) damaged();
    if (!stands_.empty()) episode.world.set_poses(stands_, poses_[episode.of_case]);
    for (int32_t i = 0; i < n_agents(); ++i) {
        const Agent& agent = agents_[i];
        const Runner& runner = episode.runners[i];
        const size_t nq = agent.robot->nq();
        bool sound = runner.q.size() == nq && runner.goal.size() == nq && runner.status <= Status::gone &&
                     runner.action.size() == static_cast<size_t>(agent.drive.n_actions());
        for (const std::vector<double>& q : runner.path) sound &= q.size() == nq;
        if (!sound) damaged();
        episode.world.clear_path(agent.id);
        episode.world.set_configuration(agent.id, runner.q);
        episode.world.set_present(agent.id, runner.status != Status::gone);
        if (runner.has_mask) set_path(e, i, Way(runner.path));
    }
}

}  // namespace fgenv
