// Upper bounds of turn and acceleration of the links of a chain, for any configuration of its joints.
#pragma once

#include "motion/rigid_motion.h"

namespace fgenv {

// Bounds over the whole motion, propagated from the base outwards.
//
// Rates r_k of the joints are constant. Let w, A be the angular velocity and acceleration of a link, p its
// origin. A turn about the axis a (unit, fixed in the link before it) gives
//     w' = w + r a,    A' = A + r (w x a),
// a shift along a, at rate r, from p to p' = p + l,
//     p'' accelerates by A x l + w x (w x l) + 2 w x r a more than p'',
// and so does, with r = 0, any p' = p + l that is fixed in the link. A base moves at constant v and w.
//
// |w| is at most the sum of all |r|, but neighbors do better. Keep w as u + r a, where a is the last
// axis, r its rate and |u| <= `before`. The angle between a and the next axis a' never changes, since both
// are fixed in the link between them; so |w x a'| <= before + |r| |a x a'| and |w'| <= before + |r a + r' a'|.
// Parallel neighbors add up, with their signs, to one; a point near the axis of a turn has a small
// acceleration from it: |w x l| <= before |l| + |r| |a x l|.
class ChainBound {
public:
    double turn() const { return w_; }

    // Acceleration of a frame that is fixed in the link, at l from its origin.
    Acceleration acceleration(Vec3 l) const {
        return {orthonormality * (at_ + ride(norm(l), off_axis(l))), orthonormality * (turning_ + w_ * w_)};
    }

    // Add a revolute joint; l: from the link's origin to the joint's, a: its axis, both in the link's frame.
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

    // Add a prismatic joint; l0, l1: from the link's origin to its first and last position.
    void shift(Vec3 l0, Vec3 l1, Vec3 a, double rate) {
        const double length = greater(norm(l0), norm(l1)), off = greater(off_axis(l0), off_axis(l1));
        at_ += ride(length, off) + 2 * std::fabs(rate) * across(a);
    }

    // Continue in the frame of the next link.
    void pass(const Rigid& next) { axis_ = unrotate(next, axis_); }

private:
    static constexpr double parallel = 1e-6;  // sine of the angle below which axes count as parallel

    double off_axis(Vec3 l) const { return norm(cross(axis_, l)); }
    double across(Vec3 a) const { return lesser(w_, before_ + std::fabs(rate_) * norm(cross(axis_, a))); }
    double ride(double length, double off) const {
        return turning_ * length + w_ * lesser(w_ * length, before_ * length + std::fabs(rate_) * off);
    }

    double w_ = 0, turning_ = 0, at_ = 0;  // at least |w|, |A|, |p''|
    double before_ = 0, rate_ = 0;
    Vec3 axis_{0, 0, 0};
};

}  // namespace fgenv
