// Checks for planners: movers at rest or in simultaneous motion; the last colliding pair is tested first.
#include <algorithm>
#include <cmath>

#include "world/pair_loop.h"

namespace fgenv {
namespace {

using SweptPair = CandidatePair<SweptPart>;

constexpr int64_t most_samples = 16;  // per motion before certification
constexpr double sample_step = 0.25;  // distance between samples, relative to the smallest body's radius

// Fractions k / n of a motion for k = 1 to n - 1, each once: halves first, then quarters, and so on.
template <class Visit>
bool all_of_halving(int64_t n, const Visit& visit) {
    int64_t stride = 1;
    while (stride < n) stride *= 2;
    for (; stride > 1; stride /= 2)
        for (int64_t k = stride / 2; k < n; k += stride)
            if (!visit(double(k) / double(n))) return false;
    return true;
}

// Tests the last colliding pair first.
void put_first(std::vector<SweptPair>& pairs, const BodyPair& last) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const SweptPair& p) {
        return p.part->body->id == last.a && p.other->id == last.b;
    });
    if (found != pairs.end()) std::rotate(pairs.begin(), found, found + 1);
}

}  // namespace

bool World::free_at(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                    BodyPair& last) const {
    int64_t checks = 0;
    const bool free = stand_free(robots, places, margin, last, checks);
    tests_.fetch_add(checks, std::memory_order_relaxed);
    return free;
}

// Whether the last colliding pair of a mover and a body that belongs to no mover collides again.
bool World::collides_again(std::span<const PlacedMover> movers, double margin, const BodyPair& last,
                           int64_t& checks) const {
    const Body* b = find(last.b);
    if (!b || !b->present) return false;
    const PlacedPart* part = nullptr;
    for (const PlacedMover& m : movers) {
        if (m.robot->id == b->root) return false;
        for (const PlacedPart& p : m.parts)
            if (!part && p.body->id == last.a) part = &p;
    }
    if (!part || ignores(*part->body, *b) || !overlap(part->box, b->box)) return false;
    ++checks;
    return hits(*part->body->shape, *b->shape, relative(part->pose, b->pose), margin, true);
}

bool World::stand_free(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                       BodyPair& last, int64_t& checks) const {
    std::vector<PlacedMover> movers;
    movers.reserve(robots.size());
    for (size_t m = 0; m < robots.size(); ++m) movers.push_back(placed(body(robots[m]), places[m], margin));
    if (collides_again(movers, margin, last, checks)) return false;
    return free_of_contact(
        std::span<const PlacedMover>(movers), nullptr, PairOrder::by_body,
        [](const Body& other) -> const Box& { return other.box; }, {now, margin, 0, true}, last, checks);
}

// Whether no pair collides at the places of the movers.
bool World::free_at_sample(const std::vector<SweptMover>& movers, const std::vector<Place>& places,
                           const std::vector<SweptPair>& pairs, double margin, BodyPair& last, int64_t& checks) const {
    std::vector<Frames> frames;
    for (size_t m = 0; m < movers.size(); ++m) frames.push_back(frames_at(movers[m].robot->robot.get(), places[m]));
    for (const SweptPair& p : pairs) {
        const Body &a = *p.part->body, &b = *p.other;
        const Rigid at_a = a.in(frames[p.mover]), at_b = p.other_mover < 0 ? b.pose : b.in(frames[p.other_mover]);
        ++checks;
        if (!hits(*a.shape, *b.shape, relative(at_a, at_b), p.itself() ? 0 : margin, true)) continue;
        last = {a.id, b.id};
        return false;
    }
    return true;
}

bool World::certified_free(const std::vector<SweptMover>& movers, const std::vector<SweptPair>& pairs,
                           const MotionSettings& s, BodyPair& last, int64_t& checks) const {
    MotionOutcome out;
    for (const SweptPair& p : pairs) {
        certify(p, movers[p.mover], s, out);
        if (!out.contact.found) continue;
        last = {p.part->body->id, p.other->id};
        break;
    }
    checks += out.checks;
    return !out.contact.found;
}

bool World::free_on(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                    const MotionSettings& settings, BodyPair& last) const {
    int64_t checks = 0;
    const bool free = move_free(robots, from, to, settings, last, checks);
    tests_.fetch_add(checks, std::memory_order_relaxed);
    return free;
}

// Tests the end and the middle first: most colliding motions collide there, and no motion has to be set up.
bool World::move_free(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                      const MotionSettings& given, BodyPair& last, int64_t& checks) const {
    const bool discrete = given.resolution > 0;
    const double margin = given.certify.margin;
    std::vector<Place> places(robots.size());
    const auto at = [&](double t) -> const std::vector<Place>& {
        for (size_t m = 0; m < robots.size(); ++m) places[m] = between(body(robots[m]).robot.get(), from[m], to[m], t);
        return places;
    };
    if (!stand_free(robots, to, margin, last, checks)) return false;
    if (!discrete && !stand_free(robots, at(0.5), margin, last, checks)) return false;
    std::vector<SweptMover> movers;
    movers.reserve(robots.size());
    double speed = 0, size = HUGE_VAL;
    for (size_t i = 0; i < robots.size(); ++i) {
        movers.push_back(swept(body(robots[i]), from[i], to[i], margin));
        speed = greater(speed, movers[i].speed);
        for (const SweptPart& p : movers[i].parts) size = lesser(size, p.body->shape->radius);
    }
    std::vector<SweptPair> pairs;
    for_each_pair(
        std::span<const SweptMover>(movers), nullptr, PairOrder::by_body,
        [](const Body& other) -> const Box& { return other.box; },
        [&](const SweptPair& p) {
            pairs.push_back(p);
            return true;
        });
    if (pairs.empty()) return true;
    put_first(pairs, last);
    MotionSettings s = given.with_speed(speed);
    s.margin_to_itself = false;
    const int64_t samples =
        discrete
            ? steps_of(s, speed)
            : static_cast<int64_t>(lesser(greater(std::ceil(speed / (sample_step * size)), 1), double(most_samples)));
    return all_of_halving(samples,
                          [&](double t) {
                              return (t == 0.5 && !discrete) ||
                                     free_at_sample(movers, at(t), pairs, margin, last, checks);
                          }) &&
           (discrete || certified_free(movers, pairs, s, last, checks));
}

bool World::motions_collide(BodyId a, const Place& from_a, const Place& to_a, BodyId b, const Place& from_b,
                            const Place& to_b, const MotionSettings& settings) const {
    const Body &first = body(a), &second = body(b);
    const double margin = settings.certify.margin;
    if (!overlap(rough_box(first, from_a, to_a, margin), rough_box(second, from_b, to_b, margin))) return false;
    const SweptMover u = swept(first, from_a, to_a, margin), v = swept(second, from_b, to_b, margin);
    const PairContact found = first_contact(u, false, v, false, {0, 1}, settings);
    tests_.fetch_add(found.checks, std::memory_order_relaxed);
    return found.contact.found;
}

}  // namespace fgenv
