// A box around faces, in the frame of their principal axes where that is smaller than upright.
#pragma once

#include <vector>

#include "geometry.h"

namespace fgenv {

struct OrientedBox {
    float centre[3], half[3], axis[3][3];
};

// `corners`: three a face. The box holds every corner although it is rounded to floats.
OrientedBox fit_box(const std::vector<Vec3>& corners, const Box& upright);

}  // namespace fgenv
