// Heights of the boxes of two trees along one direction, in double: bounds on distances to within rounding.
#pragma once

#include "math/lanes.h"
#include "shape/shape.h"

namespace fgenv {

struct TreeHeights {
    const Shape &a, &b;
    Rigid pose;            // of b in a's frame
    double rounding;       // meters; bound on the error of a difference of heights
    double *top, *bottom;  // highest of each box of a, lowest of each box of b, by Ref
};

// Whether no faces of two boxes are nearer than the root of `squared`, by more than the rounding of coordinates.
FGENV_INLINE bool apart(const TreeHeights& h, Ref box_a, Ref box_b, double squared) {
    const double gap = h.bottom[box_b] - h.top[box_a] + h.rounding;
    return gap > 0 && gap * gap >= squared;
}

// Functions of their own file: kernels must not instantiate containers.
TreeHeights* new_heights(const Shape& a, const Shape& b, const Rigid& pose);
// Along a unit vector in a's frame, from a to b, or along the direction between the hulls if they are apart farther.
void measure(TreeHeights& heights, Vec3 normal);
void free_heights(TreeHeights* heights);

}  // namespace fgenv
