#include "shape/packed_boxes.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace fgenv {
namespace {

// Halves at multiples of eight, eight times eight and so on, along the widest axis, until eight are
// left: neighbors in space become neighbors in order.
void order(const std::vector<Box>& boxes, std::vector<int32_t>& items, size_t first, size_t count) {
    if (count <= 8) return;
    Box centers = empty_box();
    for (size_t i = first; i < first + count; ++i) grow(centers, 0.5 * (boxes[items[i]].lo + boxes[items[i]].hi));
    const Vec3 width = centers.hi - centers.lo;
    const int axis = width.x >= width.y && width.x >= width.z ? 0 : width.y >= width.z ? 1 : 2;
    size_t unit = 8;
    while (8 * unit < count) unit *= 8;
    const size_t left = std::max<size_t>(1, (count + unit - 1) / unit / 2) * unit;
    const auto begin = items.begin() + static_cast<std::ptrdiff_t>(first);
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(left), begin + static_cast<std::ptrdiff_t>(count),
                     [&](int32_t a, int32_t b) {
                         const double ca = coordinate(boxes[a].lo, axis) + coordinate(boxes[a].hi, axis);
                         const double cb = coordinate(boxes[b].lo, axis) + coordinate(boxes[b].hi, axis);
                         return ca != cb ? ca < cb : a < b;
                     });
    order(boxes, items, first, left);
    order(boxes, items, first + left, count - left);
}

std::vector<BoxBlock> block_level(const std::vector<Box>& boxes) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    std::vector<BoxBlock> level((boxes.size() + 7) / 8);
    for (BoxBlock& b : level)
        for (int axis = 0; axis < 3; ++axis) {
            std::fill(b.lo[axis], b.lo[axis] + 8, inf);
            std::fill(b.hi[axis], b.hi[axis] + 8, -inf);
        }
    for (size_t i = 0; i < boxes.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            level[i / 8].lo[axis][i % 8] = rounded_down(coordinate(boxes[i].lo, axis));
            level[i / 8].hi[axis][i % 8] = rounded_up(coordinate(boxes[i].hi, axis));
        }
    return level;
}

}  // namespace

PackedBoxes pack_boxes(const std::vector<Box>& boxes) {
    PackedBoxes packed;
    if (boxes.empty()) return packed;
    packed.items.resize(boxes.size());
    std::iota(packed.items.begin(), packed.items.end(), 0);
    order(boxes, packed.items, 0, boxes.size());
    std::vector<Box> level;
    for (int32_t i : packed.items) level.push_back(boxes[i]);
    while (true) {
        packed.levels.push_back(block_level(level));
        if (level.size() <= 8) return packed;
        std::vector<Box> above((level.size() + 7) / 8, empty_box());
        for (size_t i = 0; i < level.size(); ++i) grow(above[i / 8], level[i]);
        level = std::move(above);
    }
}

}  // namespace fgenv
