// Whether a part of one shape is inside a closed shell of another.
#pragma once

#include "query/box_culling.h"
#include "query/kernels.h"

namespace fgenv::FGENV_ISA {

int winding(const Shape& shape, Vec3 p, bool& touching);

// The bounds of a closed shell, by its place.
struct Solid {
    float lo[3], hi[3];
};

static inline Solid solid_at(const PackedBoxes& solids, int32_t place) {
    const BoxBlock& b = solids.levels[0][place / lanes];
    Solid out;
    for (int i = 0; i < 3; ++i) {
        out.lo[i] = b.lo[i][place % lanes];
        out.hi[i] = b.hi[i][place % lanes];
    }
    return out;
}

static inline BoxF box_of(const Solid& s) {
    BoxF box;
    for (int i = 0; i < 3; ++i) {
        box.c[i] = 0.5f * (s.lo[i] + s.hi[i]);
        box.h[i] = 0.5f * (s.hi[i] - s.lo[i]);
    }
    return box;
}

static inline BoxF point_box(Vec3 p) {
    return {{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, {0, 0, 0}};
}

static inline BoxSearch search_boxes(const PackedBoxes& boxes, const BoxF& box) {
    Solid around;
    for (int i = 0; i < 3; ++i) {
        around.lo[i] = box.c[i] - box.h[i];
        around.hi[i] = box.c[i] + box.h[i];
    }
    return search_boxes(boxes, around.lo, around.hi);
}

static inline bool holds(const Solid& solid, const Part& part, const Rigid& part_in_solid) {
    for (const Vec3& p : part) {
        const Vec3 at = apply(part_in_solid, p);
        for (int i = 0; i < 3; ++i)
            if (!(solid.lo[i] <= coordinate(at, i) && coordinate(at, i) <= solid.hi[i])) return false;
    }
    return true;
}

// A part of `inner` is inside `outer`, given that their surfaces do not meet: one of its points is, of
// those parts that are within the bounds of a closed shell.
static inline bool contained(const Shape& inner, const Shape& outer, const Rigid& inner_in_outer,
                             const PairFrame& inner_frame, const PairFrame& outer_frame, Vec3& point) {
    if (inner.smallest_part > 1.001 * outer.largest_solid) return false;
    const auto holds_part = [&](const Solid& solid, const Part& part) {
        if (!holds(solid, part, inner_in_outer)) return false;
        bool touching = false;
        point = part[0];
        return winding(outer, apply(inner_in_outer, point), touching) != 0 || touching;
    };
    if (inner.parts.size() > outer.solids.items.size()) {
        BoxSearch solids = search_boxes(outer.solids, posed(box_of(inner.tree, 0), inner_frame));
        for (int32_t place; (place = next(solids)) >= 0;) {
            const Solid solid = solid_at(outer.solids, place);
            BoxSearch anchors = search_boxes(inner.anchors, posed(box_of(solid), outer_frame));
            for (int32_t at; (at = next(anchors)) >= 0;)
                if (holds_part(solid, inner.parts[inner.anchors.items[at]])) return true;
        }
        return false;
    }
    BoxSearch anchors = search_boxes(inner.anchors, posed(box_of(outer.tree, 0), outer_frame));
    for (int32_t at; (at = next(anchors)) >= 0;) {
        const Part& part = inner.parts[inner.anchors.items[at]];
        BoxSearch solids = search_boxes(outer.solids, posed(point_box(part[0]), inner_frame));
        for (int32_t place; (place = next(solids)) >= 0;)
            if (holds_part(solid_at(outer.solids, place), part)) return true;
    }
    return false;
}

}  // namespace fgenv::FGENV_ISA
