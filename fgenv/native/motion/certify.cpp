#include "motion/certify.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "motion/face_advance.h"
#include "motion/flush_plane.h"
#include "motion/plane_advance.h"

namespace fgenv {
namespace {

constexpr int64_t min_limit = 1 << 13;  // steps of all kinds for two bodies after which the search gives up: this
constexpr int64_t max_limit = 1 << 20;  // number and a 16th of their faces squared, at most this
constexpr int max_slides = 16;          // successive planes at rest
constexpr int slide_parts = 64;         // a plane at rest that holds for a smaller part of the time is the last
constexpr int slide_samples = 8;        // tests during a stretch in which the bodies graze
constexpr int slide_after = 8;          // steps before a plane at rest is tried, for all that is left
constexpr int slide_partly = 256;       // or for a part of it
constexpr int max_samples = 64;         // tests for an overlap after the search has given up
constexpr int max_faces = 64;           // normals of faces of one body that are candidates for a plane at rest
constexpr int some_pairs = 256;         // above this number of pairs of faces
constexpr int some_boxes = 128;         // or opened pairs of boxes, the time is halved
constexpr int max_halvings = 5;         // maximum number of halvings
constexpr int all_pairs = 1 << 16;      // capacity after the last halving
constexpr int few_pairs = 4;            // up to this number, pairs are advanced one by one
constexpr int max_splits = 10;          // after this number of splits too
constexpr int box_planes = 4;           // planes tried between the bodies' boxes
constexpr int max_planes = 256;         // successive planes between two bodies
constexpr size_t most_pairs = 256;      // pairs of shells

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
          speed_(greater(s.speed, a.motion->speed(a.shape->radius) + b.motion->speed(b.shape->radius))),
          before_(contact.work),
          limit_(limit_of(a, b)) {}

    // Motions that push on from near contact, as of robots stopped at a contact, are resolved at once.
    void begin(double lo, double hi) {
        const double soon = lo + 0.5 * bracket(speed_);
        if (soon < lesser(hi, contact_.free_until) && collides(soon)) return find(lo, soon);
        run(lo, hi, 0);
        if (!paused()) return;
        flush_ = true;
        run(lo, hi, 0);
    }

    // Stretches in chronological order: each begins where everything before is proved free.
    void run(double lo, double hi, int halvings) {
        hi = lesser(hi, contact_.free_until);
        if (lo >= hi || done() || paused()) return;
        if (exhausted()) return give_up(lo);
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
    static int64_t limit_of(const Moving& a, const Moving& b) {
        const auto faces = static_cast<int64_t>(a.shape->mesh.faces.size() + b.shape->mesh.faces.size());
        return std::min(min_limit + faces * faces / 16, max_limit);
    }
    bool done() const { return contact_.found && !settings_.first; }
    int64_t work() const { return contact_.work - before_; }
    void spend(int64_t steps) { contact_.work += steps; }
    bool paused() const { return !flush_ && work() >= limit_ / 2; }
    bool exhausted() const { return work() >= limit_; }

    // Stores in pairs_ the pairs of faces that may touch from lo to hi; returns capacity + 1 if there are more.
    int look(const Instant& now, double lo, double hi, int capacity, int budget_of_boxes) {
        if (static_cast<int>(pairs_.size()) < capacity) pairs_.resize(capacity);
        Sweep sweep = sweep_of(a_, b_, now, 0.5 * (hi - lo), settings_.margin);
        sweep.budget = budget_of_boxes;
        const int count = kernels().sweep(*a_.shape, *b_.shape, sweep, pairs_.data(), capacity);
        spend(1 + count / 8);
        return count;
    }

    // Tests pairs_[begin, begin + count) from lo to hi. Pairs without a proof of separation are tested again in each
    // half, the last few one by one. Later entries of pairs_ are scratch space.
    void settle(int begin, int count, const Instant& now, double lo, double hi, int splits) {
        hi = lesser(hi, contact_.free_until);
        if (count == 0 || lo >= hi || done() || paused()) return;
        if (exhausted()) return give_up(lo);
        spend(1 + count / 4);
        FacePair* pairs = pairs_.data() + begin;
        count = kernels().drop_separated(*a_.shape, *b_.shape, separation_window(now, lo, hi), pairs, count);
        if (flush_ && splits == 0) count = drop_flush(pairs, count, lo, hi);
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

    // Moves the pairs that no plane at rest separates from lo to hi to the front; returns their number.
    int drop_flush(FacePair* pairs, int count, double lo, double hi) {
        int left = 0;
        for (int i = 0; i < count && !done(); ++i) {
            FaceAdvance faces(a_, b_, pairs[i], settings_);
            if (slide(faces, pairs[i], lo, hi, true) < lesser(hi, contact_.free_until)) pairs[left++] = pairs[i];
        }
        return left;
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
            spend(1 + (of_a.count + of_b.count) / 64);
            if (lo + after >= hi) return hi;
            lo += after;
            if (i == slide_after && slide(of_a, of_b, bodies.normal(), lo, hi) >= hi) return hi;
            if (after > 0.25 * bracket(speed_) || bodies.apart() > settings_.tolerance) continue;
            const double shown = lesser(lo + 0.5 * bracket(speed_), 1);
            if (collides(shown))
                find(lo, shown);
            else if (after > 0)
                continue;
            break;
        }
        if (planes <= slide_after || lo >= lesser(hi, contact_.free_until)) return lo;
        const double until = slide(of_a, of_b, bodies.normal(), lo, hi);
        return flush_ || until >= hi ? until : lo;
    }

    double slide(const Hull& of_a, const Hull& of_b, Vec3 normal, double lo, double hi) {
        return slide(
            of_a, of_b, lo, hi,
            [&](FlushPlane& plane) {
                plane.add(normal);
                add_normals(*a_.shape, plane.now().a, normal, plane);
                add_normals(*b_.shape, plane.now().b, normal, plane);
            },
            [&](double t) { return collides(t); }, flush_);
    }

    // Adds the normals of a body's faces, of many those along `normal`.
    static void add_normals(const Shape& shape, const Rigid& at, Vec3 normal, FlushPlane& plane) {
        const Mesh& mesh = shape.mesh;
        const bool all = mesh.faces.size() <= max_faces;
        Vec3 last{0, 0, 0};
        int count = 0;
        for (int32_t f = 0; f < static_cast<int32_t>(mesh.faces.size()) && count < max_faces; ++f) {
            const Vec3 n = rotate(at, unit(area_vector(mesh, f)));
            if (n == last || (!all && std::fabs(dot(n, normal)) < 1 - 1e-6)) continue;
            plane.add(last = n);
            ++count;
        }
    }

    // Time until which planes at rest separate two hulls. `add` adds candidate normals; `meets` is the test at one t.
    // With `decides` a contact that it shows is stored.
    template <class AddNormals, class Meets>
    double slide(const Hull& of_a, const Hull& of_b, double lo, double hi, AddNormals add, Meets meets, bool decides) {
        FlushPlane plane(a_, b_, of_a, of_b, settings_.margin);
        for (int i = 0; i < max_slides && lo < hi && !exhausted(); ++i) {
            plane.begin(lo);
            add(plane);
            spend(1 + plane.count() * (of_a.count + of_b.count) / 32);
            const double longest = hi - lo, apart = plane.stay(longest);
            const double after = apart > 0.01 * longest ? apart : greater(apart, plane.graze(longest));
            if (after == 0) return lo;
            for (int k = 1; after > apart && k <= slide_samples; ++k) {
                spend(1);
                const double t = lesser(lo + k * (after / slide_samples), hi);
                if (!meets(t)) continue;
                if (decides) find(lo, first_shown(lo, t, meets));
                return lo;
            }
            lo = lo + after;
            if (after < longest / slide_parts) break;
        }
        return lesser(lo, hi);
    }

    // Time in which a point at this speed moves by the tolerance.
    double bracket(double speed) const { return settings_.tolerance / greater(speed, 1e-300); }

    void advance(FacePair pair, double lo, double hi) {
        FaceAdvance faces(a_, b_, pair, settings_);
        double t = lo, within = 0;
        for (int rescues = 0; rescues < max_slides; ++rescues) {
            bool blocked = false;
            for (int step = 0; !blocked && step < slide_partly; ++step) {
                if (paused()) return;
                if (exhausted()) return give_up(t, within);
                spend(1);
                const double after = faces.stay(t);
                if (t + after >= hi) return;
                t += after;
                within = bracket(greater(faces.speed(), settings_.speed));
                if (step == slide_after && slide(faces, pair, t, hi, false) >= hi) return;
                blocked = after == 0;
                if (after > 0.25 * within) continue;
                const double shown = lesser(t + 0.5 * within, 1);
                if (faces.meet(shown)) return find(t, shown);
                // Another pair with the same corner may already have a contact.
                if (contact_.found && contact_.shown <= t + within) return find(t, contact_.shown);
            }
            // These faces only touch, as neighbors of a corner that hits an edge do; another pair may show the contact.
            for (double part : {0.5, 1.0}) {
                const double shown = lesser(t + part * within, 1);
                if (collides(shown)) return find(t, shown);
            }
            const double until = slide(faces, pair, t, hi, true);
            if (until >= lesser(hi, contact_.free_until)) return;
            if (until <= t && blocked) break;
            t = until;
        }
        give_up(t, within);
    }

    double slide(FaceAdvance& faces, FacePair pair, double lo, double hi, bool decides) {
        const auto hull = [](const Shape& s, int32_t face) {
            return Hull{s.mesh.vertices.data(), s.mesh.faces[face].data(), 3, s.radius};
        };
        return slide(
            hull(*a_.shape, pair.a), hull(*b_.shape, pair.b), lo, hi,
            [&](FlushPlane& plane) { faces.for_each_normal(plane.now().t, [&](Vec3 n) { plane.add(n); }); },
            [&](double t) { return faces.meet(t); }, decides);
    }

    void find(double free_until, double shown) {
        contact_.free_until = free_until;
        contact_.shown = shown;
        contact_.found = true;
    }
    void give_up(double free_until) { give_up(free_until, bracket(speed_)); }

    // Contact cannot be decided after `free_until`; an overlap that follows is reported.
    void give_up(double free_until, double step) {
        if (contact_.found && !std::isnan(contact_.shown)) return find(free_until, contact_.shown);
        double t = free_until;
        for (int i = 0; i < max_samples && t < 1; ++i) {
            t = lesser(t + step, 1);
            step = lesser(greater(2 * step, 1e-12), 1.0 / 32);
            if (collides(t)) return find(free_until, t);
        }
        find(free_until, std::numeric_limits<double>::quiet_NaN());
    }

    // Bisects between a free and a colliding t for a contact near its beginning, so that few faces remain to be
    // tested before it.
    double first_shown(double free, double shown) const {
        for (int i = 0; i < 10; ++i) {
            const double middle = 0.5 * (free + shown);
            (collides(middle) ? shown : free) = middle;
        }
        return shown;
    }
    // Likewise between `free_until`, which is kept, and a contact, down to the tolerance.
    template <class Meets>
    double first_shown(double free_until, double shown, Meets meets) const {
        double free = free_until;
        for (int i = 0; i < 40 && shown - free_until > 0.5 * bracket(speed_); ++i) {
            const double middle = 0.5 * (free + shown);
            (meets(middle) ? shown : free) = middle;
        }
        return shown;
    }

    bool collides(double t) const {
        return hits(*a_.shape, *b_.shape, relative(a_.motion->pose(t), b_.motion->pose(t)), settings_.margin, true);
    }

    const Moving &a_, &b_;
    const CertifySettings& settings_;
    MotionContact& contact_;
    const double speed_;            // bound on the relative speed of any two points, at least the settings' speed
    const int64_t before_, limit_;  // work of earlier searches, and of this one at most
    bool flush_ = false;            // pairs of faces are tried with planes at rest first
    std::vector<FacePair> pairs_;
};

}  // namespace

void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  MotionContact& contact) {
    Certifier(a, b, settings, contact).begin(lo, hi);
}

}  // namespace fgenv
