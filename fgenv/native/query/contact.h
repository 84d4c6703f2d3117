// Contact point and separating direction of two posed shapes.
#pragma once

#include "query/kernels.h"

namespace fgenv {

struct ContactInfo {
    bool hit = false;
    Vec3 point{0, 0, 0}, normal{0, 0, 0};  // world; the normal points from b to a
    Vec3 edge[2];
    bool has_edge = false, edge_of_a = false;
    int32_t face = -1;
};

// Contact of two shapes, from the first witness that is found; `lossless` as for the kernel `collide`.
ContactInfo contact_of(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb, bool lossless);

// Points and vectors in a's frame.
static inline Nearest nearest_pair(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb) {
    return kernels().nearest(a, b, relative(ta, tb), HUGE_VAL, false);
}

}  // namespace fgenv
