// Everything that moves is a kinematic tree: a base joint, then joints from link to link. Plain data and
// free functions; meters, radians.
#pragma once

#include <string>
#include <vector>

#include "math/quaternion.h"

namespace fgenv {

enum class JointKind : uint8_t { fixed, revolute, continuous, prismatic, planar, free };

// How many coordinates a joint has.
static inline int32_t size(JointKind kind) {
    return kind == JointKind::fixed ? 0 : kind == JointKind::planar ? 3 : kind == JointKind::free ? 7 : 1;
}

// Joint i carries link i. A link's frame is its parent's, then `origin`, then what the joint does:
// a turn about `axis`, a shift along it; planar (x, y, yaw), free (x, y, z, qx, qy, qz, qw) for the base.
struct Joint {
    JointKind kind = JointKind::fixed;
    int32_t parent = -1;  // link, before this one; -1: the world
    Rigid origin = identity();
    Vec3 axis{0, 0, 1};                 // unit
    int32_t first = 0;                  // of its coordinates
    double multiplier = 1, offset = 0;  // mimic: of the coordinate of another joint
};

// How a coordinate goes from one value to another: straight, by the shorter way around, or as one of the
// four of an orientation.
enum class Coordinate : uint8_t { linear, angle, rotation };

struct Robot {
    std::vector<Joint> joints;
    std::vector<Coordinate> coordinates;
    std::vector<std::string> names;  // of coordinates
    std::vector<double> most;        // what a coordinate may be, either way: enough for sines and positions

    int32_t n_links() const { return static_cast<int32_t>(joints.size()); }
    int32_t nq() const { return static_cast<int32_t>(coordinates.size()); }
};

// The whole change of a linear coordinate or an angle; an angle's is in [-pi, pi].
double change(Coordinate kind, double from, double to);
// At fraction t of the way; an angle comes out in [-pi, pi].
double between(Coordinate kind, double from, double to, double t);

// Where a joint carries its link from `at`, the joint's frame; `x`: its own coordinates.
Rigid carried(const Joint& joint, const Rigid& at, const double* x);

// The last link that carries both; a link carries itself.
int32_t common_link(const Robot& robot, int32_t a, int32_t b);
// q1 but for the coordinates that move nothing beyond `link` against it: those as in q0.
std::vector<double> held_up_to(const Robot& robot, int32_t link, const std::vector<double>& q0, std::vector<double> q1);

// Poses of all links in the world.
void forward(const Robot& robot, const double* q, Rigid* links);

// The configuration at fraction t of the way from q0 to q1, as OMPL's RealVector, SO2 and SO3 spaces.
void interpolate(const Robot& robot, const double* q0, const double* q1, double t, double* out);

// Meters that no point exceeds on that way: changes times weights (nq), a base's position and orientation
// taken as wholes.
double displacement_bound(const Robot& robot, const double* weights, const double* q0, const double* q1);

}  // namespace fgenv
