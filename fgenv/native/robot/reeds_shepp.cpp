#include <algorithm>
#include <array>

#include "robot/car_path.h"

namespace fgenv {
namespace {

struct Target {
    double x, y, yaw;
};

// Formulas 8.1 to 8.11 of Reeds and Shepp: the three lengths of a word, if it exists.
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
    const SineCosine at_u(u), at_v(v), at_d(wrapped_symmetric(u - v));
    const double a = at_u.s - at_d.s, b = at_u.c - at_d.c - 1;
    const double t = arc_tangent(eta * a - xi * b, xi * a + eta * b);
    tau = wrapped_symmetric(2 * (at_d.c - at_v.c - at_u.c) + 3 < 0 ? t + pi : t);
    omega = wrapped_symmetric(tau - u + v - yaw);
}

Lengths lsl(const Target& g) {  // L+ S+ L+
    const SineCosine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    const double v = wrapped_symmetric(g.yaw - p.angle);
    return lengths(p.angle, p.r, v, p.angle >= -path_slack && v >= -path_slack);
}
Lengths lsr(const Target& g) {  // L+ S+ R+
    const SineCosine a(g.yaw);
    const Polar p(g.x + a.s, g.y - 1 - a.c);
    if (p.r < 2) return {};
    const double u = std::sqrt(p.r * p.r - 4), t = wrapped_symmetric(p.angle + arc_tangent(2, u)),
                 v = wrapped_symmetric(t - g.yaw);
    return lengths(t, u, v, t >= -path_slack && v >= -path_slack);
}
Lengths lrl(const Target& g) {  // L+ R- L
    const SineCosine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    if (p.r > 4) return {};
    const double u = -2 * (0.5 * pi - arc_cosine(p.r / 4)), t = wrapped_symmetric(p.angle + 0.5 * u + pi);
    return lengths(t, u, wrapped_symmetric(g.yaw - t + u), t >= -path_slack);
}
Lengths lrlr_same(const Target& g) {  // L+ R+(u) L-(u) R-
    const SineCosine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c, rho = 0.25 * (2 + std::hypot(xi, eta));
    if (rho > 1) return {};
    const double u = arc_cosine(rho);
    double t, v;
    tau_omega(u, -u, xi, eta, g.yaw, t, v);
    return lengths(t, u, v, t >= -path_slack && v <= path_slack);
}
Lengths lrlr_other(const Target& g) {  // L+ R-(u) L-(u) R+
    const SineCosine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c, rho = (20 - xi * xi - eta * eta) / 16;
    if (rho < 0 || rho > 1) return {};
    const double u = -arc_cosine(rho);
    double t, v;
    tau_omega(u, u, xi, eta, g.yaw, t, v);
    return lengths(t, u, v, u >= -0.5 * pi && t >= -path_slack && v >= -path_slack);
}
Lengths lrsl(const Target& g) {  // L+ R-(pi/2) S- L-
    const SineCosine a(g.yaw);
    const Polar p(g.x - a.s, g.y - 1 + a.c);
    if (p.r < 2) return {};
    const double r = std::sqrt(p.r * p.r - 4), u = 2 - r, t = wrapped_symmetric(p.angle + arc_tangent(r, -2)),
                 v = wrapped_symmetric(g.yaw - 0.5 * pi - t);
    return lengths(t, u, v, t >= -path_slack && u <= path_slack && v <= path_slack);
}
Lengths lrsr(const Target& g) {  // L+ R-(pi/2) S- R-
    const SineCosine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c;
    const Polar p(-eta, xi);
    if (p.r < 2) return {};
    const double v = wrapped_symmetric(p.angle + 0.5 * pi - g.yaw);
    return lengths(p.angle, 2 - p.r, v, p.angle >= -path_slack && v <= path_slack);
}
Lengths lrslr(const Target& g) {  // L+ R-(pi/2) S- L-(pi/2) R+
    const SineCosine a(g.yaw);
    const double xi = g.x + a.s, eta = g.y - 1 - a.c;
    const Polar p(xi, eta);
    if (p.r < 2) return {};
    const double u = 4 - std::sqrt(p.r * p.r - 4);
    if (u > 0) return {};
    const double t = wrapped_symmetric(arc_tangent((4 - u) * xi - 2 * eta, -2 * xi + (u - 4) * eta)),
                 v = wrapped_symmetric(t - g.yaw);
    return lengths(t, u, v, t >= -path_slack && v >= -path_slack);
}

// The word of a formula: the turn of each segment, and its length: one of the three, its opposite, or a quarter.
struct Family {
    Lengths (*formula)(const Target&);
    std::vector<std::pair<int, double (*)(const std::array<double, 3>&)>> segments;
    bool reversible;  // the word read from its end is another word
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

// With time flipped, the car drives a word the other way; reflected, left and right are swapped; reversed, the
// word is read from its end.
CarPath reeds_shepp(double x, double y, double yaw) {
    ShortestPath best;
    const SineCosine a(yaw);
    for (const Family& family : families())
        for (int variant = 0; variant < (family.reversible ? 8 : 4); ++variant) {
            const bool flipped = variant & 1, reflected = variant & 2, reversed = variant & 4;
            Target g = reversed ? Target{x * a.c + y * a.s, x * a.s - y * a.c, yaw} : Target{x, y, yaw};
            if (flipped) g = {-g.x, g.y, -g.yaw};
            if (reflected) g = {g.x, -g.y, -g.yaw};
            const Lengths found = family.formula(g);
            if (!found.ok) continue;
            CarPath path;
            for (const auto& [turn, length] : family.segments)
                path.push_back({reflected ? -turn : turn, flipped ? -length(found.l) : length(found.l)});
            if (reversed) std::reverse(path.begin(), path.end());
            best.offer(path);
        }
    return best.take();
}

}  // namespace fgenv
