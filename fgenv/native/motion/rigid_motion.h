// Motions of bodies over fractions t in [0, 1]. For certified checks they provide pose and velocity at any
// t, and a bound on the acceleration of any point. World frame, per unit of t.
#pragma once

#include "math/rotation.h"
#include "shape/shape.h"

namespace fgenv {

struct Velocity {
    Vec3 v;  // of the body's origin
    Vec3 w;  // angular
};

// Bound on acceleration: at_origin + d * by_radius for a point at distance d from the body's origin.
struct Acceleration {
    double at_origin = 0, by_radius = 0;
};

class BodyMotion {
public:
    virtual ~BodyMotion();
    virtual Rigid pose(double t) const = 0;
    virtual Velocity velocity(double t) const = 0;
    virtual Rigid pose(double t, Velocity& velocity) const = 0;
    virtual Acceleration acceleration() const = 0;
    virtual double turn() const = 0;            // radians; upper bound on the rotation over [0, 1]
    virtual double speed(double radius) const;  // upper bound for points within `radius` of the body's origin
    // Upper bound on the acceleration along the unit vector n, at any t, of a point given in the body's frame.
    virtual double acceleration_along(Vec3 n, Vec3 point) const;
};

// Motion of a frame from pose `start` to pose `end`: position linear, orientation along the shortest arc, as in
// OMPL's SE2 and SE3 spaces. The body is fixed in that frame at `offset`.
class RigidMotion final : public BodyMotion {
public:
    RigidMotion() : RigidMotion(identity(), identity()) {}
    RigidMotion(const Rigid& start, const Rigid& end, const Rigid* offset = nullptr);
    // The same motion in the parameter t' with t = begin + rate t'.
    RigidMotion retimed(double begin, double rate) const;

    Rigid pose(double t) const override;
    Velocity velocity(double t) const override;
    Rigid pose(double t, Velocity& velocity) const override;
    Acceleration acceleration() const override { return acceleration_; }
    double acceleration_along(Vec3 n, Vec3 point) const override;
    double turn() const override { return rate_ * angle_; }
    double speed(double radius) const override {
        return rate_ * (norm(shift_) + angle_ * (norm(origin(offset_)) + radius));
    }
    Rigid frame(double t) const;  // pose of the moving frame, without the offset

private:
    Rigid start_;
    double
        end_[3];  // position; the end's rotation is computed from the start's and equals the given one up to rounding
    Rigid offset_;
    bool has_offset_;
    Vec3 shift_, turn_;  // total displacement of the origin, total rotation vector
    double angle_;
    double begin_ = 0, rate_ = 1;
    Acceleration acceleration_;
};

// World-aligned box of a shape at a pose, and of a shape during a motion from t = lo to hi.
Box posed_box(const Shape& shape, const Rigid& pose);
Box swept_box(const Shape& shape, const BodyMotion& motion, double lo, double hi);

}  // namespace fgenv
