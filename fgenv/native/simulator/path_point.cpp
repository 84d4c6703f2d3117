#include "simulator/path_point.h"

namespace fgenv {
namespace {

struct PathPosition {
    size_t leg = 0;
    double fraction = 0;  // of the leg
};

double difference(const RobotSpec& spec, const double* from, const double* to, int32_t k) {
    return change(spec.robot->coordinates[k], from[k], to[k]);
}

double length(const RobotSpec& spec, const double* from, const double* to) {
    double squared = 0;
    for (int32_t k = 0; k < spec.position_size(); ++k) squared += std::pow(difference(spec, from, to, k), 2);
    return std::sqrt(squared);
}

// The point of a leg nearest to q; returns the squared distance to it.
double project(const RobotSpec& spec, const double* from, const double* to, const double* q, double& fraction) {
    double along = 0, squared = 0, distance = 0;
    for (int32_t k = 0; k < spec.position_size(); ++k) {
        const double d = difference(spec, from, to, k);
        along += d * difference(spec, from, q, k);
        squared += d * d;
    }
    fraction = squared > 0 ? lesser(greater(along / squared, 0), 1) : 0;
    for (int32_t k = 0; k < spec.position_size(); ++k)
        distance += std::pow(difference(spec, from, q, k) - fraction * difference(spec, from, to, k), 2);
    return distance;
}

// Of two equally near legs the later one.
PathPosition nearest_position(const RobotSpec& spec, const Waypoints& path, const double* q) {
    PathPosition nearest;
    double least = HUGE_VAL;
    for (size_t leg = 0; leg + 1 < path.size(); ++leg) {
        double fraction;
        const double distance = project(spec, path[leg].data(), path[leg + 1].data(), q, fraction);
        if (distance > least) continue;
        least = distance;
        nearest = {leg, fraction};
    }
    return nearest;
}

}  // namespace

std::vector<double> point_ahead(const RobotSpec& spec, const Waypoints& path, const double* q, double look_ahead) {
    double rest = look_ahead;
    for (PathPosition at = nearest_position(spec, path, q); at.leg + 1 < path.size(); ++at.leg, at.fraction = 0) {
        const double *from = path[at.leg].data(), *to = path[at.leg + 1].data(), whole = length(spec, from, to);
        if (rest <= (1 - at.fraction) * whole && whole > 0) {
            std::vector<double> out(spec.robot->nq());
            interpolate(*spec.robot, from, to, at.fraction + rest / whole, out.data());
            return out;
        }
        rest -= (1 - at.fraction) * whole;
    }
    return path.back();
}

}  // namespace fgenv
