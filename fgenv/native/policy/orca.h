// Optimal reciprocal collision avoidance of discs in the plane.
// J. van den Berg, S. J. Guy, M. Lin, D. Manocha, "Reciprocal n-body collision avoidance", 2011.
#pragma once

#include <vector>

namespace fgenv {

struct Vec2 {
    double x, y;
};

struct Disc {
    Vec2 position;  // meters
    Vec2 velocity;  // m/s
    double radius;
    double responsibility;  // share of the avoidance that other discs take: 1/2, or 1 if this disc rests
};

struct Neighbor {
    Disc disc;
    double horizon;  // seconds without a collision
};

struct OrcaSettings {
    double dt;     // seconds in which overlapping discs part
    double range;  // meters between centers; neighbors beyond it are ignored
};

// The velocity nearest to `preferred`, at most `max_speed`, that avoids all neighbors. If there is none, the velocity
// with the least violation of the worst constraint.
Vec2 orca_velocity(const Disc& self, const std::vector<Neighbor>& neighbors, Vec2 preferred, double max_speed,
                   const OrcaSettings& settings);

}  // namespace fgenv
