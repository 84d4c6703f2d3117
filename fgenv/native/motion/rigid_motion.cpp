#include "motion/rigid_motion.h"

#include <algorithm>

namespace fgenv {
namespace {

constexpr double piece = 0.25;  // radians of rotation per piece of a swept box
constexpr int max_pieces = 64;
constexpr double point_rounding = 1e-14;  // relative to the coordinates: bound on the error of placing a point

}  // namespace

BodyMotion::~BodyMotion() = default;

double BodyMotion::speed(double radius) const {
    const Velocity half_way = velocity(0.5);
    const Acceleration a = acceleration();
    return norm(half_way.v) + 0.5 * a.at_origin + (norm(half_way.w) + 0.5 * a.by_radius) * radius;
}

double BodyMotion::acceleration_along(Vec3, Vec3 point) const {
    const Acceleration a = acceleration();
    return a.at_origin + orthonormality * a.by_radius * norm(point);
}

RigidMotion::RigidMotion(const Rigid& start, const Rigid& end, const Rigid* offset)
    : start_(start),
      end_{end.t[0], end.t[1], end.t[2]},
      offset_(offset ? *offset : identity()),
      has_offset_(offset != nullptr),
      shift_(origin(end) - origin(start)),
      turn_(turn_between(start, end)),
      angle_(norm(turn_)) {
    const double centripetal = orthonormality * angle_ * angle_;
    acceleration_ = {centripetal * norm(origin(offset_)), centripetal};
}

// A point at r from the frame's origin accelerates by -w^2 times the part of r across the axis k. Along n that is
// at most w^2 |n x k| |r x k|: nothing for a turn about n, nor for points on the axis.
double RigidMotion::acceleration_along(Vec3 n, Vec3 point) const {
    const double rate = rate_ * angle_;
    if (rate == 0) return 0;
    constexpr double rounding = 1e-15;  // bound on the error of a product of two vectors, relative to their lengths
    const Vec3 k = unit(turn_), r = rotate(start_, apply(offset_, point));
    return rate * rate * (norm(cross(n, k)) + rounding) * (norm(cross(r, k)) + rounding * norm(r));
}

RigidMotion RigidMotion::retimed(double begin, double rate) const {
    RigidMotion out = *this;
    out.begin_ = begin_ + rate_ * begin;
    out.rate_ = rate_ * rate;
    const double squared = rate * rate;
    out.acceleration_ = {squared * acceleration_.at_origin, squared * acceleration_.by_radius};
    return out;
}

Rigid RigidMotion::frame(double t) const {
    const double s = lesser(greater(begin_ + rate_ * t, 0), 1);
    Rigid out = turned(start_, s * turn_);
    out.t[0] = s < 1 ? start_.t[0] + s * shift_.x : end_[0];
    out.t[1] = s < 1 ? start_.t[1] + s * shift_.y : end_[1];
    out.t[2] = s < 1 ? start_.t[2] + s * shift_.z : end_[2];
    return out;
}

Rigid RigidMotion::pose(double t) const { return has_offset_ ? compose(frame(t), offset_) : frame(t); }

Velocity RigidMotion::velocity(double t) const {
    Velocity out;
    pose(t, out);
    return out;
}

Rigid RigidMotion::pose(double t, Velocity& velocity) const {
    const Rigid at = frame(t);
    velocity = {rate_ * shift_, rate_ * turn_};
    if (!has_offset_) return at;
    velocity.v = velocity.v + cross(velocity.w, rotate(at, origin(offset_)));
    return compose(at, offset_);
}

Box posed_box(const Shape& shape, const Rigid& pose) {
    // On each axis, the smaller extent of the upright and the oriented box around the shape.
    const Box& upright = shape.mesh.bounds;
    const Vec3 middle = 0.5 * (upright.lo + upright.hi), half = upright.hi - middle;
    const OrientedBox& fitted = shape.tree.boxes[0];
    const Vec3 center = apply(pose, middle), c = apply(pose, {fitted.center[0], fitted.center[1], fitted.center[2]});
    double lo[3], hi[3];
    for (int i = 0; i < 3; ++i) {
        const double* row = pose.r[i];
        double upright_half = std::fabs(row[0]) * half.x + std::fabs(row[1]) * half.y + std::fabs(row[2]) * half.z;
        double fitted_half = 0;
        for (int k = 0; k < 3; ++k)
            fitted_half += fitted.half[k] * std::fabs(row[0] * fitted.axis[k][0] + row[1] * fitted.axis[k][1] +
                                                      row[2] * fitted.axis[k][2]);
        fitted_half *= 1 + 1e-6;  // its axes are floats
        const double slack = point_rounding * (std::fabs(pose.t[i]) + shape.radius);
        lo[i] = greater(coordinate(center, i) - upright_half, coordinate(c, i) - fitted_half) - slack;
        hi[i] = lesser(coordinate(center, i) + upright_half, coordinate(c, i) + fitted_half) + slack;
    }
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

Box swept_box(const Shape& shape, const BodyMotion& motion, double lo, double hi) {
    const double turn = motion.turn() * (hi - lo);
    const int pieces = std::clamp(static_cast<int>(std::ceil(turn / piece)), 1, max_pieces);
    Box out = empty_box();
    for (int i = 0; i <= pieces; ++i)
        grow(out, posed_box(shape, motion.pose(i == pieces ? hi : lo + i * ((hi - lo) / pieces))));
    // Between the ends of a piece, a point deviates from the straight line by at most an eighth of its
    // acceleration times the square of the piece's length.
    const Acceleration a = motion.acceleration();
    const double length = (hi - lo) / pieces;
    const double stray = 0.125 * length * length * (a.at_origin + a.by_radius * shape.radius);
    const Vec3 wide{stray, stray, stray};
    return {out.lo - wide, out.hi + wide};
}

}  // namespace fgenv
