// Boxes that never change, packed into a tree of eights without pointers: box 8 j + k of a level is in
// lane k of block j above it. Answers: which of them meet a given box?
#pragma once

#include <vector>

#include "math/geometry.h"
#include "math/lanes.h"

namespace fgenv {

struct alignas(32) BoxBlock {
    float lo[3][8], hi[3][8];  // rounded outward; lo > hi in a spare lane
};

struct PackedBoxes {
    std::vector<int32_t> items;                 // of the lowest level's lanes
    std::vector<std::vector<BoxBlock>> levels;  // the lowest first
};

// Beyond x by at least one unit in the last place, without a call into the C library.
static inline float rounded_down(double x) {
    const float f = static_cast<float>(x);
    return f - (std::fabs(f) * 0x1p-23f + 0x1p-126f);
}
static inline float rounded_up(double x) {
    const float f = static_cast<float>(x);
    return f + (std::fabs(f) * 0x1p-23f + 0x1p-126f);
}

PackedBoxes pack_boxes(const std::vector<Box>& boxes);

// Walks the boxes that meet lo to hi one by one.
struct BoxSearch {
    const PackedBoxes& boxes;
    float lo[3], hi[3];
    struct Entry {
        int32_t level, block;
        uint32_t lanes;
    };
    Entry stack[16];  // eight to the power of ten boxes and more
    int depth;
};

FGENV_INLINE uint32_t overlapping(const BoxSearch& search, int level, int block) {
    const BoxBlock& b = search.boxes.levels[level][block];
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i) meet &= (load(b.lo[i]) <= splat(search.hi[i])) & (load(b.hi[i]) >= splat(search.lo[i]));
    return bits(meet);
}

FGENV_INLINE BoxSearch search_boxes(const PackedBoxes& boxes, const float lo[3], const float hi[3]) {
    BoxSearch search{boxes, {lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}, {}, 0};
    const int top = static_cast<int>(boxes.levels.size()) - 1;
    if (top >= 0) search.stack[search.depth++] = {top, 0, overlapping(search, top, 0)};
    return search;
}

FGENV_INLINE BoxSearch search_boxes(const PackedBoxes& boxes, const Box& box) {
    const float lo[3] = {rounded_down(box.lo.x), rounded_down(box.lo.y), rounded_down(box.lo.z)};
    const float hi[3] = {rounded_up(box.hi.x), rounded_up(box.hi.y), rounded_up(box.hi.z)};
    return search_boxes(boxes, lo, hi);
}

// The next place on a level that meets (a box for 0, a block of level - 1 else), -1 when there is none.
FGENV_INLINE int32_t next_of_level(BoxSearch& search, int level_wanted) {
    while (search.depth) {
        BoxSearch::Entry& e = search.stack[search.depth - 1];
        if (!e.lanes) {
            --search.depth;
            continue;
        }
        const int32_t child = 8 * e.block + __builtin_ctz(e.lanes);
        e.lanes &= e.lanes - 1;
        if (e.level == level_wanted) return child;
        const int32_t level = e.level - 1;
        search.stack[search.depth++] = {level, child, overlapping(search, level, child)};
    }
    return -1;
}

// The place of the next box on the lowest level, -1 when there is none left.
FGENV_INLINE int32_t next(BoxSearch& search) { return next_of_level(search, 0); }

}  // namespace fgenv
