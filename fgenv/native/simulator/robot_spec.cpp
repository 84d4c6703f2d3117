#include "simulator/robot_spec.h"

#include <cmath>

namespace fgenv {

double RobotSpec::distance(const double* from, const double* to) const {
    double squared = 0;
    for (int32_t k = 0; k < position_size(); ++k) {
        const double by = change(robot->coordinates[k], from[k], to[k]);
        squared += by * by;
    }
    return std::sqrt(squared);
}

}  // namespace fgenv
