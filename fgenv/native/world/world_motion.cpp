// A world's motions: from pose to pose, certified or looked at in steps, one mover or many at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "world/swept_mover.h"

namespace fgenv {
namespace {

constexpr int max_steps = 10'000'000;  // of a motion that is looked at in steps

}  // namespace

World::Sweeping World::sweeping(const Body& robot, const Place& from, const Place& to, double margin) const {
    const Robot* tree = robot.robot.get();
    Sweeping out{&robot, {tree, from, to}, false, {}};
    if (tree) {
        const int32_t base = fgenv::size(tree->joints[0].kind);
        out.turns_in_itself = !std::equal(from.q.begin() + base, from.q.end(), to.q.begin() + base);
    }
    out.parts.reserve(robot.parts.size());
    for (BodyId id : robot.parts) {
        const Body& part = body(id);
        out.parts.push_back({&part, out.motion.part(part.link, part.held_at()), {}});
        Part& p = out.parts.back();
        p.swept = widened(swept_box(*part.shape, *p.motion, 0, 1), margin);
        grow(out.around, p.swept);
        out.speed = greater(out.speed, p.motion->speed(part.shape->radius));
    }
    return out;
}

// Collision at one fraction of the motion with itself, bodies at rest, or bodies on their trajectories.
bool World::touches_at(const Sweeping& moving, double t, const std::vector<BodyId>& others, const MotionSettings& s,
                       MotionOutcome& out) const {
    const double time = s.from + t * (s.to - s.from), margin = s.certify.margin;
    for (const auto& [i, j] : moving.robot->own_pairs) {
        const Part &a = moving.parts[i], &b = moving.parts[j];
        if (!overlap(a.swept, b.swept)) continue;
        ++out.checks;
        if (!hits(*a.body->shape, *b.body->shape, relative(a.motion->pose(t), b.motion->pose(t)), margin, true))
            continue;
        out.part = a.body->id;
        out.other = b.body->id;
        return true;
    }
    for (const Part& part : moving.parts) {
        const Rigid pose = part.motion->pose(t);
        const Box box = widened(posed_box(*part.body->shape, pose), margin);
        for (BodyId id : others) {
            const Body& other = body(id);
            if (ignores(*part.body, other) || !overlap(box, box_of(other, time))) continue;
            ++out.checks;
            if (!hits(*part.body->shape, *other.shape, relative(pose, pose_of(other, time)), margin, true)) continue;
            out.part = part.body->id;
            out.other = id;
            return true;
        }
    }
    return false;
}

// As OMPL's discrete validator: at steps no point moves more than `resolution` between; the first that
// collides.
MotionOutcome World::step_through(const Sweeping& moving, const std::vector<BodyId>& others,
                                  const MotionSettings& s) const {
    MotionOutcome out;
    const double expected = std::ceil(moving.speed / s.resolution);
    if (!(expected <= max_steps))
        throw std::invalid_argument("resolution: " + std::to_string(s.resolution) + " m on a way of " +
                                    std::to_string(moving.speed) + " m: expected at most " + std::to_string(max_steps) +
                                    " steps");
    const int64_t steps = std::max<int64_t>(1, static_cast<int64_t>(expected));
    for (int64_t i = 0; i <= steps; ++i) {
        const double t = double(i) / double(steps);
        if (!touches_at(moving, t, others, s, out)) continue;
        out.contact = {i ? double(i - 1) / double(steps) : 0, t, true};
        break;
    }
    return out;
}

void World::certify(const Part& part, const Body& other, const MotionSettings& s, MotionOutcome& out) const {
    ++out.checks;
    const Moving a{part.body->shape.get(), &*part.motion};
    const Body& root = body(other.root);
    const Contact before = out.contact;
    int64_t sweeps = 0;
    if (!root.trajectory || std::isnan(s.from)) {
        const RigidMotion rest(other.pose, other.pose);
        find_contact(a, {other.shape.get(), &rest}, 0, 1, s.certify, out.contact, sweeps);
    } else {
        // From one pose of the trajectory to the next. Fractions are those of that leg, however short it is
        // beside the motion, and the robot's motion is cut to it.
        std::vector<double> ends;  // seconds
        for (double time : root.trajectory->times)
            if (time > s.from && time < s.to) ends.push_back(time);
        ends.push_back(s.to);
        double lo = 0, from = s.from;
        for (double to : ends) {
            const double hi = to < s.to ? lesser((to - s.from) / (s.to - s.from), 1) : 1;
            if (lo > out.contact.free_until) break;
            const Trajectory::Leg leg = root.trajectory->leg(from);
            const MoverMotion theirs(root.robot.get(), leg.from, leg.to);
            const PartMotion whole = theirs.part(other.link, other.held_at()), piece = part.motion.retimed(lo, hi - lo),
                             way = leg.length > 0
                                       ? whole.retimed((from - leg.begin) / leg.length, (to - from) / leg.length)
                                       : whole;
            Contact found;
            if (out.contact.free_until < hi) found.free_until = (out.contact.free_until - lo) / (hi - lo);
            CertifySettings cut = s.certify;
            cut.speed *= hi - lo;
            find_contact({part.body->shape.get(), &*piece}, {other.shape.get(), &*way}, 0, 1, cut, found, sweeps);
            const double free_until = lo + found.free_until * (hi - lo);
            if (found.found && (!out.contact.found || free_until < out.contact.free_until)) {
                out.contact = {free_until, lo + found.shown * (hi - lo), true};
                break;
            }
            lo = hi;
            from = to;
        }
    }
    if (out.contact.replaces(before)) {
        out.part = part.body->id;
        out.other = other.id;
    }
}

void World::certify_all(const Sweeping& moving, const std::vector<BodyId>& others, const MotionSettings& s,
                        MotionOutcome& out) const {
    certify_itself(moving, s, out);
    for (const Part& part : moving.parts)
        for (BodyId id : others) {
            if (!s.certify.first && out.contact.found) return;
            const Body& other = body(id);
            const Box box = std::isnan(s.from) ? other.box : other.extent;
            if (!ignores(*part.body, other) && overlap(box, part.swept)) certify(part, other, s, out);
        }
}

// A robot's parts against each other.
void World::certify_itself(const Sweeping& moving, const MotionSettings& s, MotionOutcome& out) const {
    if (!moving.turns_in_itself) return;
    for (const auto& [i, j] : moving.robot->own_pairs) {
        if (!s.certify.first && out.contact.found) return;
        const Part &a = moving.parts[i], &b = moving.parts[j];
        if (!overlap(a.swept, b.swept)) continue;
        ++out.checks;
        const Contact before = out.contact;
        int64_t sweeps = 0;
        const auto [mine, theirs] =
            moving.motion.beside(a.body->link, a.body->held_at(), b.body->link, b.body->held_at());
        find_contact({a.body->shape.get(), &*mine}, {b.body->shape.get(), &*theirs}, 0, 1, s.certify, out.contact,
                     sweeps);
        if (!out.contact.replaces(before)) continue;
        out.part = a.body->id;
        out.other = b.body->id;
    }
}

MotionOutcome World::check_motion(BodyId id, const Place& from, const Place& to, const MotionSettings& given) const {
    const Body& robot = body(id);
    const Sweeping moving = sweeping(robot, from, to, given.certify.margin);
    const MotionSettings s = given.with_speed(moving.speed);
    std::vector<BodyId> others;
    candidates(robot, moving.around, others);
    others.erase(std::remove_if(others.begin(), others.end(), [&](BodyId o) { return body(o).root == id; }),
                 others.end());
    MotionOutcome out;
    if (s.resolution > 0) {
        out = step_through(moving, others, s);
    } else if (touches_at(moving, 0, others, s, out)) {
        out.contact = {0, 0, true};
    } else if (!s.certify.first && touches_at(moving, 1, others, s, out)) {
        out.contact = {0, 1, true};
    } else {
        certify_all(moving, others, s, out);
        if (!s.certify.first && out.contact.found) out.contact.free_until = 0;  // not every pair was asked
    }
    tests_.fetch_add(out.checks, std::memory_order_relaxed);
    return out;
}

}  // namespace fgenv
