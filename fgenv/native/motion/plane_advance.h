// Conservative advancement of two moving bodies, or one shell of each, by a plane between them.
#pragma once

#include "motion/advance.h"
#include "motion/hull.h"
#include "query/gjk.h"

namespace fgenv {

class PlaneAdvance {
public:
    PlaneAdvance(const Moving& a, const Moving& b, const Hull& of_a, const Hull& of_b, const CertifySettings& s)
        : a_(a), b_(b), of_a_(of_a), of_b_(of_b), settings_(s) {
        const Acceleration at_a = a.motion->acceleration(), at_b = b.motion->acceleration();
        radii_ = orthonormality * (of_a.radius + of_b.radius);
        acceleration_ = at_a.at_origin + at_b.at_origin +
                        orthonormality * (at_a.by_radius * of_a.radius + at_b.by_radius * of_b.radius);
    }

    // Certified time after t during which a plane separates them, at most `longest`; 0 if none is found.
    double stay(double t, double longest) {
        now_ = instant(a_, b_, t);
        const double as_before = stay_along(longest);
        if (as_before > 0.5 * longest) return as_before;
        const Vec3 before = along_;
        const double apart_before = apart_;
        const Vec3 guess = norm(before) > 0 ? before : origin(now_.b) - origin(now_.a);
        along_ = unit(direction_apart(
            [&](Vec3 n) {
                const Corner p = farthest(of_a_, unrotate(now_.a, n)), q = farthest(of_b_, -1.0 * unrotate(now_.b, n));
                return (origin(now_.b) - origin(now_.a)) + (rotate(now_.b, q.at) - rotate(now_.a, p.at));
            },
            guess));
        const double anew = stay_along(longest);
        if (anew >= as_before) return anew;
        along_ = before;
        apart_ = apart_before;
        return as_before;
    }

    // Lower bound on their distance at that time (meters).
    double apart() const { return apart_; }
    // Unit normal of the last plane, from a to b; (0, 0, 0) before the first.
    Vec3 normal() const { return along_; }

private:
    struct Corner {
        double most;
        Vec3 at;
    };
    static Corner farthest(const Hull& hull, Vec3 along) {
        Corner out{-HUGE_VAL, {0, 0, 0}};
        for (int32_t i = 0; i < hull.count; ++i) {
            const Vec3& v = hull[i];
            const double x = dot(along, v);
            if (x > out.most) out = {x, v};
        }
        return out;
    }

    // The plane's normal changes from n to n + s (spin x n). With constant velocities, the height of a point of
    // either body along it is linear in s, except for products of two changes.
    struct Turning {
        Vec3 n, change, to_a, to_b, turn_a, turn_b;  // the last four in the frames of a and b
    };
    Turning turning(Vec3 spin) const {
        const Vec3 n = along_, change = cross(spin, n);
        return {n,
                change,
                unrotate(now_.a, n),
                unrotate(now_.b, n),
                unrotate(now_.a, cross(n, now_.va.w) + change),
                unrotate(now_.b, cross(n, now_.vb.w) + change)};
    }
    // Gap between them at time s: a minimum of linear functions, hence concave.
    double gap(const Turning& k, double s, Corner& far_a, Corner& far_b) const {
        far_a = farthest(of_a_, k.to_a + s * k.turn_a);
        far_b = farthest(of_b_, -1.0 * (k.to_b + s * k.turn_b));
        return dot(k.n + s * k.change, origin(now_.b) - origin(now_.a)) - s * dot(k.n, now_.va.v - now_.vb.v) -
               far_a.most - far_b.most;
    }

    // Tries a fixed plane and planes that turn with either body: flush sides stay flush.
    double stay_along(double longest) {
        Corner far_a, far_b;
        apart_ = gap(turning({0, 0, 0}), 0, far_a, far_b) - settings_.margin - rounding_slack(now_, radii_);
        if (!(apart_ > 0)) return 0;
        double best = 0;
        for (const Vec3& spin : {Vec3{0, 0, 0}, now_.va.w, now_.vb.w}) {
            if (best > 0 && norm(spin) == 0) continue;
            best = greater(best, stay_along(turning(spin), norm(spin), far_a.at, far_b.at, longest));
            if (best >= longest) break;
        }
        return best;
    }

    double stay_along(const Turning& k, double spin, Vec3 far_a, Vec3 far_b, double longest) const {
        // Products of changes: the normal's change with velocities and with accelerations.
        const double grown = 1 + spin * longest;
        const double bend = grown * acceleration_ + 2 * spin * relative_speed();
        const double approach = dot(k.n, now_.va.v - now_.vb.v) - dot(k.change, origin(now_.b) - origin(now_.a)) +
                                dot(k.turn_a, far_a) - dot(k.turn_b, far_b);
        // The tangent overestimates the end of the gap, the chord underestimates it.
        const double s = lesser(longest, time_to(apart_, approach, bend));
        Corner a, b;
        const double then =
            gap(k, s, a, b) - grown * (settings_.margin + rounding_slack(now_, radii_)) - 0.5 * bend * s * s;
        return then > 0 ? s : s * apart_ / (apart_ - then) * (1 - 1e-12);
    }

    // Bound on the relative speed of any two points.
    double relative_speed() const {
        return norm(now_.va.v - now_.vb.v) +
               orthonormality * (norm(now_.va.w) * of_a_.radius + norm(now_.vb.w) * of_b_.radius);
    }

    const Moving &a_, &b_;
    const Hull of_a_, of_b_;
    const CertifySettings& settings_;
    double radii_, acceleration_, apart_ = 0;
    Vec3 along_{0, 0, 0};
    Instant now_;
};

}  // namespace fgenv
