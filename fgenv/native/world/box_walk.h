// Walk over a packed tree of boxes in ascending order of keys, up to a bound that the visitor may lower.
#pragma once

#include "shape/packed_boxes.h"

namespace fgenv {

// key(block) returns eight keys; infinity skips a lane. visit(item) may lower `bound`.
template <class Key, class Visit>
static inline void walk_nearest(const PackedBoxes& boxes, const float& bound, const Key& key, const Visit& visit) {
    struct Entry {
        float key;
        int32_t level, index;  // a block, or an item where level is -1
    };
    Entry stack[16 * 8];
    int top = 0;
    if (boxes.levels.empty()) return;
    stack[top++] = {0, static_cast<int32_t>(boxes.levels.size()) - 1, 0};
    while (top) {
        const Entry e = stack[--top];
        if (e.key > bound) continue;
        if (e.level < 0) {
            visit(boxes.items[e.index]);
            continue;
        }
        const F8 keys = key(boxes.levels[e.level][e.index]);
        const int first = top;
        for (uint32_t m = bits((keys <= splat(bound)) & (keys < splat(HUGE_VALF))); m; m &= m - 1) {
            const int k = __builtin_ctz(m);
            const Entry next{keys[k], e.level - 1, 8 * e.index + k};
            int at = top++;
            for (; at > first && stack[at - 1].key < next.key; --at) stack[at] = stack[at - 1];
            stack[at] = next;
        }
    }
}

// Squared gaps between a box and eight boxes, rounded down.
FGENV_INLINE F8 squared_gaps(const BoxBlock& b, const float lo[3], const float hi[3]) {
    F8 sum = F8{};
    for (int i = 0; i < 3; ++i) {
        const F8 gap = max(max(load(b.lo[i]) - splat(hi[i]), splat(lo[i]) - load(b.hi[i])), F8{});
        sum += gap * gap;
    }
    return load(b.lo[0]) <= load(b.hi[0]) ? sum * splat(0.99999f) : splat(HUGE_VALF);
}

// Distances at which a ray enters eight boxes, rounded down; infinite for a miss or a distance above `reach`.
FGENV_INLINE F8 ray_entries(const BoxBlock& b, const float o[3], const float inv[3], float reach) {
    F8 near = F8{}, far = splat(reach);
    for (int i = 0; i < 3; ++i) {
        const F8 a = (load(b.lo[i]) - splat(o[i])) * splat(inv[i]), c = (load(b.hi[i]) - splat(o[i])) * splat(inv[i]);
        const F8 slack =
            (abs(load(b.lo[i])) + abs(load(b.hi[i])) + abs(splat(o[i]))) * splat(std::fabs(inv[i]) * 0x1p-21f);
        near = max(near, min(a, c) - slack);
        far = min(far, max(a, c) + slack);
    }
    const I8 hit = (near <= far) & (load(b.lo[0]) <= load(b.hi[0]));
    return hit ? near : splat(HUGE_VALF);
}

}  // namespace fgenv
