#include "motion/certify.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "motion/face_advance.h"
#include "motion/plane_advance.h"

namespace fgenv {
namespace {

constexpr int max_steps = 3000;     // advancement steps per pair of faces
constexpr int some_pairs = 256;     // above this number of pairs of faces
constexpr int some_boxes = 128;     // or opened pairs of boxes, the time is halved
constexpr int max_halvings = 5;     // maximum number of halvings
constexpr int all_pairs = 1 << 16;  // capacity after the last halving
constexpr int few_pairs = 4;        // up to this number, pairs are advanced one by one
constexpr int max_splits = 10;      // after this number of splits too
constexpr int box_planes = 4;       // planes tried between the bodies' boxes
constexpr int max_planes = 256;     // successive planes between two bodies
constexpr size_t most_pairs = 256;  // pairs of shells

Sweep sweep_of(const Moving& a, const Moving& b, const Instant& now, double half, double margin) {
    const auto side = [&](const Velocity& u, const Acceleration& acc) {
        const double squared = 0.5 * half * half * orthonormality;
        return Sweep::Side{(half * orthonormality) * unrotate(now.a, u.v),
                           (half * orthonormality) * unrotate(now.a, u.w), squared * acc.at_origin,
                           squared * acc.by_radius};
    };
    return {relative(now.a, now.b), side(now.va, a.motion->acceleration()), side(now.vb, b.motion->acceleration()),
            margin, 0};
}

Hull hull_of(const Shape& s, size_t begin, size_t end) {
    return {s.mesh.vertices.data(), s.corners.data() + begin, static_cast<int32_t>(end - begin), s.radius};
}
Hull hull_of_box(const Shape& s) {
    double radius = 0;
    for (const Vec3& p : s.box) radius = greater(radius, norm(p));
    return {s.box.data(), nullptr, 8, radius};
}

class Certifier {
public:
    Certifier(const Moving& a, const Moving& b, const CertifySettings& s, MotionContact& contact)
        : a_(a),
          b_(b),
          settings_(s),
          contact_(contact),
          speed_(greater(s.speed, a.motion->speed(a.shape->radius) + b.motion->speed(b.shape->radius))) {}

    // Motions that push on from near contact, as of robots stopped at a contact, are resolved at once.
    void begin(double lo, double hi) {
        const double soon = lo + 0.5 * bracket(speed_);
        if (soon < lesser(hi, contact_.free_until) && collides(soon))
            find(lo, soon);
        else
            run(lo, hi, 0);
    }

    // Stretches in chronological order: each begins where everything before is proved free.
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

    // Stores in pairs_ the pairs of faces that may touch from lo to hi; returns capacity + 1 if there are more.
    int look(const Instant& now, double lo, double hi, int capacity, int budget_of_boxes) {
        if (static_cast<int>(pairs_.size()) < capacity) pairs_.resize(capacity);
        Sweep sweep = sweep_of(a_, b_, now, 0.5 * (hi - lo), settings_.margin);
        sweep.budget = budget_of_boxes;
        return kernels().sweep(*a_.shape, *b_.shape, sweep, pairs_.data(), capacity);
    }

    // Tests pairs_[begin, begin + count) from lo to hi. Pairs without a proof of separation are tested again in each
    // half, the last few one by one. Later entries of pairs_ are scratch space.
    void settle(int begin, int count, const Instant& now, double lo, double hi, int splits) {
        hi = lesser(hi, contact_.free_until);
        if (count == 0 || lo >= hi || done()) return;
        FacePair* pairs = pairs_.data() + begin;
        count = kernels().drop_separated(*a_.shape, *b_.shape, separation_window(now, lo, hi), pairs, count);
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

    SeparationWindow separation_window(const Instant& now, double lo, double hi) const {
        const Acceleration at_a = a_.motion->acceleration(), at_b = b_.motion->acceleration();
        SeparationWindow m{now.a,
                           now.b,
                           now.va.v,
                           now.va.w,
                           now.vb.v,
                           now.vb.w,
                           {at_a.at_origin, orthonormality * at_a.by_radius},
                           {at_b.at_origin, orthonormality * at_b.by_radius},
                           (now.t - lo) * (1 + 1e-12),
                           (hi - now.t) * (1 + 1e-12),
                           settings_.margin,
                           rounding_slack(now, a_.shape->radius + b_.shape->radius)};
        for (int i = 0; i < 3; ++i) {
            m.a.t[i] -= m.b.t[i];
            m.b.t[i] = 0;
        }
        return m;
    }

    // Time until which successive planes separate the bodies: cheap, and sufficient for most close pairs, even if
    // they touch in the end. If no plane separates the whole bodies, tests each pair of shells.
    double part(double lo, double hi) {
        const Shape &a = *a_.shape, &b = *b_.shape;
        lo = part(hull_of_box(a), hull_of_box(b), lo, hi, box_planes);
        if (lo >= lesser(hi, contact_.free_until) || done() || a.corners.empty() || b.corners.empty()) return lo;
        lo = part(hull_of(a, 0, a.corners.size()), hull_of(b, 0, b.corners.size()), lo, hi, max_planes);
        const size_t pairs = a.pieces.size() * b.pieces.size();
        if (lo >= lesser(hi, contact_.free_until) || pairs < 2 || pairs > most_pairs) return lo;
        const Rigid at_a = a_.motion->pose(lo), at_b = b_.motion->pose(lo);
        double parted = hi;
        for (const Piece& p : a.pieces)
            for (const Piece& q : b.pieces) {
                const double until = lesser(hi, contact_.free_until);
                const double gap = norm(apply(at_b, q.center) - apply(at_a, p.center)) -
                                   orthonormality * (p.radius + q.radius) - settings_.margin;
                if (gap <=
                    speed_ * (until - lo) + 1e-12 * (norm(origin(at_a)) + norm(origin(at_b)) + a.radius + b.radius))
                    parted = lesser(
                        parted, part(hull_of(a, p.begin, p.end), hull_of(b, q.begin, q.end), lo, until, max_planes));
            }
        return parted;
    }

    double part(const Hull& of_a, const Hull& of_b, double lo, double hi, int planes) {
        PlaneAdvance bodies(a_, b_, of_a, of_b, settings_);
        for (int i = 0; i < planes; ++i) {
            const double after = bodies.stay(lo, hi - lo);
            if (lo + after >= hi) return hi;
            lo += after;
            if (after > 0.25 * bracket(speed_) || bodies.apart() > settings_.tolerance) continue;
            const double shown = lesser(lo + 0.5 * bracket(speed_), 1);
            if (collides(shown))
                find(lo, shown);
            else if (after > 0)
                continue;
            break;
        }
        return lo;
    }

    // Time in which a point at this speed moves by the tolerance.
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
            // Another pair with the same corner may already have a contact.
            if (contact_.found && contact_.shown <= t + within) return find(t, contact_.shown);
            if (after == 0) break;
        }
        // These faces only touch, as neighbors of a corner that hits an edge do; another pair may show the contact.
        for (double part : {0.5, 1.0}) {
            const double shown = lesser(t + part * within, 1);
            if (collides(shown)) return find(t, shown);
        }
        give_up(t);
    }

    void find(double free_until, double shown) { contact_ = {free_until, shown, true}; }
    void give_up(double free_until) { find(free_until, std::numeric_limits<double>::quiet_NaN()); }

    // Bisects between a free and a colliding t for a contact near its beginning, so that few faces remain to be
    // tested before it.
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
    MotionContact& contact_;
    double speed_;  // bound on the relative speed of any two points, at least the settings' speed
    std::vector<FacePair> pairs_;
};

}  // namespace

void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  MotionContact& contact) {
    Certifier(a, b, settings, contact).begin(lo, hi);
}

}  // namespace fgenv
