// Simultaneous motions of several movers, also checked against each other: to the end, or up to first contacts.
#include <algorithm>
#include <numeric>
#include <queue>

#include "world/pair_loop.h"

namespace fgenv {

namespace {

// Pairs (i < j) of overlapping boxes, by sweeping along x.
template <class Visit>
void for_overlapping(const std::vector<Box>& boxes, const Visit& visit) {
    std::vector<int32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int32_t i, int32_t j) {
        const double x = boxes[i].lo.x, y = boxes[j].lo.x;
        return x != y ? x < y : i < j;
    });
    for (size_t k = 0; k < order.size(); ++k)
        for (size_t m = k + 1; m < order.size() && boxes[order[m]].lo.x <= boxes[order[k]].hi.x; ++m)
            if (overlap(boxes[order[k]], boxes[order[m]]))
                visit(std::min(order[k], order[m]), std::max(order[k], order[m]));
}

}  // namespace

// A cheap bound for a mover with parts that are fixed in its base frame: a sphere around the frame's origin, which moves
// along a straight line. Other movers use the boxes of all parts.
Box World::rough_box(const Body& robot, const Place& from, const Place& to, double margin) const {
    const Robot* tree = robot.robot.get();
    if (tree && tree->n_links() > 1) return swept(robot, from, to, margin).around;
    double radius = 0;
    for (BodyId id : robot.parts) {
        const Body& part = body(id);
        radius = greater(radius, part.shape->radius + (part.held_at() ? norm(origin(part.offset)) : 0));
    }
    Box box = empty_box();
    for (const Place* place : {&from, &to}) {
        if (!tree) {
            grow(box, origin(place->pose));
            continue;
        }
        const Joint& base = tree->joints[0];
        const double* q = place->q.data();
        grow(box, base.kind == JointKind::planar ? apply(base.origin, {q[0], q[1], 0})
                  : base.kind == JointKind::free ? apply(base.origin, {q[0], q[1], q[2]})
                                                 : origin(base.origin));
    }
    const double size = greater(norm(box.lo), norm(box.hi)) + radius;
    return widened(box, radius * (1 + 1e-4) + margin + 1e-12 * size);  // poses may deviate from orthonormal by 1e-5
}

World::Fleet World::fleet(const std::vector<BodyId>& robots, const std::vector<Place>& from,
                          const std::vector<Place>& to, const MotionSettings& given) const {
    const size_t n = robots.size();
    Fleet out{{}, std::vector<std::vector<int32_t>>(n), std::vector<MotionOutcome>(n)};
    std::vector<Box> boxes;
    for (size_t i = 0; i < n; ++i) boxes.push_back(rough_box(body(robots[i]), from[i], to[i], given.certify.margin));
    for_overlapping(boxes, [&](int32_t i, int32_t j) {
        out.neighbors[i].push_back(j);
        out.neighbors[j].push_back(i);
    });
    std::vector<BodyId> sorted = robots, others;
    std::sort(sorted.begin(), sorted.end());
    for (size_t i = 0; i < n; ++i) {
        const Body& robot = body(robots[i]);
        std::sort(out.neighbors[i].begin(), out.neighbors[i].end());
        candidates(robot, boxes[i], others);
        others.erase(
            std::remove_if(others.begin(), others.end(),
                           [&](BodyId o) { return std::binary_search(sorted.begin(), sorted.end(), body(o).root); }),
            others.end());
        out.alone[i].masked = static_cast<int32_t>(others.size() + out.neighbors[i].size());
        if (others.empty() && out.neighbors[i].empty() && robot.own_pairs.empty()) {
            out.movers.emplace_back();
            continue;
        }
        out.movers.push_back(swept(robot, from[i], to[i], given.certify.margin));
        const SweptMover& mover = out.movers.back();
        const MotionSettings s = given.with_speed(mover.speed);
        if (collides_at(mover, 0, others, s, out.alone[i])) out.alone[i].contact = {0, 0, true};
        certify_all(mover, others, s, out.alone[i]);
    }
    return out;
}

// First contact of two movers within a stretch of their motion. They are separate at its begin unless that is 0.
// Either mover may rest from the begin on.
World::PairContact World::first_contact(const SweptMover& a, bool a_rests, const SweptMover& b, bool b_rests,
                                        Stretch stretch, const MotionSettings& given) const {
    const double begin = stretch.begin, rest = 1 - begin;
    PairContact out;
    MotionContact& first = out.contact;
    if (rest <= 0 || (a_rests && b_rests)) return out;
    const MotionSettings s = given.with_speed(rest * greater(a.speed, b.speed));
    first.free_until = lesser((stretch.end - begin) / rest, 1);
    const auto piece = [&](const SweptPart& p, bool rests) {
        if (rests) return PartMotion(RigidMotion(p.motion->pose(begin), p.motion->pose(begin)));
        return begin > 0 ? p.motion.retimed(begin, rest) : p.motion;
    };
    pairs_between(a, 0, b, 1, [&](const CandidatePair<SweptPart>& pair) {
        const Body &p = *pair.part->body, &q = *pair.other;
        ++out.checks;
        const PartMotion u = piece(*pair.part, a_rests), v = piece(*pair.other_part, b_rests);
        const MotionContact before = first;
        if (begin == 0 && hits(*p.shape, *q.shape, relative(u->pose(0), v->pose(0)), s.certify.margin, true))
            first = {0, 0, true};
        else
            find_contact({p.shape.get(), &*u}, {q.shape.get(), &*v}, 0, 1, s.certify, first);
        if (first.replaces(before)) out.pair = {p.id, q.id};
        return true;
    });
    first.free_until = begin + first.free_until * rest;
    first.shown = begin + first.shown * rest;
    return out;
}

std::vector<MotionOutcome> World::check_motions(const std::vector<BodyId>& robots, const std::vector<Place>& from,
                                                const std::vector<Place>& to, const MotionSettings& s) const {
    std::vector<MotionOutcome> out = first_contacts(fleet(robots, from, to, s), s);
    count_tests(out);
    return out;
}

// First contact of each mover, assuming that no mover stops.
std::vector<MotionOutcome> World::first_contacts(const Fleet& all, const MotionSettings& s) const {
    std::vector<MotionOutcome> out = all.alone;
    const auto lower = [](MotionOutcome& known, const MotionContact& found, BodyId part, BodyId other) {
        if (known.contact.found && found.free_until >= known.contact.free_until) return;
        known.contact = found;
        known.part = part;
        known.other = other;
    };
    for (int32_t i = 0; i < static_cast<int32_t>(out.size()); ++i)
        for (int32_t j : all.neighbors[i]) {
            if (j <= i) continue;
            const double until = greater(out[i].contact.free_until, out[j].contact.free_until);
            const PairContact m = first_contact(all.movers[i], false, all.movers[j], false, {0, until}, s);
            out[i].checks += m.checks;
            out[j].checks += m.checks;
            if (!m.contact.found) continue;
            lower(out[i], m.contact, m.pair.a, m.pair.b);
            lower(out[j], m.contact, m.pair.b, m.pair.a);
        }
    return out;
}

// Contacts of a fleet in chronological order. A mover that stops voids the later contacts found with its neighbors:
// these pairs are tested again, with the mover at rest.
class World::StopSchedule {
public:
    StopSchedule(const World& world, const Fleet& all, const MotionSettings& s)
        : world_(world), all_(all), settings_(s), out_(all.movers.size()), rests_(all.movers.size(), false) {}

    std::vector<MotionOutcome> run() {
        for (int32_t i = 0; i < static_cast<int32_t>(out_.size()); ++i) {
            const MotionOutcome& alone = all_.alone[i];
            out_[i].checks = alone.checks;
            out_[i].masked = alone.masked;
            if (alone.contact.found) add({alone.contact, {alone.part, alone.other}, 0}, i, -1, 0);
            for (int32_t j : all_.neighbors[i])
                if (j > i) test(i, j, 0);
        }
        while (!events_.empty()) {
            const Event event = events_.top();
            events_.pop();
            if (!is_void(event)) stop_both(event);
        }
        return std::move(out_);
    }

private:
    struct Event {
        PairContact found;
        int32_t i, j;  // j is -1: contact of i with a body that belongs to no mover
        bool i_rested, j_rested;

        bool operator<(const Event& o) const {  // std::priority_queue pops the greatest, here the earliest
            const double t = found.contact.free_until, u = o.found.contact.free_until;
            return t != u ? t > u : i != o.i ? i > o.i : j > o.j;
        }
    };

    bool is_void(const Event& e) const {
        return e.i_rested != bool(rests_[e.i]) || (e.j >= 0 && e.j_rested != bool(rests_[e.j]));
    }

    // Stops slightly before the contact, so that later motions do not start within rounding of it.
    void add(PairContact found, int32_t i, int32_t j, double begin) {
        const double speed = greater(all_.movers[i].speed, j < 0 ? 0 : all_.movers[j].speed);
        const double before = 0.25 * settings_.certify.tolerance / greater(speed, 1e-300);
        found.contact.free_until = greater(found.contact.free_until - before, begin);
        events_.push({found, i, j, bool(rests_[i]), j >= 0 && rests_[j]});
    }

    void test(int32_t i, int32_t j, double begin) {
        const auto stops = [&](int32_t k) { return rests_[k] ? begin : all_.alone[k].contact.free_until; };
        const PairContact found = world_.first_contact(all_.movers[i], rests_[i], all_.movers[j], rests_[j],
                                                       {begin, greater(stops(i), stops(j))}, settings_);
        out_[i].checks += found.checks;
        out_[j].checks += found.checks;
        if (found.contact.found) add(found, i, j, begin);
    }

    void stop_both(const Event& e) {
        const BodyPair pair = e.found.pair;
        const bool i_stops = stop(e.i, e.found.contact, pair.a, pair.b),
                   j_stops = stop(e.j, e.found.contact, pair.b, pair.a);
        const double begin = e.found.contact.free_until;
        if (i_stops) test_neighbors(e.i, begin);
        if (j_stops) test_neighbors(e.j, begin);
    }

    bool stop(int32_t k, const MotionContact& contact, BodyId part, BodyId other) {
        if (k < 0 || rests_[k]) return false;
        rests_[k] = true;
        out_[k].contact = contact;
        out_[k].part = part;
        out_[k].other = other;
        return true;
    }

    void test_neighbors(int32_t k, double begin) {
        for (int32_t other : all_.neighbors[k])
            if (!rests_[other]) test(std::min(k, other), std::max(k, other), begin);
    }

    const World& world_;
    const Fleet& all_;
    const MotionSettings& settings_;
    std::vector<MotionOutcome> out_;
    std::vector<char> rests_;
    std::priority_queue<Event> events_;
};

std::vector<MotionOutcome> World::advance(const std::vector<BodyId>& robots, const std::vector<Place>& to,
                                          const MotionSettings& s, bool through) {
    std::vector<Place> places;
    for (BodyId id : robots) places.push_back(body(id).place());
    const Fleet all = fleet(robots, places, to, s);
    const std::vector<MotionOutcome> out = through ? first_contacts(all, s) : StopSchedule(*this, all, s).run();
    count_tests(out);
    if (through) {
        put(robots, to);
        return out;
    }
    for (size_t i = 0; i < robots.size(); ++i) {
        const double t = out[i].contact.found ? out[i].contact.free_until : 1;
        if (t > 0) places[i] = between(body(robots[i]).robot.get(), places[i], to[i], t);
    }
    put(robots, places);
    return out;
}

void World::count_tests(const std::vector<MotionOutcome>& outcomes) const {
    int64_t checks = 0, steps = 0;
    for (const MotionOutcome& o : outcomes) {
        checks += o.checks;
        steps += o.contact.work;
    }
    tests_.fetch_add(checks, std::memory_order_relaxed);
    motion_steps_.fetch_add(steps, std::memory_order_relaxed);
}

}  // namespace fgenv
