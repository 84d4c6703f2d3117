// A world's answers to planners: movers that stand or go all at once, yes or no, what last said no first.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "world/swept_mover.h"

namespace fgenv {
namespace {

constexpr int64_t most_steps = 10'000'000;  // of a motion that is looked at in steps
constexpr int64_t most_looks = 16;
constexpr double look = 0.25;  // of the smallest part's radius: a certified motion is looked at so often before

// Fractions of a motion, halves first, then quarters and so on: k / n for k = 1 to n - 1, each once.
template <class Visit>
bool all_of_halving(int64_t n, const Visit& visit) {
    int64_t stride = 1;
    while (stride < n) stride *= 2;
    for (; stride > 1; stride /= 2)
        for (int64_t k = stride / 2; k < n; k += stride)
            if (!visit(double(k) / double(n))) return false;
    return true;
}

// The pair that met when last asked comes first.
template <class Pair>
std::vector<Pair> ordered(std::vector<Pair> pairs, const Suspects& suspects) {
    const auto is_suspect = [&](const Pair& p) { return p.a->id == suspects.a && p.b->id == suspects.b; };
    const auto last = std::find_if(pairs.begin(), pairs.end(), is_suspect);
    if (last != pairs.end()) std::rotate(pairs.begin(), last, last + 1);
    return pairs;
}

}  // namespace

// Two bodies that may meet: a part of a mover, and a part of the same or another mover or a body at rest.
struct World::Pair {
    int32_t mover, part;              // places among the movers and in the mover's parts
    int32_t other_mover, other_part;  // -1: the other one rests
    const Body *a, *b;

    bool itself() const { return mover == other_mover; }
};

std::vector<World::Pair> World::pairs(const std::vector<BodyId>& robots, const std::vector<Sweeping>& moving) const {
    std::vector<Pair> out;
    std::vector<BodyId> others;
    const int32_t n = static_cast<int32_t>(moving.size());
    for (int32_t m = 0; m < n; ++m) {
        const Sweeping& robot = moving[m];
        if (robot.turns_in_itself)
            for (const auto& [i, j] : robot.robot->own_pairs)
                if (overlap(robot.parts[i].swept, robot.parts[j].swept))
                    out.push_back({m, i, m, j, robot.parts[i].body, robot.parts[j].body});
        others.clear();
        candidates(*robot.robot, robot.around, others);
        for (BodyId id : others) {
            const Body& other = body(id);
            if (std::find(robots.begin(), robots.end(), other.root) != robots.end()) continue;
            for (size_t i = 0; i < robot.parts.size(); ++i)
                if (overlap(robot.parts[i].swept, other.box) && !ignores(*robot.parts[i].body, other))
                    out.push_back({m, static_cast<int32_t>(i), -1, -1, robot.parts[i].body, &other});
        }
        for (int32_t k = m + 1; k < n; ++k) {
            if (!overlap(robot.around, moving[k].around)) continue;
            for (size_t i = 0; i < robot.parts.size(); ++i)
                for (size_t j = 0; j < moving[k].parts.size(); ++j) {
                    const Part &p = robot.parts[i], &q = moving[k].parts[j];
                    if (overlap(p.swept, q.swept) && !ignores(*p.body, *q.body))
                        out.push_back({m, static_cast<int32_t>(i), k, static_cast<int32_t>(j), p.body, q.body});
                }
        }
    }
    return out;
}

bool World::look_at(const std::vector<Sweeping>& moving, const std::vector<Place>& places,
                    const std::vector<Pair>& pairs, double margin, Suspects& suspects, int64_t& asked) const {
    std::vector<Frames> frames;
    for (size_t m = 0; m < moving.size(); ++m) frames.push_back(frames_at(moving[m].robot->robot.get(), places[m]));
    for (const Pair& p : pairs) {
        const Rigid a = p.a->in(frames[p.mover]), b = p.other_mover < 0 ? p.b->pose : p.b->in(frames[p.other_mover]);
        ++asked;
        if (!hits(*p.a->shape, *p.b->shape, relative(a, b), p.itself() ? 0 : margin, true)) continue;
        suspects = {p.a->id, p.b->id};
        return false;
    }
    return true;
}

bool World::certified(const std::vector<Sweeping>& moving, const std::vector<Pair>& pairs, const MotionSettings& s,
                      Suspects& suspects, int64_t& asked) const {
    for (const Pair& p : pairs) {
        PartMotion mine = moving[p.mover].parts[p.part].motion, theirs(RigidMotion(p.b->pose, p.b->pose));
        CertifySettings settings = s.certify;
        if (p.itself()) {
            std::tie(mine, theirs) =
                moving[p.mover].motion.beside(p.a->link, p.a->held_at(), p.b->link, p.b->held_at());
            settings.margin = 0;
        } else if (p.other_mover >= 0) {
            theirs = moving[p.other_mover].parts[p.other_part].motion;
        }
        Contact contact;
        int64_t sweeps = 0;
        ++asked;
        find_contact({p.a->shape.get(), &*mine}, {p.b->shape.get(), &*theirs}, 0, 1, settings, contact, sweeps);
        if (!contact.found) continue;
        suspects = {p.a->id, p.b->id};
        return false;
    }
    return true;
}

// A part of a mover that stands.
struct World::Stander {
    const Body* body;
    Rigid pose;
    Box box;  // margin and all
};

bool World::free_at(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                    Suspects& suspects) const {
    int64_t asked = 0;
    const bool free = stand_free(robots, places, margin, suspects, asked);
    tests_.fetch_add(asked, std::memory_order_relaxed);
    return free;
}

bool World::stand_free(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                       Suspects& suspects, int64_t& asked) const {
    std::vector<Stander> parts;
    std::vector<size_t> begins;
    std::vector<Box> around(robots.size(), empty_box());
    for (size_t m = 0; m < robots.size(); ++m) {
        const Body& robot = body(robots[m]);
        const Frames frames = frames_at(robot.robot.get(), places[m]);
        begins.push_back(parts.size());
        for (BodyId id : robot.parts) {
            const Body& part = body(id);
            const Rigid pose = part.in(frames);
            parts.push_back({&part, pose, widened(posed_box(*part.shape, pose), margin)});
            grow(around[m], parts.back().box);
        }
    }
    begins.push_back(parts.size());
    const auto meets = [&](const Stander& a, const Body& b, const Rigid& pose, const Box& box, double wide) {
        if (!overlap(a.box, box)) return false;
        ++asked;
        if (!hits(*a.body->shape, *b.shape, relative(a.pose, pose), wide, true)) return false;
        suspects = {a.body->id, b.id};
        return true;
    };
    const auto moving = [&](BodyId root) { return std::find(robots.begin(), robots.end(), root) != robots.end(); };
    const auto first =
        std::find_if(parts.begin(), parts.end(), [&](const Stander& p) { return p.body->id == suspects.a; });
    const Body* last = first == parts.end() ? nullptr : find(suspects.b);
    if (last && last->present && !moving(last->root) && !ignores(*first->body, *last) &&
        meets(*first, *last, last->pose, last->box, margin))
        return false;
    std::vector<BodyId> others;
    for (size_t m = 0; m < robots.size(); ++m) {
        for (const auto& [i, j] : body(robots[m]).own_pairs) {
            const Stander &a = parts[begins[m] + i], &b = parts[begins[m] + j];
            if (meets(a, *b.body, b.pose, b.box, 0)) return false;
        }
        others.clear();
        candidates(body(robots[m]), around[m], others);
        for (BodyId id : others) {
            const Body& other = body(id);
            if (moving(other.root)) continue;
            for (size_t i = begins[m]; i < begins[m + 1]; ++i)
                if (overlap(parts[i].box, other.box) && !ignores(*parts[i].body, other) &&
                    meets(parts[i], other, other.pose, other.box, margin))
                    return false;
        }
        for (size_t k = m + 1; k < robots.size(); ++k) {
            if (!overlap(around[m], around[k])) continue;
            for (size_t i = begins[m]; i < begins[m + 1]; ++i)
                for (size_t j = begins[k]; j < begins[k + 1]; ++j)
                    if (overlap(parts[i].box, parts[j].box) && !ignores(*parts[i].body, *parts[j].body) &&
                        meets(parts[i], *parts[j].body, parts[j].pose, parts[j].box, margin))
                        return false;
        }
    }
    return true;
}

// What stands in the way at the end or half way, as most that meet something do, is told before the motion is
// set up.
bool World::free_on(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                    const MotionSettings& given, Suspects& suspects) const {
    const bool discrete = given.resolution > 0;
    std::vector<Place> places(robots.size());
    int64_t asked = 0;
    const auto at = [&](double t) -> const std::vector<Place>& {
        for (size_t m = 0; m < robots.size(); ++m) places[m] = between(body(robots[m]).robot.get(), from[m], to[m], t);
        return places;
    };
    const auto free = [&] {
        if (!stand_free(robots, to, given.certify.margin, suspects, asked)) return false;
        if (!discrete && !stand_free(robots, at(0.5), given.certify.margin, suspects, asked)) return false;
        std::vector<Sweeping> moving;
        moving.reserve(robots.size());
        double speed = 0, size = HUGE_VAL;
        for (size_t i = 0; i < robots.size(); ++i) {
            moving.push_back(sweeping(body(robots[i]), from[i], to[i], given.certify.margin));
            speed = greater(speed, moving[i].speed);
            for (const Part& p : moving[i].parts) size = lesser(size, p.body->shape->radius);
        }
        const std::vector<Pair> near = ordered(pairs(robots, moving), suspects);
        if (near.empty()) return true;
        const MotionSettings s = given.with_speed(speed);
        const double expected = std::ceil(speed / (discrete ? s.resolution : look * size));
        if (discrete && !(expected <= double(most_steps)))
            throw std::invalid_argument("resolution: " + std::to_string(s.resolution) + " m on a way of " +
                                        std::to_string(speed) + " m: expected at most " + std::to_string(most_steps) +
                                        " steps");
        const auto looks =
            static_cast<int64_t>(lesser(greater(expected, 1), double(discrete ? most_steps : most_looks)));
        return all_of_halving(looks,
                              [&](double t) {
                                  return (t == 0.5 && !discrete) ||
                                         look_at(moving, at(t), near, s.certify.margin, suspects, asked);
                              }) &&
               (discrete || certified(moving, near, s, suspects, asked));
    };
    const bool found = free();
    tests_.fetch_add(asked, std::memory_order_relaxed);
    return found;
}

bool World::motions_collide(BodyId a, const Place& from_a, const Place& to_a, BodyId b, const Place& from_b, const Place& to_b,
                 const MotionSettings& settings) const {
    const Body &first = body(a), &second = body(b);
    const double margin = settings.certify.margin;
    if (!overlap(rough_box(first, from_a, to_a, margin), rough_box(second, from_b, to_b, margin))) return false;
    const Sweeping u = sweeping(first, from_a, to_a, margin), v = sweeping(second, from_b, to_b, margin);
    const Meeting found = meeting(u, false, v, false, 0, 1, settings);
    tests_.fetch_add(found.checks, std::memory_order_relaxed);
    return found.contact.found;
}

}  // namespace fgenv
