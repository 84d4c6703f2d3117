// A box around faces, in the frame of their principal axes where that is smaller than upright.
#pragma once

#include <vector>

#include "shape/tree.h"

namespace fgenv {

// `corners`: three a face. The box holds every corner although it is rounded to floats; no child yet.
OrientedBox fit_box(const std::vector<Vec3>& corners, const Box& upright);

}  // namespace fgenv
