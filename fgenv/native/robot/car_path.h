// Shortest paths of a car with a turning radius of 1, from the origin, heading along x.
#pragma once

#include <cmath>
#include <vector>

#include "math/constants.h"
#include "math/trig.h"

namespace fgenv {

// A segment of a car's path: an arc to the left (turn 1) or to the right (-1), or a straight line (0).
struct PathSegment {
    int turn;
    double length;  // in radii; negative: backward
};
using CarPath = std::vector<PathSegment>;

// The shortest path to (x, y), in radii, with a heading `yaw`: L. Dubins, "On curves of minimal length", 1957.
CarPath dubins(double x, double y, double yaw);
// In both directions: J. Reeds and L. Shepp, "Optimal paths for a car that goes both forwards and backwards", 1990.
CarPath reeds_shepp(double x, double y, double yaw);

// Shared by both: all words, which are sequences of arcs and lines, are tried; lengths have closed forms.

constexpr double path_slack = 1e-9;  // radians or radii, for rounding

struct SineCosine {
    double s, c;
    explicit SineCosine(double angle) { sin_cos(angle, s, c); }
};

double arc_cosine(double x);
double wrapped_positive(double angle);   // to [0, 2 pi)
double wrapped_symmetric(double angle);  // to (-pi, pi]

// The shortest of the paths offered to it.
class ShortestPath {
public:
    void offer(const CarPath& path);
    CarPath take();  // without segments of length 0

private:
    double length_ = HUGE_VAL;
    CarPath path_;
};

}  // namespace fgenv
