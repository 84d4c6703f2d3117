#include "link_motion.h"

#include <algorithm>

namespace fgenv {
namespace {

constexpr double askew = 1.0001;    // poses may be off orthonormal by 1e-5
constexpr double parallel = 1e-6;   // sine of the angle between axes that are taken for one

Slerp slerp_of(const Robot& robot, const double* q0, const double* q1) {
    if (robot.joints[0].kind != JointKind::free) return {{0, 0, 0, 1}, {0, 0, 0, 1}};
    return {{q0[3], q0[4], q0[5], q0[6]}, {q1[3], q1[4], q1[5], q1[6]}};
}

// Bounds that hold all along the motion, carried from the base outwards.
//
// Rates r_k of the joints are constant. Let w, A be the angular velocity and acceleration of a link, p its
// origin. A turn about the axis a (unit, fixed in the link before it) gives
//     w' = w + r a,    A' = A + r (w x a),
// a shift along a, at rate r, from p to p' = p + l,
//     p'' accelerates by A x l + w x (w x l) + 2 w x r a more than p'',
// and so does, with r = 0, any p' = p + l that is fixed in the link. A base moves at constant v and w.
//
// |w| is at most the sum of all |r|, but neighbours do better. Keep w as u + r a, where a is the last
// axis, r its rate and |u| <= `before`. The angle between a and the next axis a' never changes, since both
// are fixed in the link between them; so |w x a'| <= before + |r| |a x a'| and |w'| <= before + |r a + r' a'|.
// Parallel neighbours add up, with their signs, to one; and what is near the axis of a turn is hardly
// accelerated by it: |w x l| <= before |l| + |r| |a x l|.
class ChainBound {
public:
    double turn() const { return w_; }

    // Of a frame that is fixed in the link, at l from its origin.
    Acceleration acceleration(Vec3 l) const {
        return {askew * (at_ + ride(norm(l), off_axis(l))), askew * (turning_ + w_ * w_)};
    }

    // A joint that turns; l: from the link's origin to the joint's, a: its axis, both in the link's frame.
    void turn(Vec3 l, Vec3 a, double rate) {
        at_ += ride(norm(l), off_axis(l));
        const double sine = norm(cross(axis_, a)), cosine = dot(axis_, a);
        turning_ += std::fabs(rate) * across(a);
        const double both = before_ + norm(rate_ * axis_ + rate * a);
        const bool same = sine < parallel && rate_ != 0;
        before_ = same ? before_ + std::fabs(rate_) * sine : w_;
        rate_ = same ? rate_ * cosine + rate : rate;
        w_ = lesser(w_ + std::fabs(rate), both);
        axis_ = a;
    }

    // A joint that shifts; l0, l1: from the link's origin to where it begins and ends.
    void shift(Vec3 l0, Vec3 l1, Vec3 a, double rate) {
        const double length = greater(norm(l0), norm(l1)), off = greater(off_axis(l0), off_axis(l1));
        at_ += ride(length, off) + 2 * std::fabs(rate) * across(a);
    }

    // From here on all is given in the frame of the next link.
    void pass(const Rigid& next) { axis_ = unrotate(next, axis_); }

private:
    double off_axis(Vec3 l) const { return norm(cross(axis_, l)); }
    double across(Vec3 a) const { return lesser(w_, before_ + std::fabs(rate_) * norm(cross(axis_, a))); }
    double ride(double length, double off) const {
        return turning_ * length + w_ * lesser(w_ * length, before_ * length + std::fabs(rate_) * off);
    }

    double w_ = 0, turning_ = 0, at_ = 0;  // at least |w|, |A|, |p''|
    double before_ = 0, rate_ = 0;
    Vec3 axis_{0, 0, 0};
};

}  // namespace

LinkMotion::LinkMotion(const Robot& robot, int32_t link, const double* q0, const double* q1, const Rigid* offset)
    : robot_(&robot), q0_(q0), q1_(q1), slerp_(slerp_of(robot, q0, q1)), start_(identity()),
      offset_(offset ? *offset : identity()), has_offset_(offset != nullptr) {
    for (int32_t i = link; i >= 0; i = robot.joints[i].parent) joints_.push_back(&robot.joints[i]);
    std::reverse(joints_.begin(), joints_.end());
    size_t still = 0;
    for (; still < joints_.size() && !moves(*joints_[still]); ++still) start_ = carry(*joints_[still], start_, 0);
    joints_.erase(joints_.begin(), joints_.begin() + static_cast<std::ptrdiff_t>(still));
    bound();
}

LinkMotion LinkMotion::retimed(double begin, double rate) const {
    LinkMotion out = *this;
    out.begin_ = begin_ + rate_ * begin;
    out.rate_ = rate_ * rate;
    const double squared = rate * rate;
    out.acceleration_ = {squared * acceleration_.at_origin, squared * acceleration_.by_radius};
    return out;
}

bool LinkMotion::moves(const Joint& joint) const {
    const double *from = q0_ + joint.first, *to = q1_ + joint.first;
    return !std::equal(from, from + size(joint.kind), to);
}

double LinkMotion::change_of(const Joint& joint, int32_t k) const {
    const int32_t i = joint.first + k;
    return joint.multiplier * change(robot_->coordinates[i], q0_[i], q1_[i]);
}

Rigid LinkMotion::frame(const Joint& joint, const Rigid& parent) const {
    return joint.parent < 0 ? joint.origin : compose(parent, joint.origin);
}

Rigid LinkMotion::carry(const Joint& joint, const Rigid& parent, double s) const {
    double x[7];
    for (int32_t k = 0; k < size(joint.kind); ++k) {
        const int32_t i = joint.first + k;
        x[k] = between(robot_->coordinates[i], q0_[i], q1_[i], s);
    }
    if (joint.kind == JointKind::free) {
        const Quaternion q = slerp_.at(s);
        x[3] = q.x, x[4] = q.y, x[5] = q.z, x[6] = q.w;
    }
    return carried(joint, frame(joint, parent), x);
}

Rigid LinkMotion::pose(double t) const {
    const double s = fraction(t);
    Rigid at = start_;
    for (const Joint* joint : joints_) at = carry(*joint, at, s);
    return has_offset_ ? compose(at, offset_) : at;
}

Velocity LinkMotion::velocity(double t) const {
    const double s = fraction(t);
    Vec3 v{0, 0, 0}, w{0, 0, 0};
    Rigid at = start_;
    for (const Joint* joint : joints_) {
        const Rigid held = frame(*joint, at), next = carry(*joint, at, s);
        v = v + cross(w, origin(next) - origin(at));
        switch (joint->kind) {
            case JointKind::fixed: break;
            case JointKind::revolute:
            case JointKind::continuous: w = w + change_of(*joint, 0) * rotate(held, joint->axis); break;
            case JointKind::prismatic: v = v + change_of(*joint, 0) * rotate(held, joint->axis); break;
            case JointKind::planar:
                v = rotate(held, {change_of(*joint, 0), change_of(*joint, 1), 0});
                w = rotate(held, {0, 0, change_of(*joint, 2)});
                break;
            case JointKind::free:
                v = rotate(held, {change_of(*joint, 0), change_of(*joint, 1), change_of(*joint, 2)});
                w = rotate(held, slerp_.turn());
        }
        at = next;
    }
    if (has_offset_) v = v + cross(w, rotate(at, origin(offset_)));
    return {rate_ * v, rate_ * w};
}

void LinkMotion::bound() {
    ChainBound chain;
    Rigid rest = start_;  // from the last joint that moves
    for (const Joint* joint : joints_) {
        const Rigid held = frame(*joint, rest), next = carry(*joint, rest, 0);
        if (!moves(*joint)) {
            rest = next;
            continue;
        }
        switch (joint->kind) {
            case JointKind::fixed: break;
            case JointKind::revolute:
            case JointKind::continuous: chain.turn(origin(held), rotate(held, joint->axis), change_of(*joint, 0)); break;
            case JointKind::prismatic:
                chain.shift(origin(next), origin(carry(*joint, rest, 1)), rotate(held, joint->axis), change_of(*joint, 0));
                break;
            case JointKind::planar: chain.turn({0, 0, 0}, rotate(held, {0, 0, 1}), change_of(*joint, 2)); break;
            case JointKind::free: {
                const Vec3 turn = rotate(held, slerp_.turn());
                chain.turn({0, 0, 0}, unit(turn), norm(turn));
            }
        }
        chain.pass(next);
        rest = identity();
    }
    turn_ = chain.turn();
    acceleration_ = chain.acceleration(origin(has_offset_ ? compose(rest, offset_) : rest));
}

}  // namespace fgenv
