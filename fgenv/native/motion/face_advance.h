// Conservative advancement of two moving faces.
#pragma once

#include "motion/advance.h"
#include "query/edge_face.h"
#include "query/kernels.h"

namespace fgenv {

// Triangles are relative to b's origin, along the world's axes.
class FaceAdvance {
public:
    FaceAdvance(const Moving& a, const Moving& b, FacePair pair, const CertifySettings& s)
        : a_(a), b_(b), settings_(s), fa_(triangle(a.shape->mesh, pair.a)), fb_(triangle(b.shape->mesh, pair.b)) {
        const Acceleration at_a = a.motion->acceleration(), at_b = b.motion->acceleration();
        for (int k = 0; k < 3; ++k) {
            radius_a_ = greater(radius_a_, orthonormality * norm(fa_[k]));
            radius_b_ = greater(radius_b_, orthonormality * norm(fb_[k]));
        }
        acceleration_ = at_a.at_origin + at_a.by_radius * radius_a_ + at_b.at_origin + at_b.by_radius * radius_b_;
    }

    // Certified time after t during which the faces stay apart; 0 if none can be certified.
    double stay(double t) {
        place(t);
        const Nearest near = kernels().nearest_faces(xa_.data(), xb_.data());
        double longest = stay_along(unit(near.on_b - near.on_a));
        if (longest > 0) return longest;
        // At small gaps rounding dominates that direction; directions from the faces' features are independent of the gap.
        for_each_product([&](Vec3 along) {
            const Vec3 n = unit(along);
            longest = greater(longest, greater(stay_along(n), stay_along(-1.0 * n)));
        });
        return longest;
    }

    // Normals of planes at t that the faces' features span, of any length.
    template <class Use>
    void for_each_normal(double t, Use use) {
        place(t);
        for_each_product(use);
        for (const Triangle* x : {&xa_, &xb_}) {
            const Vec3 n = cross(side(*x, 0), side(*x, 1));
            for (int i = 0; i < 3; ++i) use(cross(side(*x, i), n));
        }
    }

    // Whether the faces overlap at t, or are closer than the margin.
    bool meet(double t) {
        place(t);
        if (settings_.margin > 0 &&
            kernels().nearest_faces(xa_.data(), xb_.data()).squared <= settings_.margin * settings_.margin)
            return true;
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3;
            if (edge_meets_face(xa_[k], xa_[l], xb_.data()) || edge_meets_face(xb_[k], xb_[l], xa_.data())) return true;
        }
        return false;
    }

    // Bound on the relative speed of any two points of the faces.
    double speed() const {
        return norm(now_.va.v - now_.vb.v) + norm(now_.va.w) * radius_a_ + norm(now_.vb.w) * radius_b_;
    }

private:
    template <class Use>
    void for_each_product(Use use) const {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) use(cross(side(xa_, i), side(xb_, j)));
        use(cross(side(xa_, 0), side(xa_, 1)));
        use(cross(side(xb_, 0), side(xb_, 1)));
    }
    static Vec3 side(const Triangle& face, int k) { return face[(k + 1) % 3] - face[k]; }

    // Certified time during which a plane normal to the unit vector n separates the faces, with b on its positive side.
    double stay_along(Vec3 n) const {
        double at_a[3], at_b[3], of_a[3], of_b[3];  // heights and speeds of corners along n
        for (int k = 0; k < 3; ++k) {
            at_a[k] = dot(n, xa_[k]) + settings_.margin + slack_;
            at_b[k] = dot(n, xb_[k]);
            of_a[k] = dot(n, now_.va.v + cross(now_.va.w, xa_[k] - center_a_));
            of_b[k] = dot(n, now_.vb.v + cross(now_.vb.w, xb_[k]));
        }
        double longest = HUGE_VAL;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                const double gap = at_b[l] - at_a[k];
                if (!(gap > 0)) return 0;
                longest = lesser(longest, time_to(gap, of_a[k] - of_b[l], acceleration_));
            }
        return longest;
    }

    void place(double t) {
        now_ = instant(a_, b_, t);
        center_a_ = origin(now_.a) - origin(now_.b);
        for (int k = 0; k < 3; ++k) {
            xa_[k] = center_a_ + rotate(now_.a, fa_[k]);
            xb_[k] = rotate(now_.b, fb_[k]);
        }
        slack_ = rounding_slack(now_, radius_a_ + radius_b_);
    }

    const Moving &a_, &b_;
    const CertifySettings& settings_;
    Triangle fa_, fb_, xa_, xb_;
    double radius_a_ = 0, radius_b_ = 0, acceleration_ = 0, slack_ = 0;
    Vec3 center_a_{0, 0, 0};
    Instant now_;
};

}  // namespace fgenv
