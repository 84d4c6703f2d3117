// Planes at rest between two bodies that slide flush: one proof for a whole stretch of time.
//
// A step of conservative advancement takes acceleration as equal in all directions: a part that turns on a table
// with a gap of 1e-11 m then advances by 1e-6 of its turn. Along the axis of a turn, however, nothing accelerates.
// Each plane is tested with the velocity and the acceleration of every point along its normal.
#pragma once

#include <vector>

#include "motion/advance.h"
#include "motion/hull.h"

namespace fgenv {

class FlushPlane {
public:
    FlushPlane(const Moving& a, const Moving& b, const Hull& of_a, const Hull& of_b, double margin)
        : a_(a),
          b_(b),
          of_a_(of_a),
          of_b_(of_b),
          margin_(margin),
          radii_(orthonormality * (of_a.radius + of_b.radius)) {}

    // Candidate normals (world, of any length) for the stretch after t; (0, 0, 0) is skipped.
    void begin(double t) {
        now_ = instant(a_, b_, t);
        normals_.clear();
        rounding_ = rounding_slack(now_, radii_);
        add(now_.va.w);
        add(now_.vb.w);
    }
    void add(Vec3 n) {
        if (norm(n) > 0) normals_.push_back(unit(n));
    }
    const Instant& now() const { return now_; }
    int count() const { return static_cast<int>(normals_.size()); }

    // Time during which one of the planes is proved to separate the hulls, at most `longest`.
    double stay(double longest) const {
        double best = 0;
        for_each_side([&](Vec3 n) {
            const double first = gap(n, 0) - rounding_;
            if (!(first > 0) || best >= longest) return;
            // The gap is a concave function of time less a convex bound: its chord is a lower bound.
            const double last = gap(n, longest) - rounding_;
            best = greater(best, last > 0 ? longest : longest * (first / (first - last)) * (1 - 1e-12));
        });
        return best;
    }

    // Time during which one of the planes separates the hulls to within the rounding of their coordinates, if they
    // are free at both ends: by their placed points there, and with nothing between that bends by more than
    // rounding. For gaps that are too small for `stay`. Hulls that touch while they slide are never among them.
    double graze(double longest) const {
        double best = 0;
        for_each_side([&](Vec3 n) {
            const double first = gap(n, now_);
            if (best >= longest || !(first > -2 * rounding_)) return;
            double s = longest;
            const double bend = most_bend(n), drift = velocity_rounding();
            if (0.5 * bend * s * s + drift * s > rounding_) s = time_to(rounding_, drift, bend);
            if (s <= best) return;
            const double last = gap(n, instant(a_, b_, now_.t + s));
            const bool slides = first > 0 && last > 0;
            const bool parts = last > -2 * rounding_ && greater(first, last) > rounding_;  // or meets
            if (slides || parts) best = s;
        });
        return best;
    }

private:
    template <class F>
    void for_each_side(F test) const {
        for (const Vec3& n : normals_) {
            test(n);
            test(-1.0 * n);
        }
    }

    double velocity_rounding() const {  // of the velocities of points along a normal
        return 2e-15 * (a_.motion->speed(of_a_.radius) + b_.motion->speed(of_b_.radius));
    }

    // Gap of the placed points along n, with b on the positive side.
    double gap(Vec3 n, const Instant& at) const {
        const double top = highest(a_, of_a_, at.a, at.va, n, 0),
                     bottom = -highest(b_, of_b_, at.b, at.vb, -1.0 * n, 0);
        return dot(n, origin(at.b) - origin(at.a)) + bottom - top - margin_;
    }

    // Lower bound on that gap at `after`, but for the rounding of the points.
    double gap(Vec3 n, double after) const {
        const double top = highest(a_, of_a_, now_.a, now_.va, n, after);
        const double bottom = -highest(b_, of_b_, now_.b, now_.vb, -1.0 * n, after);
        const Vec3 offset = origin(now_.b) - origin(now_.a), apart = now_.vb.v - now_.va.v;
        return dot(n, offset) + after * dot(n, apart) + bottom - top - margin_ - after * velocity_rounding();
    }

    // Upper bound on the height of a hull over its origin, which moves at constant velocity here.
    static double highest(const Moving& m, const Hull& hull, const Rigid& at, const Velocity& u, Vec3 n, double after) {
        double top = -HUGE_VAL;
        const Vec3 turn = cross(n, u.w);
        for (int32_t i = 0; i < hull.count; ++i) {
            const Vec3 arm = rotate(at, hull[i]);
            double height = dot(n, arm);
            if (after > 0)
                height += after * dot(turn, arm) + 0.5 * after * after * m.motion->acceleration_along(n, hull[i]);
            top = greater(top, height);
        }
        return top;
    }

    double most_bend(Vec3 n) const {
        double of_a = 0, of_b = 0;
        for (int32_t i = 0; i < of_a_.count; ++i) of_a = greater(of_a, a_.motion->acceleration_along(n, of_a_[i]));
        for (int32_t i = 0; i < of_b_.count; ++i) of_b = greater(of_b, b_.motion->acceleration_along(n, of_b_[i]));
        return of_a + of_b;
    }

    const Moving &a_, &b_;
    const Hull of_a_, of_b_;
    const double margin_, radii_;
    double rounding_ = 0;
    Instant now_;
    std::vector<Vec3> normals_;
};

}  // namespace fgenv
