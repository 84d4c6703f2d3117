// One step: drives, motions checked all at once, goals, rewards.
#include <algorithm>

#include "query/contact.h"
#include "simulator/simulator.h"

namespace fgenv {
namespace {

double length_of(const Agent& agent, const double* from, const double* to) {
    double squared = 0;
    for (int32_t k = 0; k < agent.axes(); ++k) {
        const double by = change(agent.robot->coordinates[k], from[k], to[k]);
        squared += by * by;
    }
    return std::sqrt(squared);
}

// How far a base is turned from its goal, radians.
double turn_to_goal(const Agent& agent, const Runner& runner) {
    const double *q = runner.q.data(), *g = runner.goal.data();
    if (agent.base() == 3) return std::fabs(change(Coordinate::angle, q[2], g[2]));
    if (agent.base() == 7) return norm(Slerp({q[3], q[4], q[5], q[6]}, {g[3], g[4], g[5], g[6]}).turn());
    return 0;
}

// A point where two shapes touch, or nearly.
Vec3 touch_of(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb) {
    const ContactInfo touch = contact_of(a, ta, b, tb, true);
    return touch.hit ? touch.point : apply(ta, nearest_pair(a, ta, b, tb).on_a);
}

}  // namespace

double Simulator::remaining(const Agent& agent, const Runner& runner) const {
    return length_of(agent, runner.q.data(), runner.goal.data());
}

bool Simulator::arrived(const Agent& agent, const Runner& runner) const {
    if (agent.moves() &&
        (runner.remaining > agent.position_tolerance || turn_to_goal(agent, runner) > agent.angle_tolerance))
        return false;
    for (const Joint& joint : agent.robot->joints) {
        if (joint.kind != JointKind::prismatic && joint.kind != JointKind::revolute &&
            joint.kind != JointKind::continuous)
            continue;
        const int32_t k = joint.first;
        const double by = std::fabs(change(agent.robot->coordinates[k], runner.q[k], runner.goal[k]));
        if (by > (joint.kind == JointKind::prismatic ? agent.position_tolerance : agent.angle_tolerance)) return false;
    }
    return true;
}

// Where a robot wants to be after the step; false: it rests.
bool Simulator::drive(Episode& episode, int32_t i, const double* asked, Place& to) {
    const Agent& agent = agents_[i];
    Runner& runner = episode.runners[i];
    std::vector<double> to_way_point;
    if (settings_.way_points) {
        to_way_point.resize(agent.drive.n_actions());
        std::vector<double> target(runner.q.size());
        waypoint_target(*agent.robot, agent.drive, runner.q.data(), asked, settings_.way_point_seconds, target.data());
        approach_command(*agent.robot, agent.drive, runner.q.data(), target.data(), settings_.dt, to_way_point.data());
        asked = to_way_point.data();
        set_path(episode, i, {runner.q, std::move(target)});
    }
    limit_action(agent.drive, asked, runner.action.data(), settings_.dt, runner.action.data());
    to.q.resize(runner.q.size());
    drive_forward(*agent.robot, agent.drive, runner.action.data(), runner.q.data(), settings_.dt, to.q.data());
    return to.q != runner.q;
}

void Simulator::step(int32_t e, const double* actions) {
    Episode& episode = *episodes_[e];
    const int32_t n = n_agents();
    ++episode.steps;
    std::vector<int32_t> order;  // of those that move
    std::vector<BodyId> ids;
    std::vector<Place> from, to;
    for (int32_t i = 0; i < n; ++i) {
        Runner& runner = episode.runners[i];
        runner.hit = -1;
        runner.hit_time = 0;
        runner.hit_point = {0, 0, 0};
        runner.checks = runner.masked = 0;
        Place place;
        if (runner.status != Status::moving || !drive(episode, i, actions + i * action_size_, place)) continue;
        order.push_back(i);
        ids.push_back(agents_[i].id);
        from.push_back({identity(), runner.q});
        to.push_back(std::move(place));
    }
    MotionSettings certified;
    certified.certify.tolerance = settings_.tolerance;
    const std::vector<MotionOutcome> outcomes =
        episode.world.advance(ids, to, certified, settings_.response == Response::pass);
    for (size_t k = 0; k < order.size(); ++k) {
        Runner& runner = episode.runners[order[k]];
        runner.q = episode.world.body(ids[k]).q;
        runner.traveled += length_of(agents_[order[k]], from[k].q.data(), runner.q.data());
        runner.checks = outcomes[k].checks;
        runner.masked = outcomes[k].masked;
        if (outcomes[k].contact.found) meet(episode, order[k], outcomes[k], order, from, to);
    }
    bool all_there = true, some_hit = false;
    for (int32_t i = 0; i < n; ++i) {
        settle(episode, i, actions + i * action_size_);
        all_there &= episode.runners[i].status != Status::moving;
        some_hit |= episode.runners[i].hit >= 0;
    }
    episode.terminated = all_there || (some_hit && settings_.response == Response::terminate);
    episode.truncated = !episode.terminated && episode.steps >= settings_.horizon;
}

// Whom a robot met, and when. Who stops is there still, and where is told when it is asked for; where those
// met that pass has to be found now.
void Simulator::meet(Episode& episode, int32_t i, const MotionOutcome& outcome, const std::vector<int32_t>& order,
                     const std::vector<Place>& from, const std::vector<Place>& to) {
    Runner& runner = episode.runners[i];
    const double t = outcome.contact.free_until;
    runner.hit = outcome.other;
    runner.hit_part = outcome.part;
    runner.hit_time = t * settings_.dt;
    ++runner.collisions;
    if (settings_.response != Response::pass) {
        std::fill(runner.action.begin(), runner.action.end(), 0.0);
        return;
    }
    const auto then = [&](const Body& body) {
        const int32_t robot = robot_of(body.id);
        const auto found = std::lower_bound(order.begin(), order.end(), robot);
        if (robot < 0 || found == order.end() || *found != robot) return body.pose;
        const size_t k = found - order.begin();
        const Robot* tree = agents_[robot].robot.get();
        return body.in(frames_at(tree, between(tree, from[k], to[k], t)));
    };
    const Body &part = episode.world.body(outcome.part), &other = episode.world.body(outcome.other);
    runner.hit_point = touch_of(*part.shape, then(part), *other.shape, then(other));
}

Vec3 Simulator::hit_point(int32_t e, int32_t i) const {
    const Runner& runner = episodes_[e]->runners[i];
    if (runner.hit < 0 || settings_.response == Response::pass) return runner.hit_point;
    const Body &part = episodes_[e]->world.body(runner.hit_part), &other = episodes_[e]->world.body(runner.hit);
    return touch_of(*part.shape, part.pose, *other.shape, other.pose);
}

// After the motion: the way gone, the goal, the reward.
void Simulator::settle(Episode& episode, int32_t i, const double* asked) {
    const Agent& agent = agents_[i];
    Runner& runner = episode.runners[i];
    runner.reward = 0;
    if (runner.status != Status::moving) return;
    const Weights& w = settings_.weights;
    const double before = runner.remaining;
    runner.remaining = remaining(agent, runner);
    if (settings_.clearance || w.closeness != 0) {
        runner.clearance = episode.world.clearance({agent.id}, {{identity(), runner.q}}, now).distance;
        runner.least_clearance = lesser(runner.least_clearance, runner.clearance);
        runner.reward += w.closeness * greater(0, 1 - runner.clearance / settings_.near);
    }
    double effort = 0;
    for (int32_t k = 0; k < action_size(i); ++k) {
        const double x = lesser(greater(asked[k], -1), 1);
        effort += x * x / action_size(i);
    }
    runner.reward += w.progress * (before - runner.remaining) + w.time + w.effort * effort;
    if (runner.hit >= 0) runner.reward += w.collision + (robot_of(runner.hit) < 0 ? w.obstacle : 0);
    if (!arrived(agent, runner)) return;
    runner.reward += w.arrival;
    runner.arrived = episode.steps;
    runner.status = settings_.vanish ? Status::gone : Status::parked;
    std::fill(runner.action.begin(), runner.action.end(), 0.0);
    runner.has_mask = false;
    if (settings_.vanish)
        episode.world.set_present(agent.id, false);
    else
        episode.world.clear_path(agent.id);
}

}  // namespace fgenv
