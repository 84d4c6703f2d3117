#include "policy/orca.h"

#include <algorithm>
#include <cmath>

namespace fgenv {
namespace {

constexpr double parallel = 1e-9;  // sine of the angle below which lines count as such

struct V {
    double x, y;
};
V operator+(V a, V b) { return {a.x + b.x, a.y + b.y}; }
V operator-(V a, V b) { return {a.x - b.x, a.y - b.y}; }
V operator*(double s, V a) { return {s * a.x, s * a.y}; }
double dot(V a, V b) { return a.x * b.x + a.y * b.y; }
double cross(V a, V b) { return a.x * b.y - a.y * b.x; }
double length(V a) { return std::sqrt(dot(a, a)); }
V unit(V a) {
    const double l = length(a);
    return l > 0 ? (1 / l) * a : V{1, 0};
}

// Velocities to the left of a directed line, and on it, are allowed.
struct Line {
    V point, along;
};

// The half-plane of section 4: u is the least change of the relative velocity that leaves the cone of
// velocities which meet within the horizon; each side takes its share of it.
Line half_plane(const Disc& self, const Disc& other, double horizon, double dt) {
    const V p{other.x - self.x, other.y - self.y}, own{self.vx, self.vy}, v{self.vx - other.vx, self.vy - other.vy};
    const double squared = dot(p, p), r = self.radius + other.radius;
    V along, u;
    if (squared > r * r) {
        const V w = v - (1 / horizon) * p;  // from the center of the cone's round end
        const double ahead = dot(w, p);
        if (ahead < 0 && ahead * ahead > r * r * dot(w, w)) {
            const V n = unit(w);
            along = {n.y, -n.x};
            u = (r / horizon - length(w)) * n;
        } else {
            const double leg = std::sqrt(squared - r * r);
            if (cross(p, w) > 0)
                along = (1 / squared) * V{p.x * leg - p.y * r, p.x * r + p.y * leg};
            else
                along = (-1 / squared) * V{p.x * leg + p.y * r, p.y * leg - p.x * r};
            u = dot(v, along) * along - v;
        }
    } else {  // they overlap: apart within a step
        const V w = v - (1 / dt) * p, n = unit(w);
        along = {n.y, -n.x};
        u = (r / dt - length(w)) * n;
    }
    return {own + other.share * u, along};
}

// The point of line i, within the disc of `most` and allowed by the lines before it, that is nearest to
// `expected`, or farthest in its direction; false if there is none.
bool on_line(const std::vector<Line>& lines, size_t i, double most, V expected, bool direction, V& found) {
    const Line& line = lines[i];
    const double middle = dot(line.point, line.along),
                 inside = middle * middle + most * most - dot(line.point, line.point);
    if (inside < 0) return false;
    double left = -middle - std::sqrt(inside), right = -middle + std::sqrt(inside);
    for (size_t j = 0; j < i; ++j) {
        const double sine = cross(line.along, lines[j].along), by = cross(lines[j].along, line.point - lines[j].point);
        if (std::fabs(sine) <= parallel) {
            if (by < 0) return false;
            continue;
        }
        const double t = by / sine;
        sine >= 0 ? right = std::min(right, t) : left = std::max(left, t);
        if (left > right) return false;
    }
    double t = dot(line.along, expected - line.point);
    if (direction) t = dot(expected, line.along) > 0 ? right : left;
    found = line.point + std::clamp(t, left, right) * line.along;
    return true;
}

// Line by line (M. de Berg and others, "Computational Geometry", chapter 4); the number of the first line
// that cannot be kept, or of all. In the order of the lines: no shuffling, the same on every machine.
size_t in_plane(const std::vector<Line>& lines, double most, V expected, bool direction, V& found) {
    if (direction)
        found = most * expected;
    else
        found = dot(expected, expected) > most * most ? most * unit(expected) : expected;
    for (size_t i = 0; i < lines.size(); ++i) {
        if (cross(lines[i].along, lines[i].point - found) <= 0) continue;
        const V before = found;
        if (!on_line(lines, i, most, expected, direction, found)) {
            found = before;
            return i;
        }
    }
    return lines.size();
}

// Where all cannot be kept: the greatest trespass as small as can be (section 5.3), from line `begin` on.
void least_trespass(const std::vector<Line>& lines, size_t begin, double most, V& found) {
    double trespass = 0;
    for (size_t i = begin; i < lines.size(); ++i) {
        if (cross(lines[i].along, lines[i].point - found) <= trespass) continue;
        std::vector<Line> between;  // where line j is trespassed as much as line i
        for (size_t j = 0; j < i; ++j) {
            const double sine = cross(lines[i].along, lines[j].along);
            V point;
            if (std::fabs(sine) <= parallel) {
                if (dot(lines[i].along, lines[j].along) > 0) continue;
                point = 0.5 * (lines[i].point + lines[j].point);
            } else {
                const double t = cross(lines[j].along, lines[i].point - lines[j].point) / sine;
                point = lines[i].point + t * lines[i].along;
            }
            between.push_back({point, unit(lines[j].along - lines[i].along)});
        }
        const V before = found;
        if (in_plane(between, most, {-lines[i].along.y, lines[i].along.x}, true, found) < between.size())
            found = before;
        trespass = cross(lines[i].along, lines[i].point - found);
    }
}

}  // namespace

void orca(const Disc& self, const std::vector<Neighbor>& others, double wanted_x, double wanted_y, double speed,
          const OrcaSettings& settings, double& vx, double& vy) {
    std::vector<Line> lines;
    for (const auto& [other, horizon] : others) {
        const V p{other.x - self.x, other.y - self.y};
        if (dot(p, p) <= settings.range * settings.range)
            lines.push_back(half_plane(self, other, horizon, settings.dt));
    }
    V found;
    const size_t kept = in_plane(lines, speed, {wanted_x, wanted_y}, false, found);
    if (kept < lines.size()) least_trespass(lines, kept, speed, found);
    vx = found.x, vy = found.y;
}

}  // namespace fgenv
