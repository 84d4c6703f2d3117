// Points whose convex hull encloses a body, one of its shells or a face.
#pragma once

#include "shape/shape.h"

namespace fgenv {

struct Hull {
    const Vec3* points;    // in the frame of the shape
    const int32_t* which;  // indices; null for the first `count` points
    int32_t count;
    double radius;  // of the point farthest from the frame's origin

    const Vec3& operator[](int32_t i) const { return points[which ? which[i] : i]; }
};

}  // namespace fgenv
