#include "robot/link_motion.h"

#include <algorithm>

namespace fgenv {
namespace {

Slerp slerp_of(const Robot& robot, const double* q0, const double* q1) {
    if (robot.joints[0].kind != JointKind::free) return {{0, 0, 0, 1}, {0, 0, 0, 1}};
    return {{q0[3], q0[4], q0[5], q0[6]}, {q1[3], q1[4], q1[5], q1[6]}};
}

// A joint's frame, from its parent's pose.
Rigid frame(const Joint& joint, const Rigid& parent) {
    return joint.parent < 0 ? joint.origin : compose(parent, joint.origin);
}

}  // namespace

RobotMotion::RobotMotion(const Robot& robot, const double* q0, const double* q1)
    : robot_(&robot), q0_(q0, q0 + robot.nq()), q1_(q1, q1 + robot.nq()), slerp_(slerp_of(robot, q0, q1)) {
    links_.reserve(robot.joints.size());
    for (const Joint& joint : robot.joints) {
        Link link = joint.parent < 0 ? Link{true, identity(), {}} : links_[joint.parent];
        const Rigid held = frame(joint, link.at), next = carry(joint, held, 0);
        link.at = next;
        if (moves(joint)) {
            bound(joint, held, link);
            link.chain.pass(next);
            link.still = false;
            link.at = identity();
        }
        links_.push_back(link);
    }
}

bool RobotMotion::moves(const Joint& joint) const {
    const auto from = q0_.begin() + joint.first, to = q1_.begin() + joint.first;
    return !std::equal(from, from + size(joint.kind), to);
}

double RobotMotion::change_of(const Joint& joint, int32_t k) const {
    const int32_t i = joint.first + k;
    return joint.multiplier * change(robot_->coordinates[i], q0_[i], q1_[i]);
}

Rigid RobotMotion::carry(const Joint& joint, const Rigid& held, double s) const {
    double x[7];
    for (int32_t k = 0; k < size(joint.kind); ++k) {
        const int32_t i = joint.first + k;
        x[k] = between(robot_->coordinates[i], q0_[i], q1_[i], s);
    }
    if (joint.kind == JointKind::free) {
        const Quaternion q = slerp_.at(s);
        x[3] = q.x, x[4] = q.y, x[5] = q.z, x[6] = q.w;
    }
    return carried(joint, held, x);
}

void RobotMotion::bound(const Joint& joint, const Rigid& held, Link& link) const {
    switch (joint.kind) {
        case JointKind::fixed: return;
        case JointKind::revolute:
        case JointKind::continuous: return link.chain.turn(origin(held), rotate(held, joint.axis), change_of(joint, 0));
        case JointKind::prismatic:
            return link.chain.shift(origin(carry(joint, held, 0)), origin(carry(joint, held, 1)),
                                    rotate(held, joint.axis), change_of(joint, 0));
        case JointKind::planar: return link.chain.turn({0, 0, 0}, rotate(held, {0, 0, 1}), change_of(joint, 2));
        case JointKind::free: {
            const Vec3 turn = rotate(held, slerp_.turn());
            return link.chain.turn({0, 0, 0}, unit(turn), norm(turn));
        }
    }
}

const RobotMotion::Snapshot* RobotMotion::snapshot(double s) const {
    if (s != 0 && s != 0.5 && s != 1) return nullptr;
    Snapshot& out = snapshots_[static_cast<size_t>(2 * s)];
    if (!out.poses.empty()) return &out;
    for (int32_t link = 0; link < robot_->n_links(); ++link) {
        const int32_t parent = robot_->joints[link].parent;
        Velocity velocity{{0, 0, 0}, {0, 0, 0}};
        if (parent >= 0) velocity = out.velocities[parent];
        out.poses.push_back(next(link, s, parent < 0 ? identity() : out.poses[parent], velocity));
        out.velocities.push_back(velocity);
    }
    return &out;
}

Rigid RobotMotion::pose(int32_t link, double s) const {
    if (links_[link].still) return links_[link].at;
    if (const Snapshot* known = snapshot(s)) return known->poses[link];
    const Joint& joint = robot_->joints[link];
    return carry(joint, joint.parent < 0 ? joint.origin : compose(pose(joint.parent, s), joint.origin), s);
}

Rigid RobotMotion::pose(int32_t link, double s, Velocity& velocity) const {
    if (const Snapshot* known = snapshot(s)) {
        velocity = known->velocities[link];
        return known->poses[link];
    }
    return chain(link, s, velocity);
}

Rigid RobotMotion::chain(int32_t link, double s, Velocity& velocity) const {
    velocity = {{0, 0, 0}, {0, 0, 0}};
    if (links_[link].still) return links_[link].at;
    const int32_t parent = robot_->joints[link].parent;
    return next(link, s, parent < 0 ? identity() : chain(parent, s, velocity), velocity);
}

// A link's pose and velocity, from those of its parent.
Rigid RobotMotion::next(int32_t link, double s, const Rigid& parent, Velocity& velocity) const {
    if (links_[link].still) {
        velocity = {{0, 0, 0}, {0, 0, 0}};
        return links_[link].at;
    }
    const Joint& joint = robot_->joints[link];
    const Rigid held = frame(joint, parent), placed = carry(joint, held, s);
    Vec3 &v = velocity.v, &w = velocity.w;
    v = v + cross(w, origin(placed) - origin(parent));
    switch (joint.kind) {
        case JointKind::fixed: break;
        case JointKind::revolute:
        case JointKind::continuous: w = w + change_of(joint, 0) * rotate(held, joint.axis); break;
        case JointKind::prismatic: v = v + change_of(joint, 0) * rotate(held, joint.axis); break;
        case JointKind::planar:
            v = rotate(held, {change_of(joint, 0), change_of(joint, 1), 0});
            w = rotate(held, {0, 0, change_of(joint, 2)});
            break;
        case JointKind::free:
            v = rotate(held, {change_of(joint, 0), change_of(joint, 1), change_of(joint, 2)});
            w = rotate(held, slerp_.turn());
    }
    return placed;
}

Acceleration RobotMotion::acceleration(int32_t link, const Rigid& offset) const {
    return links_[link].chain.acceleration(apply(links_[link].at, origin(offset)));
}

LinkMotion::LinkMotion(const RobotMotion& robot, int32_t link, const Rigid* offset)
    : robot_(&robot),
      link_(link),
      offset_(offset ? *offset : identity()),
      has_offset_(offset != nullptr),
      acceleration_(robot.acceleration(link, offset_)) {}

LinkMotion LinkMotion::retimed(double begin, double rate) const {
    LinkMotion out = *this;
    out.begin_ = begin_ + rate_ * begin;
    out.rate_ = rate_ * rate;
    const double squared = rate * rate;
    out.acceleration_ = {squared * acceleration_.at_origin, squared * acceleration_.by_radius};
    return out;
}

Rigid LinkMotion::pose(double t) const {
    const Rigid at = robot_->pose(link_, fraction(t));
    return has_offset_ ? compose(at, offset_) : at;
}

Velocity LinkMotion::velocity(double t) const {
    Velocity out;
    pose(t, out);
    return out;
}

Rigid LinkMotion::pose(double t, Velocity& velocity) const {
    const Rigid at = robot_->pose(link_, fraction(t), velocity);
    if (has_offset_) velocity.v = velocity.v + cross(velocity.w, rotate(at, origin(offset_)));
    velocity = {rate_ * velocity.v, rate_ * velocity.w};
    return has_offset_ ? compose(at, offset_) : at;
}

}  // namespace fgenv
