// Motion checks of one mover: certified, or tested in steps.
#include <algorithm>
#include <cmath>

#include "world/pair_loop.h"

namespace fgenv {

PlacedMover World::placed(const Body& robot, const Place& place, double margin) const {
    PlacedMover out{&robot, {}};
    const Frames frames = frames_at(robot.robot.get(), place);
    out.parts.reserve(robot.parts.size());
    for (BodyId id : robot.parts) {
        const Body& part = body(id);
        const Rigid pose = part.in(frames);
        out.parts.push_back({&part, pose, widened(posed_box(*part.shape, pose), margin)});
        grow(out.around, out.parts.back().box);
    }
    return out;
}

SweptMover World::swept(const Body& robot, const Place& from, const Place& to, double margin) const {
    const Robot* tree = robot.robot.get();
    SweptMover out{&robot, {tree, from, to}, false, {}};
    if (tree) {
        const int32_t base = fgenv::size(tree->joints[0].kind);
        out.bends = !std::equal(from.q.begin() + base, from.q.end(), to.q.begin() + base);
    }
    out.parts.reserve(robot.parts.size());
    for (BodyId id : robot.parts) {
        const Body& part = body(id);
        out.parts.push_back({&part, out.motion.part(part.link, part.held_at()), {}});
        SweptPart& p = out.parts.back();
        p.box = widened(swept_box(*part.shape, *p.motion, 0, 1), margin);
        grow(out.around, p.box);
        out.speed = greater(out.speed, p.motion->speed(part.shape->radius));
    }
    return out;
}

int64_t steps_of(const MotionSettings& s, double length) {
    constexpr int64_t most = 10'000'000;
    const double expected = std::ceil(length / s.resolution);
    if (!(expected <= double(most)))
        throw std::invalid_argument("resolution: got " + std::to_string(s.resolution) + " m for a motion of " +
                                    std::to_string(length) + " m, expected at most " + std::to_string(most) +
                                    " steps; raise the resolution");
    return std::max<int64_t>(1, static_cast<int64_t>(expected));
}

// Collision at one fraction of the motion: with itself, and with bodies at rest or on their trajectories.
bool World::collides_at(const SweptMover& mover, double t, const std::vector<BodyId>& others, const MotionSettings& s,
                        MotionOutcome& out) const {
    if (others.empty() && mover.robot->own_pairs.empty()) return false;
    const double time = s.from + t * (s.to - s.from), margin = s.certify.margin;
    InstantMover there{mover, mover.robot, {}, mover.around};
    there.parts.reserve(mover.parts.size());
    for (const SweptPart& part : mover.parts) {
        const Rigid pose = part.motion->pose(t);
        there.parts.push_back({part.body, pose, widened(posed_box(*part.body->shape, pose), margin)});
    }
    BodyPair pair;
    if (free_of_contact(
            std::span<const InstantMover>(&there, 1), &others, PairOrder::by_part,
            [&](const Body& other) { return box_of(other, time); }, {time, margin, margin, true}, pair, out.checks))
        return false;
    out.part = pair.a;
    out.other = pair.b;
    return true;
}

// Tests steps between which no point moves more than `resolution`, as OMPL's discrete motion validator does;
// returns the first colliding step.
MotionOutcome World::step_through(const SweptMover& mover, const std::vector<BodyId>& others,
                                  const MotionSettings& s) const {
    MotionOutcome out;
    const int64_t steps = steps_of(s, mover.speed);
    for (int64_t i = 0; i <= steps; ++i) {
        const double t = double(i) / double(steps);
        if (!collides_at(mover, t, others, s, out)) continue;
        out.contact = {i ? double(i - 1) / double(steps) : 0, t, true};
        break;
    }
    return out;
}

// Checks one leg of a body's trajectory. Fractions refer to that leg, and the robot's motion is cut to it.
void World::certify_along_trajectory(const SweptPart& part, const Body& other, const MotionSettings& s,
                                     MotionContact& contact) const {
    const Body& root = body(other.root);
    std::vector<double> ends;  // seconds
    for (double time : root.trajectory->times)
        if (time > s.from && time < s.to) ends.push_back(time);
    ends.push_back(s.to);
    double lo = 0, from = s.from;
    for (double to : ends) {
        const double hi = to < s.to ? lesser((to - s.from) / (s.to - s.from), 1) : 1;
        if (lo > contact.free_until) break;
        const Trajectory::Leg leg = root.trajectory->leg(from);
        const MoverMotion theirs(root.robot.get(), leg.from, leg.to);
        const PartMotion whole = theirs.part(other.link, other.held_at()), piece = part.motion.retimed(lo, hi - lo),
                         cut = leg.length > 0 ? whole.retimed((from - leg.begin) / leg.length, (to - from) / leg.length)
                                              : whole;
        MotionContact found;
        if (contact.free_until < hi) found.free_until = (contact.free_until - lo) / (hi - lo);
        CertifySettings settings = s.certify;
        settings.speed *= hi - lo;
        find_contact({part.body->shape.get(), &*piece}, {other.shape.get(), &*cut}, 0, 1, settings, found);
        contact.work += found.work;
        const double free_until = lo + found.free_until * (hi - lo);
        if (found.found && (!contact.found || free_until < contact.free_until)) {
            contact = {free_until, lo + found.shown * (hi - lo), true, contact.work};
            break;
        }
        lo = hi;
        from = to;
    }
}

void World::certify(const CandidatePair<SweptPart>& p, const SweptMover& mover, const MotionSettings& s,
                    MotionOutcome& out) const {
    ++out.checks;
    const Body &a = *p.part->body, &b = *p.other;
    const Moving first{a.shape.get(), &*p.part->motion};
    const MotionContact before = out.contact;
    if (p.itself()) {
        CertifySettings settings = s.certify;
        if (!s.margin_to_itself) settings.margin = 0;
        const auto [mine, theirs] = mover.motion.beside(a.link, a.held_at(), b.link, b.held_at());
        find_contact({a.shape.get(), &*mine}, {b.shape.get(), &*theirs}, 0, 1, settings, out.contact);
    } else if (p.other_part) {
        find_contact(first, {b.shape.get(), &*p.other_part->motion}, 0, 1, s.certify, out.contact);
    } else if (!body(b.root).trajectory || std::isnan(s.from)) {
        const RigidMotion rest(b.pose, b.pose);
        find_contact(first, {b.shape.get(), &rest}, 0, 1, s.certify, out.contact);
    } else {
        certify_along_trajectory(*p.part, b, s, out.contact);
    }
    if (!out.contact.replaces(before)) return;
    out.part = a.id;
    out.other = b.id;
}

void World::certify_all(const SweptMover& mover, const std::vector<BodyId>& others, const MotionSettings& s,
                        MotionOutcome& out) const {
    const bool at_rest = std::isnan(s.from);
    for_each_pair(
        std::span<const SweptMover>(&mover, 1), &others, PairOrder::by_part,
        [&](const Body& other) -> const Box& { return at_rest ? other.box : other.extent; },
        [&](const CandidatePair<SweptPart>& p) {
            certify(p, mover, s, out);
            return s.certify.first || !out.contact.found;
        });
    if (out.contact.found && std::isnan(out.contact.shown)) certify_later(mover, others, s, out);
}

// A motion is undecided from `free_until` on, where it grazes a body: a contact with another body that follows is
// reported.
void World::certify_later(const SweptMover& mover, const std::vector<BodyId>& others, const MotionSettings& s,
                          MotionOutcome& out) const {
    MotionOutcome later;
    for_each_pair(
        std::span<const SweptMover>(&mover, 1), &others, PairOrder::by_part,
        [&](const Body& other) -> const Box& { return std::isnan(s.from) ? other.box : other.extent; },
        [&](const CandidatePair<SweptPart>& p) {
            if (p.part->body->id != out.part || p.other->id != out.other) certify(p, mover, s, later);
            return true;
        });
    out.checks += later.checks;
    out.contact.work += later.contact.work;
    if (!later.contact.found || std::isnan(later.contact.shown)) return;
    out.contact.shown = later.contact.shown;
    out.part = later.part;
    out.other = later.other;
}

MotionOutcome World::check_motion(BodyId id, const Place& from, const Place& to, const MotionSettings& given) const {
    const Body& robot = body(id);
    const SweptMover mover = swept(robot, from, to, given.certify.margin);
    const MotionSettings s = given.with_speed(mover.speed);
    std::vector<BodyId> others;
    candidates(robot, mover.around, others);
    others.erase(std::remove_if(others.begin(), others.end(), [&](BodyId o) { return body(o).root == id; }),
                 others.end());
    MotionOutcome out;
    if (s.resolution > 0) {
        out = step_through(mover, others, s);
    } else if (collides_at(mover, 0, others, s, out)) {
        out.contact = {0, 0, true};
    } else if (!s.certify.first && collides_at(mover, 1, others, s, out)) {
        out.contact = {0, 1, true};
    } else {
        certify_all(mover, others, s, out);
        if (!s.certify.first && out.contact.found) out.contact.free_until = 0;  // not every pair was certified
    }
    tests_.fetch_add(out.checks, std::memory_order_relaxed);
    motion_steps_.fetch_add(out.contact.work, std::memory_order_relaxed);
    return out;
}

}  // namespace fgenv
