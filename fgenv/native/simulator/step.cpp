// One step: drives, the collision check of all motions at once, goals and rewards.
#include <algorithm>

#include "query/contact.h"
#include "simulator/simulator.h"

namespace fgenv {
namespace {

// Angle between a base and its goal, radians.
double turn_to_goal(const RobotSpec& spec, const RobotState& robot) {
    const double *q = robot.q.data(), *g = robot.goal.data();
    if (spec.base_size() == 3) return std::fabs(change(Coordinate::angle, q[2], g[2]));
    if (spec.base_size() == 7) return norm(Slerp({q[3], q[4], q[5], q[6]}, {g[3], g[4], g[5], g[6]}).turn());
    return 0;
}

bool is_joint(const Joint& joint) {
    return joint.kind == JointKind::prismatic || joint.kind == JointKind::revolute ||
           joint.kind == JointKind::continuous;
}

double mean_square(const double* action, int32_t n) {
    double out = 0;
    for (int32_t k = 0; k < n; ++k) {
        const double x = lesser(greater(action[k], -1), 1);
        out += x * x / n;
    }
    return out;
}

// A point where two shapes touch, or nearly touch.
Vec3 contact_point(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb) {
    const ContactInfo contact = contact_of(a, ta, b, tb, true);
    return contact.hit ? contact.point : apply(ta, nearest_pair(a, ta, b, tb).on_a);
}

void clear_last_step(RobotState& robot) {
    robot.hit = -1;
    robot.hit_time = 0;
    robot.hit_point = {0, 0, 0};
    robot.checks = robot.masked = 0;
}

}  // namespace

// Of the robots that move in a step.
struct Simulator::Motions {
    std::vector<int32_t> robots;
    std::vector<BodyId> ids;
    std::vector<Place> from, to;

    void add(int32_t i, BodyId id, const std::vector<double>& q, Place target) {
        robots.push_back(i);
        ids.push_back(id);
        from.push_back({identity(), q});
        to.push_back(std::move(target));
    }
    // Its index, -1: the robot rests.
    int64_t find(int32_t robot) const {
        const auto at = std::lower_bound(robots.begin(), robots.end(), robot);
        return at == robots.end() || *at != robot ? -1 : at - robots.begin();
    }
};

void Simulator::step(int32_t e, const double* actions) {
    Episode& episode = *episodes_[e];
    ++episode.steps;
    move(episode, actions);
    bool all_arrived = true, some_hit = false, some_parked = false;
    for (int32_t i = 0; i < n_robots(); ++i) {
        RobotState& robot = episode.robots[i];
        robot.reward = 0;
        if (robot.status == Status::moving) finish(episode, i, actions + i * action_size_);
        all_arrived &= robot.status != Status::moving;
        some_hit |= robot.hit >= 0;
        some_parked |= robot.status == Status::parked && robot.arrived == episode.steps;
    }
    episode.terminated = all_arrived || (some_hit && settings_.response == CollisionResponse::terminate);
    episode.truncated = !episode.terminated && episode.steps >= settings_.horizon;
    if (some_parked && !episode.over()) plan(episode);
}

// All robots at once, each up to its first contact.
void Simulator::move(Episode& episode, const double* actions) const {
    Motions motions;
    for (int32_t i = 0; i < n_robots(); ++i) {
        RobotState& robot = episode.robots[i];
        clear_last_step(robot);
        Place to;
        if (robot.status == Status::moving && drive(episode, i, actions + i * action_size_, to))
            motions.add(i, specs_[i].id, robot.q, std::move(to));
    }
    MotionSettings certified;
    certified.certify.tolerance = settings_.tolerance;
    const std::vector<MotionOutcome> outcomes =
        episode.world.advance(motions.ids, motions.to, certified, settings_.response == CollisionResponse::pass);
    for (size_t k = 0; k < motions.ids.size(); ++k) {
        const int32_t i = motions.robots[k];
        RobotState& robot = episode.robots[i];
        robot.q = episode.world.body(motions.ids[k]).q;
        robot.traveled += specs_[i].distance(motions.from[k].q.data(), robot.q.data());
        robot.checks = outcomes[k].checks;
        robot.masked = outcomes[k].masked;
        if (outcomes[k].contact.found) record_hit(episode, motions, k, outcomes[k]);
    }
}

// The target of a robot's motion; false: the robot rests.
bool Simulator::drive(Episode& episode, int32_t i, const double* action, Place& to) const {
    const RobotSpec& spec = specs_[i];
    RobotState& robot = episode.robots[i];
    std::vector<double> to_waypoint;
    if (settings_.waypoint_actions) {
        to_waypoint.resize(spec.drive.n_actions());
        std::vector<double> target(robot.q.size());
        waypoint_target(*spec.robot, spec.drive, robot.q.data(), action, settings_.waypoint_seconds, target.data());
        approach_command(*spec.robot, spec.drive, robot.q.data(), target.data(), settings_.dt, to_waypoint.data());
        action = to_waypoint.data();
        set_path(episode, i, {robot.q, std::move(target)});
    }
    limit_action(spec.drive, action, robot.action.data(), settings_.dt, robot.action.data());
    to.q.resize(robot.q.size());
    drive_forward(*spec.robot, spec.drive, robot.action.data(), robot.q.data(), settings_.dt, to.q.data());
    return to.q != robot.q;
}

// Robots that stop are still in contact, so hit_point() computes the point on demand. If robots pass, it is computed
// here, with both bodies where they were at the time of contact.
void Simulator::record_hit(Episode& episode, const Motions& motions, size_t k, const MotionOutcome& outcome) const {
    RobotState& robot = episode.robots[motions.robots[k]];
    const double t = outcome.contact.free_until;
    robot.hit = outcome.other;
    robot.hit_part = outcome.part;
    robot.hit_time = t * settings_.dt;
    ++robot.collisions;
    if (settings_.response != CollisionResponse::pass) {
        std::fill(robot.action.begin(), robot.action.end(), 0.0);
        return;
    }
    const auto pose_at_contact = [&](const Body& body) {
        const int32_t i = robot_of(body.id);
        const int64_t m = i < 0 ? -1 : motions.find(i);
        if (m < 0) return body.pose;
        const Robot* tree = specs_[i].robot.get();
        return body.in(frames_at(tree, between(tree, motions.from[m], motions.to[m], t)));
    };
    const Body &part = episode.world.body(outcome.part), &other = episode.world.body(outcome.other);
    robot.hit_point = contact_point(*part.shape, pose_at_contact(part), *other.shape, pose_at_contact(other));
}

Vec3 Simulator::hit_point(int32_t e, int32_t i) const {
    const RobotState& robot = episodes_[e]->robots[i];
    if (robot.hit < 0 || settings_.response == CollisionResponse::pass) return robot.hit_point;
    const Body &part = episodes_[e]->world.body(robot.hit_part), &other = episodes_[e]->world.body(robot.hit);
    return contact_point(*part.shape, part.pose, *other.shape, other.pose);
}

// The distances, the reward and the arrival of a robot after its motion.
void Simulator::finish(Episode& episode, int32_t i, const double* action) const {
    const RobotSpec& spec = specs_[i];
    RobotState& robot = episode.robots[i];
    const double before = robot.remaining;
    robot.remaining = spec.distance(robot.q.data(), robot.goal.data());
    if (settings_.needs_clearance()) {
        robot.clearance = episode.world.clearance({spec.id}, {{identity(), robot.q}}, now).distance;
        robot.least_clearance = lesser(robot.least_clearance, robot.clearance);
    }
    robot.reward = reward(robot, i, before, action);
    if (!arrived(spec, robot)) return;
    robot.reward += settings_.reward.arrival;
    robot.arrived = episode.steps;
    robot.status = settings_.vanish ? Status::gone : Status::parked;
    std::fill(robot.action.begin(), robot.action.end(), 0.0);
    robot.has_mask = false;
    if (settings_.vanish)
        episode.world.set_present(spec.id, false);
    else
        episode.world.clear_path(spec.id);
}

// All terms but the arrival; `before`: the distance to the goal before the step.
double Simulator::reward(const RobotState& robot, int32_t i, double before, const double* action) const {
    const RewardWeights& w = settings_.reward;
    double out = 0;
    if (settings_.needs_clearance()) out += w.closeness * greater(0, 1 - robot.clearance / settings_.closeness_range);
    out += w.progress * (before - robot.remaining) + w.time + w.effort * mean_square(action, action_size(i));
    if (robot.hit >= 0) out += w.collision + (robot_of(robot.hit) < 0 ? w.obstacle : 0);
    return out;
}

bool Simulator::arrived(const RobotSpec& spec, const RobotState& robot) const {
    if (spec.base_size() > 0 &&
        (robot.remaining > spec.position_tolerance || turn_to_goal(spec, robot) > spec.angle_tolerance))
        return false;
    return std::all_of(spec.robot->joints.begin(), spec.robot->joints.end(), [&](const Joint& joint) {
        if (!is_joint(joint)) return true;
        const int32_t k = joint.first;
        const double by = std::fabs(change(spec.robot->coordinates[k], robot.q[k], robot.goal[k]));
        return by <= (joint.kind == JointKind::prismatic ? spec.position_tolerance : spec.angle_tolerance);
    });
}

}  // namespace fgenv
