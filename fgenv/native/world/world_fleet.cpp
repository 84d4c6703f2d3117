// Movers all at once, each against the others' motions too: as if all went on, or each stopping where it
// first meets something.
#include <algorithm>
#include <numeric>
#include <queue>

#include "world/swept_mover.h"

namespace fgenv {

struct World::Fleet {
    std::vector<Sweeping> moving;            // of those with somebody near alone
    std::vector<std::vector<int32_t>> near;  // of each: whose motions come near its own, rising
    std::vector<MotionOutcome> alone;        // of each: its first contact with itself or with what is not among them
};

namespace {

// Pairs (i < j) of boxes that meet, by sweeping along x.
template <class Visit>
void for_meeting(const std::vector<Box>& boxes, const Visit& visit) {
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

// All along its way a mover whose parts are fixed in the frame of its base is within a sphere around that
// frame's origin, which goes straight. Cheap; of others the boxes of all parts.
Box World::rough_box(const Body& robot, const Place& from, const Place& to, double margin) const {
    const Robot* tree = robot.robot.get();
    if (tree && tree->n_links() > 1) return sweeping(robot, from, to, margin).around;
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
    return widened(box, radius * (1 + 1e-4) + margin + 1e-12 * size);  // poses may be askew by 1e-5
}

World::Fleet World::fleet(const std::vector<BodyId>& robots, const std::vector<Place>& from,
                          const std::vector<Place>& to, const MotionSettings& given) const {
    const size_t n = robots.size();
    Fleet out{{}, std::vector<std::vector<int32_t>>(n), std::vector<MotionOutcome>(n)};
    std::vector<Box> boxes;
    for (size_t i = 0; i < n; ++i) boxes.push_back(rough_box(body(robots[i]), from[i], to[i], given.certify.margin));
    for_meeting(boxes, [&](int32_t i, int32_t j) {
        out.near[i].push_back(j);
        out.near[j].push_back(i);
    });
    std::vector<BodyId> sorted = robots, others;
    std::sort(sorted.begin(), sorted.end());
    for (size_t i = 0; i < n; ++i) {
        const Body& robot = body(robots[i]);
        std::sort(out.near[i].begin(), out.near[i].end());
        candidates(robot, boxes[i], others);
        others.erase(
            std::remove_if(others.begin(), others.end(),
                           [&](BodyId o) { return std::binary_search(sorted.begin(), sorted.end(), body(o).root); }),
            others.end());
        out.alone[i].masked = static_cast<int32_t>(others.size() + out.near[i].size());
        if (others.empty() && out.near[i].empty() && robot.own_pairs.empty()) {
            out.moving.emplace_back();
            continue;
        }
        out.moving.push_back(sweeping(robot, from[i], to[i], given.certify.margin));
        const Sweeping& moving = out.moving.back();
        const MotionSettings s = given.with_speed(moving.speed);
        if (touches_at(moving, 0, others, s, out.alone[i])) out.alone[i].contact = {0, 0, true};
        certify_all(moving, others, s, out.alone[i]);
    }
    return out;
}

// Two movers from a fraction on, until which they are known to be apart (or 0), and no farther than
// `until`; either may rest from there on.
World::Meeting World::meeting(const Sweeping& a, bool a_rests, const Sweeping& b, bool b_rests, double begin,
                              double until, const MotionSettings& given) const {
    const double rest = 1 - begin;
    Meeting out;
    Contact& first = out.contact;
    if (rest <= 0 || (a_rests && b_rests)) return out;
    const MotionSettings s = given.with_speed(rest * greater(a.speed, b.speed));
    first.free_until = lesser((until - begin) / rest, 1);
    const auto piece = [&](const Part& p, bool rests) {
        if (rests) return PartMotion(RigidMotion(p.motion->pose(begin), p.motion->pose(begin)));
        return begin > 0 ? p.motion.retimed(begin, rest) : p.motion;
    };
    int64_t sweeps = 0;
    for (const Part& p : a.parts)
        for (const Part& q : b.parts) {
            if (ignores(*p.body, *q.body) || !overlap(p.swept, q.swept)) continue;
            ++out.checks;
            const PartMotion u = piece(p, a_rests), v = piece(q, b_rests);
            const Contact before = first;
            if (begin == 0 &&
                hits(*p.body->shape, *q.body->shape, relative(u->pose(0), v->pose(0)), s.certify.margin, true))
                first = {0, 0, true};
            else
                find_contact({p.body->shape.get(), &*u}, {q.body->shape.get(), &*v}, 0, 1, s.certify, first, sweeps);
            if (!first.replaces(before)) continue;
            out.of_a = p.body->id;
            out.of_b = q.body->id;
        }
    first.free_until = begin + first.free_until * rest;
    first.shown = begin + first.shown * rest;
    return out;
}

std::vector<MotionOutcome> World::check_motions(const std::vector<BodyId>& robots, const std::vector<Place>& from,
                                                const std::vector<Place>& to, const MotionSettings& s) const {
    return contacts(fleet(robots, from, to, s), s);
}

// Of each its first contact, as if nobody stopped.
std::vector<MotionOutcome> World::contacts(const Fleet& all, const MotionSettings& s) const {
    std::vector<MotionOutcome> out = all.alone;
    const auto lower = [](MotionOutcome& known, const Contact& found, BodyId part, BodyId other) {
        if (known.contact.found && found.free_until >= known.contact.free_until) return;
        known.contact = found;
        known.part = part;
        known.other = other;
    };
    for (int32_t i = 0; i < static_cast<int32_t>(out.size()); ++i)
        for (int32_t j : all.near[i]) {
            if (j <= i) continue;
            const double until = greater(out[i].contact.free_until, out[j].contact.free_until);
            const Meeting m = meeting(all.moving[i], false, all.moving[j], false, 0, until, s);
            out[i].checks += m.checks;
            out[j].checks += m.checks;
            if (!m.contact.found) continue;
            lower(out[i], m.contact, m.of_a, m.of_b);
            lower(out[j], m.contact, m.of_b, m.of_a);
        }
    count_tests(out);
    return out;
}

std::vector<MotionOutcome> World::advance(const std::vector<BodyId>& robots, const std::vector<Place>& to,
                                          const MotionSettings& s, bool through) {
    std::vector<Place> places;
    for (BodyId id : robots) places.push_back(body(id).place());
    const Fleet all = fleet(robots, places, to, s);
    const std::vector<MotionOutcome> out = through ? contacts(all, s) : stops(all, s);
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

// Who meets whom, in the order of time. Who stops voids what was proved of it and its neighbors for later,
// so those pairs are looked at anew, one of them at rest.
std::vector<MotionOutcome> World::stops(const Fleet& all, const MotionSettings& s) const {
    struct Event {
        Meeting meeting;
        int32_t i, j;  // j is -1: i meets what is not among the movers
        bool i_rested, j_rested;

        bool operator<(const Event& o) const {  // of a queue whose greatest comes first
            const double t = meeting.contact.free_until, u = o.meeting.contact.free_until;
            return t != u ? t > u : i != o.i ? i > o.i : j > o.j;
        }
    };
    const int32_t n = static_cast<int32_t>(all.moving.size());
    std::vector<MotionOutcome> out(n);
    std::vector<char> rests(n, false);
    std::priority_queue<Event> events;
    // A little before the contact, so that what comes later does not begin within rounding of it.
    const auto add = [&](Meeting m, int32_t i, int32_t j, double begin) {
        const double speed = greater(all.moving[i].speed, j < 0 ? 0 : all.moving[j].speed);
        m.contact.free_until =
            greater(m.contact.free_until - 0.25 * s.certify.tolerance / greater(speed, 1e-300), begin);
        events.push({m, i, j, bool(rests[i]), j >= 0 && rests[j]});
    };
    const auto plan = [&](int32_t i, int32_t j, double begin) {
        const auto stops = [&](int32_t k) { return rests[k] ? begin : all.alone[k].contact.free_until; };
        const Meeting m =
            meeting(all.moving[i], rests[i], all.moving[j], rests[j], begin, greater(stops(i), stops(j)), s);
        out[i].checks += m.checks;
        out[j].checks += m.checks;
        if (m.contact.found) add(m, i, j, begin);
    };
    for (int32_t i = 0; i < n; ++i) {
        const MotionOutcome& alone = all.alone[i];
        out[i].checks = alone.checks;
        out[i].masked = alone.masked;
        if (alone.contact.found) add({alone.contact, alone.part, alone.other, 0}, i, -1, 0);
        for (int32_t j : all.near[i])
            if (j > i) plan(i, j, 0);
    }
    std::vector<int32_t> stopping;
    while (!events.empty()) {
        const Event e = events.top();
        events.pop();
        if (e.i_rested != bool(rests[e.i]) || (e.j >= 0 && e.j_rested != bool(rests[e.j]))) continue;  // planned anew
        const Contact& contact = e.meeting.contact;
        stopping.clear();
        const auto stop = [&](int32_t k, BodyId part, BodyId other) {
            if (k < 0 || rests[k]) return;
            rests[k] = true;
            out[k].contact = contact;
            out[k].part = part;
            out[k].other = other;
            stopping.push_back(k);
        };
        stop(e.i, e.meeting.of_a, e.meeting.of_b);
        stop(e.j, e.meeting.of_b, e.meeting.of_a);
        for (int32_t k : stopping)
            for (int32_t other : all.near[k])
                if (!rests[other]) plan(std::min(k, other), std::max(k, other), contact.free_until);
    }
    count_tests(out);
    return out;
}

void World::count_tests(const std::vector<MotionOutcome>& outcomes) const {
    int64_t checks = 0;
    for (const MotionOutcome& o : outcomes) checks += o.checks;
    tests_.fetch_add(checks, std::memory_order_relaxed);
}

}  // namespace fgenv
