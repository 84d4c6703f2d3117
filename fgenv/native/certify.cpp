#include "certify.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "edge_face.h"
#include "gjk.h"
#include "kernels.h"

namespace fgenv {
namespace {

constexpr int max_steps = 3000;    // of one pair of faces
constexpr int some_pairs = 256;    // of faces, and
constexpr int some_boxes = 128;    // pairs of boxes opened: where there are more, half the time is tried,
constexpr int max_halvings = 5;    // up to so many times; then
constexpr int all_pairs = 1 << 16;  // are looked at
constexpr int few_pairs = 4;       // are taken one by one, without halving their time
constexpr int max_splits = 10;     // or more of them after so many times
constexpr int max_planes = 256;    // between two bodies, one after the other, and
constexpr size_t most_pairs = 256; // of their shells
constexpr double askew = 1.0001;   // poses may be off orthonormal by 1e-5
constexpr double rounding = 4e-15; // of the coordinates: more than placing a corner twice is off by

using Corners = std::array<Vec3, 3>;

Corners corners(const Shape& s, int32_t face) {
    const Face& f = s.mesh.faces[face];
    return {s.mesh.vertices[f[0]], s.mesh.vertices[f[1]], s.mesh.vertices[f[2]]};
}

struct Instant {
    double t;
    Rigid a, b;
    Velocity va, vb;
};

Instant instant(const Moving& a, const Moving& b, double t) {
    return {t, a.motion->pose(t), b.motion->pose(t), a.motion->velocity(t), b.motion->velocity(t)};
}

Sweep sweep_of(const Moving& a, const Moving& b, const Instant& now, double half, double margin) {
    const auto side = [&](const Velocity& u, const Acceleration& acc) {
        const double squared = 0.5 * half * half * askew;
        return Sweep::Side{(half * askew) * unrotate(now.a, u.v), (half * askew) * unrotate(now.a, u.w),
                           squared * acc.at_origin, squared * acc.by_radius};
    };
    return {relative(now.a, now.b), side(now.va, a.motion->acceleration()), side(now.vb, b.motion->acceleration()),
            margin, 0};
}

double rounding_slack(const Instant& now, double radii) {
    return rounding * (norm(origin(now.a) - origin(now.b)) + radii) +
           0x1p-51 * (norm(origin(now.a)) + norm(origin(now.b)));
}

// The longest t with approach t + acceleration t^2 / 2 <= gap.
double time_to(double gap, double approach, double acceleration) {
    const double root = std::sqrt(greater(approach * approach + 2 * acceleration * gap, 0));
    if (approach + root > 0 && approach >= 0) return 2 * gap / (approach + root) * (1 - 1e-12);
    return acceleration > 0 ? (root - approach) / acceleration * (1 - 1e-12) : HUGE_VAL;
}

// Two bodies, or a shell of each, moving, and a plane between them.
class PlaneAdvance {
public:
    PlaneAdvance(const Moving& a, const Moving& b, const Piece& of_a, const Piece& of_b, const CertifySettings& s)
        : a_(a), b_(b), of_a_(of_a), of_b_(of_b), settings_(s) {
        const Acceleration at_a = a.motion->acceleration(), at_b = b.motion->acceleration();
        radii_ = askew * (a.shape->radius + b.shape->radius);
        acceleration_ = at_a.at_origin + at_b.at_origin + askew * (at_a.by_radius * a.shape->radius + at_b.by_radius * b.shape->radius);
    }

    // How long after t a plane parts them for certain, at most `longest`; 0 if none is found.
    double stay(double t, double longest) {
        now_ = instant(a_, b_, t);
        const double as_before = stay_along(longest);
        if (as_before > 0.5 * longest) return as_before;
        const Vec3 before = along_;
        const double apart_before = apart_;
        const Vec3 guess = norm(before) > 0 ? before : origin(now_.b) - origin(now_.a);
        along_ = unit(way_apart([&](Vec3 n) {
            const Corner p = farthest(*a_.shape, of_a_, unrotate(now_.a, n)),
                         q = farthest(*b_.shape, of_b_, -1.0 * unrotate(now_.b, n));
            return (origin(now_.b) - origin(now_.a)) + (rotate(now_.b, q.at) - rotate(now_.a, p.at));
        }, guess));
        const double anew = stay_along(longest);
        if (anew >= as_before) return anew;
        along_ = before;
        apart_ = apart_before;
        return as_before;
    }

    // Metres that they are apart then, at least.
    double apart() const { return apart_; }

private:
    struct Corner {
        double most;
        Vec3 at;
    };
    static Corner farthest(const Shape& s, const Piece& piece, Vec3 along) {
        Corner out{-HUGE_VAL, {0, 0, 0}};
        for (int32_t i = piece.begin; i < piece.end; ++i) {
            const Vec3& v = s.mesh.vertices[s.corners[i]];
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
        return {n, change, unrotate(now_.a, n), unrotate(now_.b, n), unrotate(now_.a, cross(n, now_.va.w) + change),
                unrotate(now_.b, cross(n, now_.vb.w) + change)};
    }
    // What is between them at time s: the least of linear functions, so a concave one.
    double gap(const Turning& k, double s, Corner& far_a, Corner& far_b) const {
        far_a = farthest(*a_.shape, of_a_, k.to_a + s * k.turn_a);
        far_b = farthest(*b_.shape, of_b_, -1.0 * (k.to_b + s * k.turn_b));
        return dot(k.n + s * k.change, origin(now_.b) - origin(now_.a)) - s * dot(k.n, now_.va.v - now_.vb.v) - far_a.most - far_b.most;
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
        const double then = gap(k, s, a, b) - grown * (settings_.margin + rounding_slack(now_, radii_)) - 0.5 * bend * s * s;
        return then > 0 ? s : s * apart_ / (apart_ - then) * (1 - 1e-12);
    }

    // At most, of a point of one against a point of the other.
    double relative_speed() const {
        return norm(now_.va.v - now_.vb.v) + askew * (norm(now_.va.w) * a_.shape->radius + norm(now_.vb.w) * b_.shape->radius);
    }

    const Moving &a_, &b_;
    const Piece &of_a_, &of_b_;
    const CertifySettings& settings_;
    double radii_, acceleration_, apart_ = 0;
    Vec3 along_{0, 0, 0};
    Instant now_;
};

// Two faces moving. Corners are placed relative to b's origin, along the axes of the world.
class FaceAdvance {
public:
    FaceAdvance(const Moving& a, const Moving& b, FacePair pair, const CertifySettings& s)
        : a_(a), b_(b), settings_(s), fa_(corners(*a.shape, pair.a)), fb_(corners(*b.shape, pair.b)) {
        const Acceleration at_a = a.motion->acceleration(), at_b = b.motion->acceleration();
        for (int k = 0; k < 3; ++k) {
            radius_a_ = greater(radius_a_, askew * norm(fa_[k]));
            radius_b_ = greater(radius_b_, askew * norm(fb_[k]));
        }
        acceleration_ = at_a.at_origin + at_a.by_radius * radius_a_ + at_b.at_origin + at_b.by_radius * radius_b_;
    }

    // How long the faces stay apart after t, for certain; 0 if that can't be told.
    double stay(double t) {
        place(t);
        const Nearest near = kernels().nearest_faces(xa_.data(), xb_.data());
        double longest = stay_along(unit(near.on_b - near.on_a));
        if (longest > 0) return longest;
        // So near that rounding turns that direction: those of the faces' own features do not feel the gap.
        const auto look_along = [&](Vec3 along) {
            const Vec3 n = unit(along);
            longest = greater(longest, greater(stay_along(n), stay_along(-1.0 * n)));
        };
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) look_along(cross(side(xa_, i), side(xb_, j)));
        look_along(cross(side(xa_, 0), side(xa_, 1)));
        look_along(cross(side(xb_, 0), side(xb_, 1)));
        return longest;
    }

    // Whether the faces meet at t, or are nearer than the margin.
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

    // What a point of one may move against a point of the other, per unit of time.
    double speed() const {
        return norm(now_.va.v - now_.vb.v) + norm(now_.va.w) * radius_a_ + norm(now_.vb.w) * radius_b_;
    }

private:
    static Vec3 side(const Corners& face, int k) { return face[(k + 1) % 3] - face[k]; }

    // How long a plane across the unit vector n parts the faces for certain, b on the side it points to.
    double stay_along(Vec3 n) const {
        double at_a[3], at_b[3], of_a[3], of_b[3];  // corners along n, and how fast
        for (int k = 0; k < 3; ++k) {
            at_a[k] = dot(n, xa_[k]) + settings_.margin + slack_;
            at_b[k] = dot(n, xb_[k]);
            of_a[k] = dot(n, now_.va.v + cross(now_.va.w, xa_[k] - centre_a_));
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
        centre_a_ = origin(now_.a) - origin(now_.b);
        for (int k = 0; k < 3; ++k) {
            xa_[k] = centre_a_ + rotate(now_.a, fa_[k]);
            xb_[k] = rotate(now_.b, fb_[k]);
        }
        slack_ = rounding_slack(now_, radius_a_ + radius_b_);
    }

    const Moving &a_, &b_;
    const CertifySettings& settings_;
    Corners fa_, fb_, xa_, xb_;
    double radius_a_ = 0, radius_b_ = 0, acceleration_ = 0, slack_ = 0;
    Vec3 centre_a_{0, 0, 0};
    Instant now_;
};

class Certifier {
public:
    Certifier(const Moving& a, const Moving& b, const CertifySettings& s, Contact& contact, int64_t& sweeps)
        : a_(a), b_(b), settings_(s), contact_(contact), sweeps_(sweeps),
          speed_(greater(s.speed, a.motion->speed(a.shape->radius) + b.motion->speed(b.shape->radius))) {}

    // What presses on from near contact, as robots do that have stopped at one, is told at once.
    void begin(double lo, double hi) {
        const double soon = lo + 0.5 * bracket(speed_);
        if (soon < lesser(hi, contact_.free_until) && collides(soon)) find(lo, soon);
        else run(lo, hi, 0);
    }

    // In the order of time, so that each stretch begins where all before it is proved free.
    void run(double lo, double hi, int halvings) {
        hi = lesser(hi, contact_.free_until);
        if (lo >= hi || done()) return;
        const double middle = 0.5 * (lo + hi);
        const Instant now = instant(a_, b_, middle);
        const bool last = halvings == max_halvings;
        const int capacity = last ? all_pairs : some_pairs;
        const int count = look(now, lo, hi, capacity, last ? std::numeric_limits<int>::max() : some_boxes);
        if (count && halvings == 0) {
            lo = part(lo, hi);
            if (lo >= lesser(hi, contact_.free_until)) return;
        }
        if (count <= capacity) return settle(0, count, instant(a_, b_, 0.5 * (lo + hi)), lo, hi, 0);
        if (last) return give_up(lo);
        if (!contact_.found && collides(middle)) {
            const double shown = settings_.first ? first_shown(lo, middle) : middle;
            find(shown, shown);
            return run(lo, shown, halvings + 1);
        }
        run(lo, middle, halvings + 1);
        run(middle, hi, halvings + 1);
    }

private:
    bool done() const { return contact_.found && !settings_.first; }

    // Leaves in pairs_ the pairs of faces that may meet from lo to hi; capacity + 1 if there are more.
    int look(const Instant& now, double lo, double hi, int capacity, int budget_of_boxes) {
        ++sweeps_;
        if (static_cast<int>(pairs_.size()) < capacity) pairs_.resize(capacity);
        Sweep sweep = sweep_of(a_, b_, now, 0.5 * (hi - lo), settings_.margin);
        sweep.budget = budget_of_boxes;
        return kernels().sweep(*a_.shape, *b_.shape, sweep, pairs_.data(), capacity);
    }

    // Some of pairs_ from lo to hi, all at once: what is not sure to stay apart is tried again in either
    // half, the last few one by one. What comes after them in pairs_ is room to work in.
    void settle(int begin, int count, const Instant& now, double lo, double hi, int splits) {
        hi = lesser(hi, contact_.free_until);
        if (count == 0 || lo >= hi || done()) return;
        FacePair* pairs = pairs_.data() + begin;
        count = kernels().staying(*a_.shape, *b_.shape, moment(now, lo, hi), pairs, count);
        if (count <= few_pairs || splits == max_splits) {
            for (int i = 0; i < count && !done(); ++i) advance(pairs[i], lo, lesser(hi, contact_.free_until));
            return;
        }
        const double middle = now.t;
        for (int half = 0; half < 2; ++half) {
            const double from = half ? middle : lo, to = half ? hi : middle;
            if (static_cast<int>(pairs_.size()) < begin + 2 * count) pairs_.resize(begin + 2 * count);
            std::copy_n(pairs_.begin() + begin, count, pairs_.begin() + begin + count);
            settle(begin + count, count, instant(a_, b_, 0.5 * (from + to)), from, to, splits + 1);
        }
    }

    Moment moment(const Instant& now, double lo, double hi) const {
        const Acceleration at_a = a_.motion->acceleration(), at_b = b_.motion->acceleration();
        Moment m{now.a, now.b, now.va.v, now.va.w, now.vb.v, now.vb.w, {at_a.at_origin, askew * at_a.by_radius},
                 {at_b.at_origin, askew * at_b.by_radius}, (now.t - lo) * (1 + 1e-12), (hi - now.t) * (1 + 1e-12),
                 settings_.margin, rounding_slack(now, a_.shape->radius + b_.shape->radius)};
        for (int i = 0; i < 3; ++i) {
            m.a.t[i] -= m.b.t[i];
            m.b.t[i] = 0;
        }
        return m;
    }

    // Until when planes part the bodies, one after the other: cheap, and enough for most that come near each
    // other, even if they touch in the end. Where none parts them as wholes, each shell from each shell.
    double part(double lo, double hi) {
        const Shape &a = *a_.shape, &b = *b_.shape;
        if (a.corners.empty() || b.corners.empty()) return lo;
        const auto whole = [](const Shape& s) { return Piece{{0, 0, 0}, 0, 0, static_cast<int32_t>(s.corners.size())}; };
        lo = part(whole(a), whole(b), lo, hi);
        const size_t pairs = a.pieces.size() * b.pieces.size();
        if (lo >= lesser(hi, contact_.free_until) || pairs < 2 || pairs > most_pairs) return lo;
        const Rigid at_a = a_.motion->pose(lo), at_b = b_.motion->pose(lo);
        double parted = hi;
        for (const Piece& p : a.pieces)
            for (const Piece& q : b.pieces) {
                const double until = lesser(hi, contact_.free_until);
                const double gap = norm(apply(at_b, q.centre) - apply(at_a, p.centre)) - askew * (p.radius + q.radius) - settings_.margin;
                if (gap <= speed_ * (until - lo) + 1e-12 * (norm(origin(at_a)) + norm(origin(at_b)) + a.radius + b.radius))
                    parted = lesser(parted, part(p, q, lo, until));
            }
        return parted;
    }

    double part(const Piece& of_a, const Piece& of_b, double lo, double hi) {
        PlaneAdvance bodies(a_, b_, of_a, of_b, settings_);
        for (int i = 0; i < max_planes; ++i) {
            const double after = bodies.stay(lo, hi - lo);
            if (lo + after >= hi) return hi;
            lo += after;
            if (after > 0.25 * bracket(speed_) || bodies.apart() > settings_.tolerance) continue;
            const double shown = lesser(lo + 0.5 * bracket(speed_), 1);
            if (collides(shown)) find(lo, shown);
            else if (after > 0) continue;
            break;
        }
        return lo;
    }

    // What part of the time a point takes for the tolerance.
    double bracket(double speed) const { return settings_.tolerance / greater(speed, 1e-300); }

    void advance(FacePair pair, double lo, double hi) {
        FaceAdvance faces(a_, b_, pair, settings_);
        double t = lo, within = 0;
        for (int step = 0; step < max_steps; ++step) {
            const double after = faces.stay(t);
            if (t + after >= hi) return;
            t += after;
            within = bracket(greater(faces.speed(), settings_.speed));
            if (after > 0.25 * within) continue;
            const double shown = lesser(t + 0.5 * within, 1);
            if (faces.meet(shown)) return find(t, shown);
            // Another pair that shares the corner may have shown it already.
            if (contact_.found && contact_.shown <= t + within) return find(t, contact_.shown);
            if (after == 0) break;
        }
        // These two only touch, as some do around a corner that runs into an edge: others may show it.
        for (double part : {0.5, 1.0}) {
            const double shown = lesser(t + part * within, 1);
            if (collides(shown)) return find(t, shown);
        }
        give_up(t);
    }

    void find(double free_until, double shown) { contact_ = {free_until, shown, true}; }
    void give_up(double free_until) { find(free_until, std::numeric_limits<double>::quiet_NaN()); }

    // A contact with no contact shortly before it, between a free t and a colliding one: so near to where
    // it begins that few faces are left to be looked at up to there.
    double first_shown(double free, double shown) const {
        for (int i = 0; i < 10; ++i) {
            const double middle = 0.5 * (free + shown);
            (collides(middle) ? shown : free) = middle;
        }
        return shown;
    }

    bool collides(double t) const {
        return hits(*a_.shape, *b_.shape, relative(a_.motion->pose(t), b_.motion->pose(t)), settings_.margin, true);
    }

    const Moving &a_, &b_;
    const CertifySettings& settings_;
    Contact& contact_;
    int64_t& sweeps_;
    double speed_;  // of any point of one against any of the other, at most, and what `settings_` says
    std::vector<FacePair> pairs_;
};

}  // namespace

void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  Contact& contact, int64_t& sweeps) {
    Certifier(a, b, settings, contact, sweeps).begin(lo, hi);
}

}  // namespace fgenv
