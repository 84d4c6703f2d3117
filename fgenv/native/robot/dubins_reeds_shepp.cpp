// Shortest ways of a car, by words: each a sequence of arcs and straight stretches whose lengths have a closed
// form. All words are tried; radii are 1.
#include <algorithm>
#include <array>
#include <cmath>

#include "robot/steering.h"

namespace fgenv {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double slack = 1e-9;

struct Target {
    double x, y, yaw;
};

struct Sine {
    double s, c;
    explicit Sine(double angle) { sin_cos(angle, s, c); }
};

double arc_cosine(double x) { return arc_tangent(std::sqrt(greater(0, (1 - x) * (1 + x))), x); }

// In [0, 2 pi), and in (-pi, pi].
double once_around(double a) {
    const double r = a - 2 * pi * std::floor(a / (2 * pi));
    return r > 2 * pi - slack ? 0 : r;
}
double half_around(double a) {
    const double r = once_around(a);
    return r > pi ? r - 2 * pi : r;
}

using Word = std::vector<CarPiece>;

class Shortest {
public:
    void offer(const Word& word) {
        double length = 0;
        for (const CarPiece& p : word) length += std::fabs(p.length);
        if (length >= length_) return;
        length_ = length;
        word_ = word;
    }
    Word take() {
        word_.erase(std::remove_if(word_.begin(), word_.end(), [](const CarPiece& p) { return p.length == 0; }),
                    word_.end());
        return std::move(word_);
    }

private:
    double length_ = HUGE_VAL;
    Word word_;
};

}  // namespace

// Arc, straight, arc, or three arcs. From the first circle's middle to the last one's, both tangents' lengths
// follow.
std::vector<CarPiece> dubins(double x, double y, double yaw) {
    Shortest best;
    const Sine end(yaw);
    for (const int first : {1, -1})
        for (const int last : {1, -1}) {
            // Middles of the circles that are left and entered.
            const double cx = x - last * end.s, cy = y + last * end.c - first, d = std::hypot(cx, cy);
            const double direction = arc_tangent(cy, cx);
            double heading = direction, straight = d;
            if (first != last) {
                if (d < 2 - slack) continue;
                straight = std::sqrt(greater(0, d * d - 4));
                heading = direction + first * arc_tangent(2, straight);
            }
            best.offer(
                {{first, once_around(first * heading)}, {0, straight}, {last, once_around(last * (yaw - heading))}});
        }
    for (const int turn : {1, -1}) {
        const double cx = x - turn * end.s, cy = y + turn * end.c - turn, d = std::hypot(cx, cy);
        if (d > 4) continue;
        const double direction = arc_tangent(cy, cx), middle = 2 * pi - arc_cosine(greater(-1, 1 - d * d / 8));
        for (const double arc : {middle, 2 * pi - middle}) {
            // The middle arc turns the other way by `arc`; half of it on either side of the line of middles.
            const double before = turn * direction + arc / 2;
            best.offer({{turn, once_around(before)}, {-turn, arc}, {turn, once_around(turn * yaw - before + arc)}});
        }
    }
    return best.take();
}

namespace {

// Formulas 8.1 to 8.11 of Reeds and Shepp: lengths of one word each, or nothing.
struct Lengths {
    bool ok = false;
    std::array<double, 3> l{};
};

struct Polar {
    double r, angle;
    Polar(double x, double y) : r(std::hypot(x, y)), angle(arc_tangent(y, x)) {}
};

Lengths lengths(double t, double u, double v, bool ok) { return {ok, {t, u, v}}; }

void tau_omega(double u, double v, double xi, double eta, double yaw, double& tau, double& omega) {
    const Sine at_u(u), at_v(v), at_d(half_around(u - v));
    const double a = at_u.s - at_d.s, b = at_u.c - at_d.c - 1;
    const double t = arc_tangent(eta * a - xi * b, xi * a + eta * b);
    tau = half_around(2 * (at_d.c - at_v.c - at_u.c) + 3 < 0 ? t + pi : t);
    omega = half_around(tau - u + v - yaw);
}

Lengths lsl(const Target& g) {  // L+ S+ L+
    const Sine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    const double v = half_around(g.yaw - p.angle);
    return lengths(p.angle, p.r, v, p.angle >= -slack && v >= -slack);
}
Lengths lsr(const Target& g) {  // L+ S+ R+
    const Sine a(g.yaw);
    const Polar p(g.x + a.s, g.y - 1 - a.c);
    if (p.r < 2) return {};
    const double u = std::sqrt(p.r * p.r - 4), t = half_around(p.angle + arc_tangent(2, u)), v = half_around(t - g.yaw);
    return lengths(t, u, v, t >= -slack && v >= -slack);
}
Lengths lrl(const Target& g) {  // L+ R- L
    const Sine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    if (p.r > 4) return {};
    const double u = -2 * (0.5 * pi - arc_cosine(p.r / 4)), t = half_around(p.angle + 0.5 * u + pi);
    return lengths(t, u, half_around(g.yaw - t + u), t >= -slack);
}
Lengths lrlr_same(const Target& g) {  // L+ R+(u) L-(u) R-
    const Sine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c, rho = 0.25 * (2 + std::hypot(xi, eta));
    if (rho > 1) return {};
    const double u = arc_cosine(rho);
    double t, v;
    tau_omega(u, -u, xi, eta, g.yaw, t, v);
    return lengths(t, u, v, t >= -slack && v <= slack);
}
Lengths lrlr_other(const Target& g) {  // L+ R-(u) L-(u) R+
    const Sine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c, rho = (20 - xi * xi - eta * eta) / 16;
    if (rho < 0 || rho > 1) return {};
    const double u = -arc_cosine(rho);
    double t, v;
    tau_omega(u, u, xi, eta, g.yaw, t, v);
    return lengths(t, u, v, u >= -0.5 * pi && t >= -slack && v >= -slack);
}
Lengths lrsl(const Target& g) {  // L+ R-(pi/2) S- L-
    const Sine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    if (p.r < 2) return {};
    const double r = std::sqrt(p.r * p.r - 4), u = 2 - r, t = half_around(p.angle + arc_tangent(r, -2)),
                 v = half_around(g.yaw - 0.5 * pi - t);
    return lengths(t, u, v, t >= -slack && u <= slack && v <= slack);
}
Lengths lrsr(const Target& g) {  // L+ R-(pi/2) S- R-
    const Sine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c;
    const Polar p(-eta, xi);
    if (p.r < 2) return {};
    const double v = half_around(p.angle + 0.5 * pi - g.yaw);
    return lengths(p.angle, 2 - p.r, v, p.angle >= -slack && v <= slack);
}
Lengths lrslr(const Target& g) {  // L+ R-(pi/2) S- L-(pi/2) R+
    const Sine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c;
    const Polar p(xi, eta);
    if (p.r < 2) return {};
    const double u = 4 - std::sqrt(p.r * p.r - 4);
    if (u > 0) return {};
    const double t = half_around(arc_tangent((4 - u) * xi - 2 * eta, -2 * xi + (u - 4) * eta)),
                 v = half_around(t - g.yaw);
    return lengths(t, u, v, t >= -slack && v >= -slack);
}

// A word of a formula: which way each piece turns, and its length: one of the three, times a sign, or a quarter.
struct Family {
    Lengths (*formula)(const Target&);
    std::vector<std::pair<int, double (*)(const std::array<double, 3>&)>> pieces;
    bool backwards;  // also read from the end to the beginning
};

double first(const std::array<double, 3>& l) { return l[0]; }
double second(const std::array<double, 3>& l) { return l[1]; }
double third(const std::array<double, 3>& l) { return l[2]; }
double opposite(const std::array<double, 3>& l) { return -l[1]; }
double quarter(const std::array<double, 3>&) { return -0.5 * pi; }

const std::vector<Family>& families() {
    constexpr int L = 1, S = 0, R = -1;
    static const std::vector<Family> all = {
        {lsl, {{L, first}, {S, second}, {L, third}}, false},
        {lsr, {{L, first}, {S, second}, {R, third}}, false},
        {lrl, {{L, first}, {R, second}, {L, third}}, true},
        {lrlr_same, {{L, first}, {R, second}, {L, opposite}, {R, third}}, false},
        {lrlr_other, {{L, first}, {R, second}, {L, second}, {R, third}}, false},
        {lrsl, {{L, first}, {R, quarter}, {S, second}, {L, third}}, true},
        {lrsr, {{L, first}, {R, quarter}, {S, second}, {R, third}}, true},
        {lrslr, {{L, first}, {R, quarter}, {S, second}, {L, quarter}, {R, third}}, false},
    };
    return all;
}

}  // namespace

// Time flipped, the car goes the other way along a word; reflected, left is right; backwards, the word is read
// from its end.
std::vector<CarPiece> reeds_shepp(double x, double y, double yaw) {
    Shortest best;
    const Sine a(yaw);
    for (const Family& family : families())
        for (int variant = 0; variant < (family.backwards ? 8 : 4); ++variant) {
            const bool flipped = variant & 1, reflected = variant & 2, backwards = variant & 4;
            Target g = backwards ? Target{x * a.c + y * a.s, x * a.s - y * a.c, yaw} : Target{x, y, yaw};
            if (flipped) g = {-g.x, g.y, -g.yaw};
            if (reflected) g = {g.x, -g.y, -g.yaw};
            const Lengths found = family.formula(g);
            if (!found.ok) continue;
            Word word;
            for (const auto& [turn, length] : family.pieces)
                word.push_back({reflected ? -turn : turn, flipped ? -length(found.l) : length(found.l)});
            if (backwards) std::reverse(word.begin(), word.end());
            best.offer(word);
        }
    return best.take();
}

}  // namespace fgenv
