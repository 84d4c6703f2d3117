#include "policy/orca.h"

#include <algorithm>
#include <cmath>

namespace fgenv {
namespace {

constexpr double parallel_sine = 1e-9;  // of the angle below which lines count as parallel

Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
double length(Vec2 a) { return std::sqrt(dot(a, a)); }
Vec2 unit(Vec2 a) {
    const double l = length(a);
    return l > 0 ? (1 / l) * a : Vec2{1, 0};
}

// Velocities to the left of a directed line, and on it, are allowed.
struct HalfPlane {
    Vec2 point, direction;

    double violation(Vec2 v) const { return cross(direction, point - v); }  // meters per second, negative: inside
};

// Section 4: `change` is the least change of the relative velocity that leaves the cone of velocities that collide
// within the horizon; each side takes its share of it.
HalfPlane half_plane(const Disc& self, const Disc& other, double horizon, double dt) {
    const Vec2 p = other.position - self.position, v = self.velocity - other.velocity;
    const double squared = dot(p, p), r = self.radius + other.radius;
    const bool overlap = squared <= r * r;
    const double seconds = overlap ? dt : horizon;
    const Vec2 w = v - (1 / seconds) * p;  // from the center of the cone's round end
    const double ahead = dot(w, p);
    Vec2 direction, change;
    if (overlap || (ahead < 0 && ahead * ahead > r * r * dot(w, w))) {
        const Vec2 n = unit(w);
        direction = {n.y, -n.x};
        change = (r / seconds - length(w)) * n;
    } else {
        const double leg = std::sqrt(squared - r * r);
        if (cross(p, w) > 0)
            direction = (1 / squared) * Vec2{p.x * leg - p.y * r, p.x * r + p.y * leg};
        else
            direction = (-1 / squared) * Vec2{p.x * leg + p.y * r, p.y * leg - p.x * r};
        change = dot(v, direction) * direction - v;
    }
    return {self.velocity + other.responsibility * change, direction};
}

// What a linear program optimizes within the disc of `max_speed`.
struct Objective {
    Vec2 target;
    bool farthest;  // in the direction of `target`; else nearest to it
};

// The best point of the line of constraint i within the disc and the constraints before it; false if there is none.
bool optimize_on_line(const std::vector<HalfPlane>& constraints, size_t i, double max_speed, const Objective& objective,
                      Vec2& best) {
    const HalfPlane& line = constraints[i];
    const double middle = dot(line.point, line.direction),
                 inside = middle * middle + max_speed * max_speed - dot(line.point, line.point);
    if (inside < 0) return false;
    double left = -middle - std::sqrt(inside), right = -middle + std::sqrt(inside);
    for (size_t j = 0; j < i; ++j) {
        const double sine = cross(line.direction, constraints[j].direction),
                     by = cross(constraints[j].direction, line.point - constraints[j].point);
        if (std::fabs(sine) <= parallel_sine) {
            if (by < 0) return false;
            continue;
        }
        const double t = by / sine;
        sine >= 0 ? right = std::min(right, t) : left = std::max(left, t);
        if (left > right) return false;
    }
    double t = dot(line.direction, objective.target - line.point);
    if (objective.farthest) t = dot(objective.target, line.direction) > 0 ? right : left;
    best = line.point + std::clamp(t, left, right) * line.direction;
    return true;
}

// Constraint by constraint (M. de Berg and others, "Computational Geometry", chapter 4). Returns the index of the first
// constraint that cannot be kept, or their number. The order is fixed, not random: the same result on every machine.
size_t optimize(const std::vector<HalfPlane>& constraints, double max_speed, const Objective& objective, Vec2& best) {
    const Vec2 target = objective.target;
    if (objective.farthest)
        best = max_speed * target;
    else
        best = dot(target, target) > max_speed * max_speed ? max_speed * unit(target) : target;
    for (size_t i = 0; i < constraints.size(); ++i) {
        if (constraints[i].violation(best) <= 0) continue;
        const Vec2 before = best;
        if (!optimize_on_line(constraints, i, max_speed, objective, best)) {
            best = before;
            return i;
        }
    }
    return constraints.size();
}

// The line of equal violation of constraints i and j; false if there is none, or they are the same.
bool equal_violation(const HalfPlane& i, const HalfPlane& j, HalfPlane& out) {
    const double sine = cross(i.direction, j.direction);
    if (std::fabs(sine) <= parallel_sine) {
        if (dot(i.direction, j.direction) > 0) return false;
        out.point = 0.5 * (i.point + j.point);
    } else {
        const double t = cross(j.direction, i.point - j.point) / sine;
        out.point = i.point + t * i.direction;
    }
    out.direction = unit(j.direction - i.direction);
    return true;
}

// Section 5.3: minimizes the greatest violation if not all constraints can be kept, from constraint `first` on.
void minimize_violation(const std::vector<HalfPlane>& constraints, size_t first, double max_speed, Vec2& best) {
    double violation = 0;
    for (size_t i = first; i < constraints.size(); ++i) {
        if (constraints[i].violation(best) <= violation) continue;
        std::vector<HalfPlane> between;
        HalfPlane line{};
        for (size_t j = 0; j < i; ++j)
            if (equal_violation(constraints[i], constraints[j], line)) between.push_back(line);
        const Vec2 before = best, inward{-constraints[i].direction.y, constraints[i].direction.x};
        if (optimize(between, max_speed, {inward, true}, best) < between.size()) best = before;
        violation = constraints[i].violation(best);
    }
}

}  // namespace

Vec2 orca_velocity(const Disc& self, const std::vector<Neighbor>& neighbors, Vec2 preferred, double max_speed,
                   const OrcaSettings& settings) {
    std::vector<HalfPlane> constraints;
    for (const Neighbor& neighbor : neighbors) {
        const Vec2 p = neighbor.disc.position - self.position;
        if (dot(p, p) <= settings.range * settings.range)
            constraints.push_back(half_plane(self, neighbor.disc, neighbor.horizon, settings.dt));
    }
    Vec2 best{};
    const size_t kept = optimize(constraints, max_speed, {preferred, false}, best);
    if (kept < constraints.size()) minimize_violation(constraints, kept, max_speed, best);
    return best;
}

}  // namespace fgenv
