// What robots observe: rows of floats, part by part.
#include <algorithm>

#include "simulator/simulator.h"

namespace fgenv {
namespace {

// Numbers of a neighbor.
int32_t width_of(const Senses& s, bool flat) { return (flat ? 7 : 11) + (s.intent ? (flat ? 2 : 3) : 0); }

void write(float*& out, double x) { *out++ = static_cast<float>(x); }

// Where a way is nearest to a position, and from there `ahead` along it; of `axes` coordinates.
std::vector<double> ahead_on(const Agent& agent, const Way& path, const double* q, double ahead) {
    const int32_t n = agent.axes();
    const auto by = [&](const double* from, const double* to, int32_t k) {
        return change(agent.robot->coordinates[k], from[k], to[k]);
    };
    const auto length = [&](size_t leg) {
        double squared = 0;
        for (int32_t k = 0; k < n; ++k) squared += std::pow(by(path[leg].data(), path[leg + 1].data(), k), 2);
        return std::sqrt(squared);
    };
    double nearest = HUGE_VAL, at = 0;
    size_t leg = 0;
    for (size_t i = 0; i + 1 < path.size(); ++i) {
        double along = 0, squared = 0, gap = 0;
        for (int32_t k = 0; k < n; ++k) {
            const double d = by(path[i].data(), path[i + 1].data(), k);
            along += d * by(path[i].data(), q, k);
            squared += d * d;
        }
        const double t = squared > 0 ? lesser(greater(along / squared, 0), 1) : 0;
        for (int32_t k = 0; k < n; ++k)
            gap += std::pow(by(path[i].data(), q, k) - t * by(path[i].data(), path[i + 1].data(), k), 2);
        if (gap > nearest) continue;  // of two as near the later
        nearest = gap;
        leg = i;
        at = t;
    }
    if (path.size() < 2) return path[0];
    double rest = ahead;
    for (; leg + 1 < path.size(); ++leg, at = 0) {
        const double whole = length(leg);
        if (rest <= (1 - at) * whole && whole > 0) {
            const double t = at + rest / whole;
            std::vector<double> out(agent.robot->nq());
            interpolate(*agent.robot, path[leg].data(), path[leg + 1].data(), t, out.data());
            return out;
        }
        rest -= (1 - at) * whole;
    }
    return path.back();
}

}  // namespace

struct Simulator::Bodies {
    std::vector<Rigid> bases;      // frames of the root links
    std::vector<Vec3> velocities;  // of their origins, world
};

std::vector<Slice> Simulator::slices(int32_t i) const {
    const Agent& agent = agents_[i];
    const Senses& s = settings_.senses;
    const int32_t joints = agent.robot->nq() - agent.base();
    const int32_t place = agent.base() == 3 ? 4 : agent.base();
    std::vector<Slice> out;
    int32_t at = 0;
    const auto add = [&](bool expected, const char* name, int32_t n) {
        if (!expected || n == 0) return;
        out.push_back({name, at, n});
        at += n;
    };
    add(s.goal, "goal", place + joints);
    add(s.velocity, "velocity", agent.drive.n_actions());
    add(s.configuration, "configuration", agent.robot->nq());
    add(s.path_hint, "path_hint", agent.axes());
    add(true, "neighbors", s.neighbors * (s.priority ? 2 : 1) * width_of(s, flat_));
    add(s.lidar, "lidar", static_cast<int32_t>(agent.lidar.directions.size()));
    return out;
}

void Simulator::observe(int32_t e, float* rows) const {
    const Episode& episode = *episodes_[e];
    Bodies bodies;
    for (int32_t i = 0; i < n_agents(); ++i) {
        const Agent& agent = agents_[i];
        const Runner& runner = episode.runners[i];
        bodies.bases.push_back(base_frame(agent, runner.q.data()));
        bodies.velocities.push_back(rotate(bodies.bases.back(), base_velocity(agent.drive, runner.action.data())));
    }
    const Senses& s = settings_.senses;
    for (int32_t i = 0; i < n_agents(); ++i) {
        const Agent& agent = agents_[i];
        const Runner& runner = episode.runners[i];
        float* out = rows + i * observation_size_;
        float* const end = out + observation_size_;
        if (s.goal) sense_goal(agent, runner, out);
        if (s.velocity)
            for (double x : runner.action) write(out, x);
        if (s.configuration)
            for (double x : runner.q) write(out, x);
        if (s.path_hint) sense_path(agent, runner, out);
        if (s.neighbors) sense_neighbors(episode, i, bodies, out);
        if (s.lidar) sense_lidar(episode, i, bodies.bases[i], out);
        std::fill(out, end, 0.0f);
    }
}

Rigid Simulator::base_frame(const Agent& agent, const double* q) const {
    const Joint& joint = agent.robot->joints[0];
    return carried(joint, joint.origin, q);
}

void Simulator::sense_goal(const Agent& agent, const Runner& runner, float*& out) const {
    const double *q = runner.q.data(), *goal = runner.goal.data();
    if (agent.base()) {
        const Offset o = base_offset(*agent.robot, q, goal);
        for (int32_t k = 0; k < agent.axes(); ++k) write(out, o.by[k]);
        if (agent.base() == 3) {
            double s, c;
            sin_cos(o.turn, s, c);
            write(out, c);
            write(out, s);
        } else {
            const Quaternion turn =
                relative(Quaternion{q[3], q[4], q[5], q[6]}, Quaternion{goal[3], goal[4], goal[5], goal[6]});
            for (double x : {turn.x, turn.y, turn.z, turn.w}) write(out, x);
        }
    }
    for (int32_t k = agent.base(); k < agent.robot->nq(); ++k)
        write(out, change(agent.robot->coordinates[k], q[k], goal[k]));
}

void Simulator::sense_path(const Agent& agent, const Runner& runner, float*& out) const {
    const std::vector<double> point = ahead_on(agent, runner.path, runner.q.data(), settings_.senses.look_ahead);
    if (agent.base()) {
        const Offset o = base_offset(*agent.robot, runner.q.data(), point.data());
        for (int32_t k = 0; k < agent.axes(); ++k) write(out, o.by[k]);
    } else {
        for (int32_t k = 0; k < agent.axes(); ++k)
            write(out, change(agent.robot->coordinates[k], runner.q[k], point[k]));
    }
}

// The nearest robots, by the origins of their bases; zeros where there are no more. With a range their numbers fade
// to zeros where their circles are so far apart, and a direction takes the place of the position. With priorities
// those that go before the robot, then as many of those that go after it.
void Simulator::sense_neighbors(const Episode& episode, int32_t i, const Bodies& bodies, float*& out) const {
    const int32_t n = n_agents();
    const auto tell = [&](int32_t from, int32_t to) {
        std::vector<std::pair<double, int32_t>> near;
        for (int32_t j = from; j < to; ++j) {
            if (j == i || episode.runners[j].status == Status::gone) continue;
            const Vec3 d = origin(bodies.bases[j]) - origin(bodies.bases[i]);
            near.emplace_back(dot(d, d), j);
        }
        const size_t k = std::min<size_t>(near.size(), settings_.senses.neighbors);
        std::partial_sort(near.begin(), near.begin() + k, near.end());
        for (size_t m = 0; m < k; ++m)
            sense_neighbor(episode, i, near[m].second, std::sqrt(near[m].first), bodies, out);
        const size_t rest = (settings_.senses.neighbors - k) * width_of(settings_.senses, flat_);
        std::fill(out, out + rest, 0.0f);
        out += rest;
    };
    if (!settings_.senses.priority) return tell(0, n);
    tell(0, i);
    tell(i, n);
}

void Simulator::sense_neighbor(const Episode& episode, int32_t i, int32_t j, double far, const Bodies& bodies,
                               float*& out) const {
    const Rigid& own = bodies.bases[i];
    const double range = settings_.senses.neighbor_range, radius = agents_[j].radius;
    Rigid there = relative(own, bodies.bases[j]);
    const Vec3 v = unrotate(own, bodies.velocities[j] - bodies.velocities[i]);
    double closeness = 1;
    if (range > 0) {
        closeness = greater(0, 1 - (far - agents_[i].radius - radius) / range);
        for (double& x : there.t) x = far > 0 ? x / far : 0;
    }
    const auto tell = [&](std::initializer_list<double> numbers) {
        for (double x : numbers) write(out, closeness * x);
    };
    if (flat_) {
        tell({there.t[0], there.t[1], there.r[0][0], there.r[1][0], v.x, v.y, radius});
    } else {
        const Quaternion turn = quaternion_of(there);
        tell({there.t[0], there.t[1], there.t[2], turn.x, turn.y, turn.z, turn.w, v.x, v.y, v.z, radius});
    }
    if (settings_.senses.intent) {
        const Rigid goal = base_frame(agents_[j], episode.runners[j].goal.data());
        const Vec3 way = unrotate(own, origin(goal) - origin(bodies.bases[j]));
        flat_ ? tell({way.x, way.y}) : tell({way.x, way.y, way.z});
    }
}

// Meters to the first surface on each ray; the range where there is none, and for who is gone.
void Simulator::sense_lidar(const Episode& episode, int32_t i, const Rigid& base, float*& out) const {
    const Agent& agent = agents_[i];
    const size_t n = agent.lidar.directions.size();
    if (n == 0) return;
    std::vector<double> distances(n, agent.lidar.range);
    if (episode.runners[i].status != Status::gone) {
        std::vector<Vec3> directions;
        for (const Vec3& d : agent.lidar.directions) directions.push_back(rotate(base, d));
        episode.world.scan(apply(base, agent.lidar.position), directions, agent.lidar.range, agent.parts,
                           distances.data());
    }
    for (double d : distances) write(out, d);
}

void Simulator::toward(int32_t e, int32_t i, const double* target, double* action) const {
    approach_command(*agents_[i].robot, agents_[i].drive, episodes_[e]->runners[i].q.data(), target, settings_.dt,
                     action);
}

}  // namespace fgenv
