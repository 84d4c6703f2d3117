// Whether a part of one shape is inside a closed shell of another.
#pragma once

#include "box_culling.h"
#include "kernels.h"

namespace fgenv::FGENV_ISA {

int winding(const Shape& shape, Vec3 p, bool& touching);

static inline bool is_any_around(const PackedBoxes& boxes, const Box& inner) {
    BoxSearch search = search_boxes(boxes, inner.lo, inner.hi);
    return next(search) >= 0;
}

// A part of `inner` is inside `outer`, given that their surfaces do not meet. Asked are the parts whose
// first point is within outer's bounds, if all their points are within the bounds of one closed shell.
static inline bool contained(const Shape& inner, const Shape& outer, const Rigid& inner_in_outer,
               const PairFrame& outer_frame, Vec3& point) {
    if (inner.smallest_part > 1.001 * outer.largest_solid) return false;
    const BoxF around = placed(box_of(outer.tree, 0), outer_frame);
    const Vec3 lo{around.c[0] - around.h[0], around.c[1] - around.h[1], around.c[2] - around.h[2]};
    const Vec3 hi{around.c[0] + around.h[0], around.c[1] + around.h[1], around.c[2] + around.h[2]};
    BoxSearch near = search_boxes(inner.anchors, hi, lo);
    for (int32_t index; (index = next(near)) >= 0;) {
        const Vec3 first = apply(inner_in_outer, inner.parts[index][0]);
        if (!is_any_around(outer.solids, {first, first})) continue;
        Box part{first, first};
        for (const Vec3& p : inner.parts[index]) grow(part, apply(inner_in_outer, p));
        if (!is_any_around(outer.solids, part)) continue;
        bool touching = false;
        point = inner.parts[index][0];
        if (winding(outer, first, touching) != 0 || touching) return true;
    }
    return false;
}

}  // namespace fgenv::FGENV_ISA
