#include "simulator/simulator.h"

#include <algorithm>
#include <cmath>

#include "math/constants.h"

namespace fgenv {
namespace {

// The robots of a scenario as bodies of a world.
std::vector<RobotSpec> found_in(const World& world, std::vector<RobotSpec> specs) {
    for (RobotSpec& spec : specs) {
        const Body& body = world.body(spec.id);
        spec.robot = body.robot;
        spec.parts = body.parts;
        std::sort(spec.parts.begin(), spec.parts.end());
    }
    return specs;
}

constexpr double max_coordinate = 1e9;  // m or rad, as of vertices

bool finite(const std::vector<double>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

bool bounded(const std::vector<double>& coordinates) {
    return std::all_of(coordinates.begin(), coordinates.end(), [](double x) { return std::fabs(x) <= max_coordinate; });
}

// Whether the sizes of a robot's state are those of its specification.
bool fits(const RobotState& robot, const RobotSpec& spec) {
    const size_t nq = spec.robot->nq();
    bool ok = robot.q.size() == nq && robot.goal.size() == nq && robot.status <= Status::gone && !robot.path.empty() &&
              robot.action.size() == static_cast<size_t>(spec.drive.n_actions());
    for (const std::vector<double>& q : robot.path) ok &= q.size() == nq && bounded(q);
    return ok && bounded(robot.q) && bounded(robot.goal) && bounded(robot.action);
}

// Whether the results of the last step are in their ranges.
bool in_range(const RobotState& robot, const World& world) {
    const auto is_body = [&](BodyId id) { return id == -1 || (id >= 0 && id < world.end_id() && world.find(id)); };
    const Vec3 p = robot.hit_point;
    return is_body(robot.hit) && is_body(robot.hit_part) && (robot.hit < 0 || robot.hit_part >= 0) &&
           finite({robot.remaining, robot.hit_time, p.x, p.y, p.z, robot.reward, robot.traveled}) &&
           robot.hit_time >= 0 && robot.traveled >= 0 && !std::isnan(robot.clearance) &&
           !std::isnan(robot.least_clearance) && robot.checks >= 0 && robot.masked >= 0 && robot.collisions >= 0 &&
           robot.arrived >= -1;
}

}  // namespace

Simulator::Simulator(const World& like, std::vector<RobotSpec> specs, const SimulatorSettings& settings, int32_t worlds,
                     CaseBodies bodies, std::vector<Footprint> footprints)
    : specs_(found_in(like, std::move(specs))),
      settings_(settings),
      bodies_(std::move(bodies)),
      observer_(specs_, settings.observation) {
    if (!footprints.empty()) planner_ = std::make_unique<GlobalPlanner>(specs_, settings_, std::move(footprints));
    for (int32_t i = 0; i < n_robots(); ++i) action_size_ = std::max(action_size_, action_size(i));
    for (int32_t e = 0; e < worlds; ++e) {
        episodes_.push_back(std::make_unique<Episode>(like));
        Episode& episode = *episodes_.back();
        episode.seed = e;
        episode.number = -1;
        for (const RobotSpec& spec : specs_) {
            episode.robots.emplace_back();
            episode.robots.back().action.resize(spec.drive.n_actions());
        }
    }
}

int32_t Simulator::robot_of(BodyId body) const {
    for (int32_t i = 0; i < n_robots(); ++i)
        if (std::binary_search(specs_[i].parts.begin(), specs_[i].parts.end(), body)) return i;
    return -1;
}

int32_t Simulator::action_size(int32_t i) const {
    const RobotSpec& spec = specs_[i];
    return settings_.waypoint_actions ? waypoint_size(*spec.robot, spec.drive) : spec.drive.n_actions();
}

void Simulator::set_path(int32_t e, int32_t i, Waypoints path) { set_path(*episodes_[e], i, std::move(path)); }

// Robots that do not move have no path.
void Simulator::set_path(Episode& episode, int32_t i, Waypoints path) const {
    RobotState& robot = episode.robots[i];
    if (robot.status != Status::moving) return;
    std::vector<Place> places;
    for (const std::vector<double>& q : path) places.push_back({identity(), q});
    episode.world.set_path(specs_[i].id, std::move(places));
    robot.path = std::move(path);
    robot.has_mask = true;
}

void Simulator::plan(Episode& episode) {
    if (!planner_) return;
    std::vector<Waypoints> paths = planner_->plan(episode);
    for (int32_t i = 0; i < n_robots(); ++i)
        if (!paths[i].empty()) set_path(episode, i, std::move(paths[i]));
}

void Simulator::observe(int32_t e, float* rows) const { observer_.write(*episodes_[e], rows); }

void Simulator::toward(int32_t e, int32_t i, const double* target, double* action) const {
    approach_command(*specs_[i].robot, specs_[i].drive, episodes_[e]->robots[i].q.data(), target, settings_.dt, action);
}

void Simulator::save(int32_t e, Writer& out) { episodes_[e]->visit(out); }

void Simulator::load(int32_t e, Reader& in) {
    Episode& episode = *episodes_[e];
    episode.visit(in);
    if (episode.steps < 0 || episode.number < 0 || episode.case_number < 0 ||
        episode.case_number >= static_cast<int64_t>(specs_[0].starts.size()))
        damaged_state();
    if (!bodies_.ids.empty()) episode.world.set_poses(bodies_.ids, bodies_.poses[episode.case_number]);
    for (int32_t i = 0; i < n_robots(); ++i) {
        const RobotSpec& spec = specs_[i];
        const RobotState& robot = episode.robots[i];
        if (!fits(robot, spec) || !in_range(robot, episode.world)) damaged_state();
        episode.world.clear_path(spec.id);
        episode.world.set_configuration(spec.id, robot.q);
        episode.world.set_present(spec.id, robot.status != Status::gone);
        if (robot.has_mask) set_path(episode, i, Waypoints(robot.path));
    }
}

}  // namespace fgenv
