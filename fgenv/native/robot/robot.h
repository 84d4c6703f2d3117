// Kinematic trees: a base joint, then joints from link to link. Plain data and free functions; meters,
// radians.
#pragma once

#include <string>
#include <vector>

#include "math/quaternion.h"

namespace fgenv {

enum class JointKind : uint8_t { fixed, revolute, continuous, prismatic, planar, free };

// Number of coordinates of a joint.
static inline int32_t size(JointKind kind) {
    return kind == JointKind::fixed ? 0 : kind == JointKind::planar ? 3 : kind == JointKind::free ? 7 : 1;
}

// Joint i carries link i. A link's frame is its parent's, then `origin`, then the joint's transform:
// a turn about `axis` or a shift along it; planar (x, y, yaw) or free (x, y, z, qx, qy, qz, qw) for the base.
struct Joint {
    JointKind kind = JointKind::fixed;
    int32_t parent = -1;  // link, before this one; -1: the world
    Rigid origin = identity();
    Vec3 axis{0, 0, 1};                 // unit
    int32_t first = 0;                  // index of its first coordinate
    double multiplier = 1, offset = 0;  // mimic: applied to the coordinate of another joint
};

// Interpolation of a coordinate: linear, by the shorter way around, or as one of the four of a
// quaternion.
enum class Coordinate : uint8_t { linear, angle, rotation };

struct Robot {
    std::vector<Joint> joints;
    std::vector<Coordinate> coordinates;
    std::vector<std::string> names;  // of coordinates
    std::vector<double> most;        // bound of a coordinate's magnitude, valid for sines and positions

    int32_t n_links() const { return static_cast<int32_t>(joints.size()); }
    int32_t nq() const { return static_cast<int32_t>(coordinates.size()); }
};

// Change of a linear coordinate or an angle; that of an angle is in [-pi, pi].
double change(Coordinate kind, double from, double to);
// The value at fraction t of the way; an angle is in [-pi, pi].
double between(Coordinate kind, double from, double to, double t);

// Frame of a joint's link, from the joint's frame `at` and its coordinates `x`.
Rigid carried(const Joint& joint, const Rigid& at, const double* x);

// The last common ancestor of two links; a link is its own ancestor.
int32_t common_link(const Robot& robot, int32_t a, int32_t b);
// q1, with the coordinates that do not move any link relative to `link` as in q0.
std::vector<double> held_up_to(const Robot& robot, int32_t link, const std::vector<double>& q0, std::vector<double> q1);

// Poses of all links in the world.
void forward(const Robot& robot, const double* q, Rigid* links);

// The configuration at fraction t of the way from q0 to q1, as OMPL's RealVector, SO2 and SO3 spaces.
void interpolate(const Robot& robot, const double* q0, const double* q1, double t, double* out);

// Upper bound of the path length of any point on that motion, meters: changes times weights (nq), with a
// base's position and orientation as wholes.
double displacement_bound(const Robot& robot, const double* weights, const double* q0, const double* q1);

}  // namespace fgenv
