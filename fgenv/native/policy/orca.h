// Optimal reciprocal collision avoidance of discs in the plane.
// J. van den Berg, S. J. Guy, M. Lin, D. Manocha, "Reciprocal n-body collision avoidance", 2011.
#pragma once

#include <cstdint>
#include <vector>

namespace fgenv {

struct Disc {
    double x, y;    // meters
    double vx, vy;  // m/s
    double radius;
    double share;  // of the avoiding that falls to whoever asks: 1/2, or 1 where this one rests
};

// Another one, and for how many seconds ahead the two shall not meet.
struct Neighbor {
    Disc disc;
    double horizon;
};

struct OrcaSettings {
    double horizon;  // of discs
    double dt;       // seconds of a step, in which discs that overlap shall part
    double range;    // meters between centers: who is farther away is not looked at
};

// Velocity of `self` that is nearest to what it wants, at most `speed`, and allowed by all others; where none
// is, the one whose worst trespass is least.
void orca(const Disc& self, const std::vector<Neighbor>& others, double wanted_x, double wanted_y, double speed,
          const OrcaSettings& settings, double& vx, double& vy);

}  // namespace fgenv
