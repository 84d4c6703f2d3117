// Boxes that never change, packed into a tree of eights without pointers: box 8 j + k of a level is in
// lane k of block j above it. Answers: which boxes have lo <= s and hi >= t on every axis? With
// s = q.hi, t = q.lo those that meet q; with s = q.lo, t = q.hi those that hold q.
#pragma once

#include <vector>

#include "geometry.h"
#include "lanes.h"

namespace fgenv {

struct alignas(32) BoxBlock {
    float lo[3][8], hi[3][8];  // rounded outward; lo > hi in a spare lane
};

struct PackedBoxes {
    std::vector<int32_t> items;  // of the lowest level's lanes
    std::vector<std::vector<BoxBlock>> levels;  // the lowest first
};

static inline float rounded_down(double x) { return std::nextafterf(static_cast<float>(x), -HUGE_VALF); }
static inline float rounded_up(double x) { return std::nextafterf(static_cast<float>(x), HUGE_VALF); }

PackedBoxes pack_boxes(const std::vector<Box>& boxes);

// Walks the matches one by one.
struct BoxSearch {
    const PackedBoxes& boxes;
    float s[3], t[3];
    struct Entry {
        int32_t level, block;
        uint32_t lanes;
    };
    Entry stack[16];  // eight to the power of ten boxes and more
    int depth;
};

FGENV_INLINE uint32_t matching(const BoxSearch& search, int level, int block) {
    const BoxBlock& b = search.boxes.levels[level][block];
    I8 match = I8{} == 0;
    for (int i = 0; i < 3; ++i)
        match &= (load(b.lo[i]) <= splat(search.s[i])) & (load(b.hi[i]) >= splat(search.t[i]));
    return bits(match);
}

// s rounded up and t down, so that no match is lost to rounding.
FGENV_INLINE BoxSearch search_boxes(const PackedBoxes& boxes, Vec3 s, Vec3 t) {
    BoxSearch search{boxes, {}, {}, {}, 0};
    for (int i = 0; i < 3; ++i) {
        const float high = static_cast<float>(coordinate(s, i)), low = static_cast<float>(coordinate(t, i));
        search.s[i] = high + std::fabs(high) * 0x1p-23f;
        search.t[i] = low - std::fabs(low) * 0x1p-23f;
    }
    const int top = static_cast<int>(boxes.levels.size()) - 1;
    if (top >= 0) search.stack[search.depth++] = {top, 0, matching(search, top, 0)};
    return search;
}

// The next matching entry of a level (an item for 0, a block of level - 1 else), -1 when there is none.
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
        search.stack[search.depth++] = {level, child, matching(search, level, child)};
    }
    return -1;
}

// The next matching item, -1 when there is none left.
FGENV_INLINE int32_t next(BoxSearch& search) {
    const int32_t entry = next_of_level(search, 0);
    return entry < 0 ? -1 : search.boxes.items[entry];
}

}  // namespace fgenv
