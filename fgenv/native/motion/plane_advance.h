// Two bodies, or a shell of each, moving, and a plane between them.
#pragma once

#include "motion/advance.h"
#include "query/gjk.h"

namespace fgenv {

// Points that enclose a body or a shell of it, in the frame of the shape.
struct Hull {
    const Vec3* points;
    const int32_t* which;  // null: the first `count` of them
    int32_t count;
    double radius;  // of the farthest from the frame's origin
};

class PlaneAdvance {
public:
    PlaneAdvance(const Moving& a, const Moving& b, const Hull& of_a, const Hull& of_b, const CertifySettings& s)
        : a_(a), b_(b), of_a_(of_a), of_b_(of_b), settings_(s) {
        const Acceleration at_a = a.motion->acceleration(), at_b = b.motion->acceleration();
        radii_ = orthonormality * (of_a.radius + of_b.radius);
        acceleration_ = at_a.at_origin + at_b.at_origin +
                        orthonormality * (at_a.by_radius * of_a.radius + at_b.by_radius * of_b.radius);
    }

    // How long after t a plane parts them for certain, at most `longest`; 0 if none is found.
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

    // Meters that they are apart then, at least.
    double apart() const { return apart_; }

private:
    struct Corner {
        double most;
        Vec3 at;
    };
    static Corner farthest(const Hull& hull, Vec3 along) {
        Corner out{-HUGE_VAL, {0, 0, 0}};
        for (int32_t i = 0; i < hull.count; ++i) {
            const Vec3& v = hull.points[hull.which ? hull.which[i] : i];
            const double x = dot(along, v);
            if (x > out.most) out = {x, v};
        }
        return out;
    }

    // The plane's normal goes from n to n + s (spin x n); what a point of either is at along it, as all go on
    // at the velocities that they have now, is linear in s but for products of two changes.
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
    // What is between them at time s: the least of linear functions, so a concave one.
    double gap(const Turning& k, double s, Corner& far_a, Corner& far_b) const {
        far_a = farthest(of_a_, k.to_a + s * k.turn_a);
        far_b = farthest(of_b_, -1.0 * (k.to_b + s * k.turn_b));
        return dot(k.n + s * k.change, origin(now_.b) - origin(now_.a)) - s * dot(k.n, now_.va.v - now_.vb.v) -
               far_a.most - far_b.most;
    }

    // Along a plane that stands, and along planes that turn with either body: sides that lie flush stay so.
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
        // Products of changes: of the normal with velocities, and with what bends the points' ways.
        const double grown = 1 + spin * longest;
        const double bend = grown * acceleration_ + 2 * spin * relative_speed();
        const double approach = dot(k.n, now_.va.v - now_.vb.v) - dot(k.change, origin(now_.b) - origin(now_.a)) +
                                dot(k.turn_a, far_a) - dot(k.turn_b, far_b);
        // The tangent ends beyond the true end, the chord to there before it.
        const double s = lesser(longest, time_to(apart_, approach, bend));
        Corner a, b;
        const double then =
            gap(k, s, a, b) - grown * (settings_.margin + rounding_slack(now_, radii_)) - 0.5 * bend * s * s;
        return then > 0 ? s : s * apart_ / (apart_ - then) * (1 - 1e-12);
    }

    // At most, of a point of one against a point of the other.
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
