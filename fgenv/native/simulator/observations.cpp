#include "simulator/observations.h"

#include <algorithm>

#include "simulator/path_point.h"

namespace fgenv {
namespace {

void write(float*& out, double x) { *out++ = static_cast<float>(x); }

Rigid base_frame(const RobotSpec& spec, const double* q) {
    const Joint& joint = spec.robot->joints[0];
    return carried(joint, joint.origin, q);
}

Quaternion orientation(const std::vector<double>& q) { return {q[3], q[4], q[5], q[6]}; }

}  // namespace

struct Observer::BaseMotions {
    std::vector<Rigid> frames;     // of the root links
    std::vector<Vec3> velocities;  // of their origins, world frame

    BaseMotions(const std::vector<RobotSpec>& specs, const Episode& episode) {
        for (size_t i = 0; i < specs.size(); ++i) {
            const RobotState& state = episode.robots[i];
            frames.push_back(base_frame(specs[i], state.q.data()));
            velocities.push_back(rotate(frames.back(), base_velocity(specs[i].drive, state.action.data())));
        }
    }
};

Observer::Observer(const std::vector<RobotSpec>& specs, const ObservationSettings& settings)
    : specs_(specs), settings_(settings) {
    for (const RobotSpec& spec : specs_) planar_ &= spec.base_size() == 3;
    for (size_t i = 0; i < specs_.size(); ++i)
        for (const Slice& slice : slices(static_cast<int32_t>(i))) size_ = std::max(size_, slice.begin + slice.size);
}

int32_t Observer::neighbor_size() const { return (planar_ ? 7 : 11) + (settings_.intent ? (planar_ ? 2 : 3) : 0); }

std::vector<Slice> Observer::slices(int32_t i) const {
    const RobotSpec& spec = specs_[i];
    const ObservationSettings& s = settings_;
    const int32_t joints = spec.robot->nq() - spec.base_size();
    const int32_t base = spec.base_size() == 3 ? 4 : spec.base_size();
    std::vector<Slice> out;
    int32_t begin = 0;
    const auto add = [&](bool enabled, const char* name, int32_t n) {
        if (!enabled || n == 0) return;
        out.push_back({name, begin, n});
        begin += n;
    };
    add(s.goal, "goal", base + joints);
    add(s.velocity, "velocity", spec.drive.n_actions());
    add(s.configuration, "configuration", spec.robot->nq());
    add(s.path_hint, "path_hint", spec.position_size());
    add(true, "neighbors", s.neighbors * (s.priority ? 2 : 1) * neighbor_size());
    add(s.lidar, "lidar", static_cast<int32_t>(spec.lidar.directions.size()));
    return out;
}

void Observer::write(const Episode& episode, float* rows) const {
    const BaseMotions bases(specs_, episode);
    for (int32_t i = 0; i < static_cast<int32_t>(specs_.size()); ++i) {
        const RobotSpec& spec = specs_[i];
        const RobotState& state = episode.robots[i];
        float* out = rows + i * size_;
        float* const end = out + size_;
        if (settings_.goal) write_goal(spec, state, out);
        if (settings_.velocity)
            for (double x : state.action) fgenv::write(out, x);
        if (settings_.configuration)
            for (double x : state.q) fgenv::write(out, x);
        if (settings_.path_hint) write_path_hint(spec, state, out);
        if (settings_.neighbors) write_neighbors(episode, i, bases, out);
        if (settings_.lidar) write_lidar(episode, i, bases.frames[i], out);
        std::fill(out, end, 0.0f);
    }
}

void Observer::write_goal(const RobotSpec& spec, const RobotState& state, float*& out) const {
    const double *q = state.q.data(), *goal = state.goal.data();
    if (spec.base_size()) {
        const Offset offset = base_offset(*spec.robot, q, goal);
        for (int32_t k = 0; k < spec.position_size(); ++k) fgenv::write(out, offset.by[k]);
        if (spec.base_size() == 3) {
            double sine, cosine;
            sin_cos(offset.turn, sine, cosine);
            fgenv::write(out, cosine);
            fgenv::write(out, sine);
        } else {
            const Quaternion turn = relative(orientation(state.q), orientation(state.goal));
            for (double x : {turn.x, turn.y, turn.z, turn.w}) fgenv::write(out, x);
        }
    }
    for (int32_t k = spec.base_size(); k < spec.robot->nq(); ++k)
        fgenv::write(out, change(spec.robot->coordinates[k], q[k], goal[k]));
}

void Observer::write_path_hint(const RobotSpec& spec, const RobotState& state, float*& out) const {
    const double* q = state.q.data();
    const std::vector<double> point = point_ahead(spec, state.path, q, settings_.look_ahead);
    if (spec.base_size()) {
        const Offset offset = base_offset(*spec.robot, q, point.data());
        for (int32_t k = 0; k < spec.position_size(); ++k) fgenv::write(out, offset.by[k]);
    } else {
        for (int32_t k = 0; k < spec.position_size(); ++k)
            fgenv::write(out, change(spec.robot->coordinates[k], q[k], point[k]));
    }
}

void Observer::write_neighbors(const Episode& episode, int32_t i, const BaseMotions& bases, float*& out) const {
    const int32_t n = static_cast<int32_t>(specs_.size());
    if (!settings_.priority) return write_nearest(episode, i, 0, n, bases, out);
    write_nearest(episode, i, 0, i, bases, out);
    write_nearest(episode, i, i, n, bases, out);
}

// The nearest of the robots first to last - 1, by the origins of their bases; zeros if there are fewer.
void Observer::write_nearest(const Episode& episode, int32_t i, int32_t first, int32_t last, const BaseMotions& bases,
                             float*& out) const {
    std::vector<std::pair<double, int32_t>> near;
    for (int32_t j = first; j < last; ++j) {
        if (j == i || episode.robots[j].status == Status::gone) continue;
        const Vec3 d = origin(bases.frames[j]) - origin(bases.frames[i]);
        near.emplace_back(dot(d, d), j);
    }
    const size_t k = std::min<size_t>(near.size(), settings_.neighbors);
    std::partial_sort(near.begin(), near.begin() + k, near.end());
    for (size_t m = 0; m < k; ++m) write_neighbor(episode, i, near[m].second, std::sqrt(near[m].first), bases, out);
    const size_t rest = (settings_.neighbors - k) * neighbor_size();
    std::fill(out, out + rest, 0.0f);
    out += rest;
}

// With a range, all numbers fade to zero as the distance between enclosing circles
// grows to it, and the position is a direction.
void Observer::write_neighbor(const Episode& episode, int32_t i, int32_t j, double distance, const BaseMotions& bases,
                              float*& out) const {
    const Rigid& own = bases.frames[i];
    const double range = settings_.neighbor_range, radius = specs_[j].radius;
    Rigid frame = relative(own, bases.frames[j]);
    const Vec3 v = unrotate(own, bases.velocities[j] - bases.velocities[i]);
    double closeness = 1;
    if (range > 0) {
        closeness = greater(0, 1 - (distance - specs_[i].radius - radius) / range);
        for (double& x : frame.t) x = distance > 0 ? x / distance : 0;
    }
    const auto write_all = [&](std::initializer_list<double> numbers) {
        for (double x : numbers) fgenv::write(out, closeness * x);
    };
    if (planar_) {
        write_all({frame.t[0], frame.t[1], frame.r[0][0], frame.r[1][0], v.x, v.y, radius});
    } else {
        const Quaternion turn = quaternion_of(frame);
        write_all({frame.t[0], frame.t[1], frame.t[2], turn.x, turn.y, turn.z, turn.w, v.x, v.y, v.z, radius});
    }
    if (!settings_.intent) return;
    const Rigid goal = base_frame(specs_[j], episode.robots[j].goal.data());
    const Vec3 to_goal = unrotate(own, origin(goal) - origin(bases.frames[j]));
    planar_ ? write_all({to_goal.x, to_goal.y}) : write_all({to_goal.x, to_goal.y, to_goal.z});
}

// Meters to the first surface on each ray; the range if there is none, or the robot is gone.
void Observer::write_lidar(const Episode& episode, int32_t i, const Rigid& base, float*& out) const {
    const Lidar& lidar = specs_[i].lidar;
    if (lidar.directions.empty()) return;
    std::vector<double> distances(lidar.directions.size(), lidar.range);
    if (episode.robots[i].status != Status::gone) {
        std::vector<Vec3> directions;
        for (const Vec3& d : lidar.directions) directions.push_back(rotate(base, d));
        episode.world.scan(apply(base, lidar.position), directions, lidar.range, specs_[i].parts, distances.data());
    }
    for (double d : distances) fgenv::write(out, d);
}

}  // namespace fgenv
