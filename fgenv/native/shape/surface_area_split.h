// The split of a set of faces that is cheapest by surface area (I. Wald, "On fast construction of SAH-based
// bounding volume hierarchies", 2007).
#pragma once

#include "shape/tree.h"

namespace fgenv {

// A face as a split sees it: its box in the frame of the range's fitted box.
struct Item {
    float lo[3], hi[3], center[3];
    int32_t face;
};

// Faces on the left of the best split, which come first in `items` then; 0 where none is found.
int32_t split_by_surface_area(Item* items, int32_t count);

}  // namespace fgenv
