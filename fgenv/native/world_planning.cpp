// A world's answers to planners: movers that stand or go all at once, yes or no, what last said no first.
#include <algorithm>
#include <cmath>

#include "sweeping.h"

namespace fgenv {
namespace {

constexpr int64_t most_steps = 10'000'000;  // of a motion that is looked at in steps
constexpr int64_t most_looks = 16;
constexpr double look = 0.25;  // of the smallest part's radius: a certified motion is looked at so often before

// Fractions of a motion, the whole first, then halves, quarters and so on: k / n for k = 1 to n, each once.
template <class Visit>
bool all_of_halving(int64_t n, const Visit& visit) {
    if (!visit(1.0)) return false;
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

std::vector<World::Pair> World::pairs(const std::vector<BodyId>& robots, const std::vector<Sweeping>& moving, bool standing) const {
    std::vector<Pair> out;
    std::vector<BodyId> others;
    const int32_t n = static_cast<int32_t>(moving.size());
    for (int32_t m = 0; m < n; ++m) {
        const Sweeping& robot = moving[m];
        if (standing || robot.turns_in_itself)
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

bool World::look_at(const std::vector<Sweeping>& moving, const std::vector<Place>& places, const std::vector<Pair>& pairs,
                    double margin, Suspects& suspects, int64_t& asked) const {
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
        const PartMotion rest(RigidMotion(p.b->pose, p.b->pose));
        const PartMotion& theirs = p.other_mover < 0 ? rest : moving[p.other_mover].parts[p.other_part].motion;
        CertifySettings settings = s.certify;
        if (p.itself()) settings.margin = 0;
        Contact contact;
        int64_t sweeps = 0;
        ++asked;
        find_contact({p.a->shape.get(), &*moving[p.mover].parts[p.part].motion}, {p.b->shape.get(), &*theirs}, 0, 1,
                     settings, contact, sweeps);
        if (!contact.found) continue;
        suspects = {p.a->id, p.b->id};
        return false;
    }
    return true;
}

bool World::free_at(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                    Suspects& suspects) const {
    std::vector<Sweeping> standing;
    standing.reserve(robots.size());
    for (size_t i = 0; i < robots.size(); ++i) standing.push_back(sweeping(body(robots[i]), places[i], places[i], margin));
    int64_t asked = 0;
    const bool free = look_at(standing, places, ordered(pairs(robots, standing, true), suspects), margin, suspects, asked);
    tests_.fetch_add(asked, std::memory_order_relaxed);
    return free;
}

bool World::free_on(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                    const MotionSettings& given, Suspects& suspects) const {
    std::vector<Sweeping> moving;
    moving.reserve(robots.size());
    double speed = 0, size = HUGE_VAL;
    for (size_t i = 0; i < robots.size(); ++i) {
        moving.push_back(sweeping(body(robots[i]), from[i], to[i], given.certify.margin));
        speed = greater(speed, moving[i].speed);
        for (const Part& p : moving[i].parts) size = lesser(size, p.body->shape->radius);
    }
    const std::vector<Pair> near = ordered(pairs(robots, moving, false), suspects);
    if (near.empty()) return true;
    const MotionSettings s = given.with_speed(speed);
    const bool discrete = s.resolution > 0;
    const double wanted = std::ceil(speed / (discrete ? s.resolution : look * size));
    if (discrete && !(wanted <= double(most_steps)))
        throw std::invalid_argument("resolution: " + std::to_string(s.resolution) + " m on a way of " +
                                    std::to_string(speed) + " m: wanted at most " + std::to_string(most_steps) + " steps");
    const auto looks = static_cast<int64_t>(lesser(greater(wanted, 1), double(discrete ? most_steps : most_looks)));
    std::vector<Place> places(robots.size());
    int64_t asked = 0;
    const bool free = all_of_halving(looks, [&](double t) {
        for (size_t m = 0; m < robots.size(); ++m)
            places[m] = t == 1 ? to[m] : between(moving[m].robot->robot.get(), from[m], to[m], t);
        return look_at(moving, places, near, s.certify.margin, suspects, asked);
    }) && (discrete || certified(moving, near, s, suspects, asked));
    tests_.fetch_add(asked, std::memory_order_relaxed);
    return free;
}

bool World::meet(BodyId a, const Place& from_a, const Place& to_a, BodyId b, const Place& from_b, const Place& to_b,
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
