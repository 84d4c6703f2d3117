#include "world/box_index.h"

#include <algorithm>
#include <limits>

namespace fgenv {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr double worn = 1.5;  // growth of the blocks since the build that triggers a rebuild

BoxBlock empty_block() {
    BoxBlock block;
    for (int axis = 0; axis < 3; ++axis) {
        std::fill(block.lo[axis], block.lo[axis] + 8, inf);
        std::fill(block.hi[axis], block.hi[axis] + 8, -inf);
    }
    return block;
}

void clear_lane(BoxBlock& block, int lane) {
    for (int axis = 0; axis < 3; ++axis) {
        block.lo[axis][lane] = inf;
        block.hi[axis][lane] = -inf;
    }
}

// Sum of the blocks' widths: a cheap estimate of the cost of a search.
double size_of_blocks(const std::vector<BoxBlock>& level) {
    double sum = 0;
    for (const BoxBlock& b : level)
        for (int axis = 0; axis < 3; ++axis) {
            float lo = inf, hi = -inf;
            for (int k = 0; k < 8; ++k) {
                lo = std::min(lo, b.lo[axis][k]);
                hi = std::max(hi, b.hi[axis][k]);
            }
            if (lo <= hi) sum += double(hi) - lo;
        }
    return sum;
}

}  // namespace

void BoxIndex::place(int32_t slot, const Box& box) {
    BoxBlock& block = packed_.levels[0][slot / 8];
    for (int axis = 0; axis < 3; ++axis) {
        block.lo[axis][slot % 8] = rounded_down(coordinate(box.lo, axis));
        block.hi[axis][slot % 8] = rounded_up(coordinate(box.hi, axis));
    }
}

void BoxIndex::append(int32_t item) {
    if (packed_.levels.empty()) packed_.levels.emplace_back();
    if (spare_.empty()) {
        const int32_t first = static_cast<int32_t>(packed_.items.size());
        packed_.items.resize(first + 8, -1);
        for (int32_t slot = first + 7; slot >= first; --slot) spare_.push_back(slot);
        packed_.levels[0].push_back(empty_block());
        for (size_t level = 1; packed_.levels[level - 1].size() > 1; ++level) {
            if (level == packed_.levels.size()) packed_.levels.emplace_back();
            if (8 * packed_.levels[level].size() >= packed_.levels[level - 1].size()) continue;
            packed_.levels[level].push_back(empty_block());
            if (packed_.levels[level].size() == 1)  // a new top level: starts with the extent of the old one
                refit_block(level - 1, 0);
        }
    }
    slot_[item] = spare_.back();
    packed_.items[slot_[item]] = item;
    spare_.pop_back();
    ++count_;
    ++appended_;
}

bool BoxIndex::refit_block(size_t level, int32_t block) {
    const BoxBlock& b = packed_.levels[level][block];
    BoxBlock& above = packed_.levels[level + 1][block / 8];
    bool changed = false;
    for (int axis = 0; axis < 3; ++axis) {
        float lo = b.lo[axis][0], hi = b.hi[axis][0];
        for (int k = 1; k < 8; ++k) {
            lo = std::min(lo, b.lo[axis][k]);
            hi = std::max(hi, b.hi[axis][k]);
        }
        changed |= above.lo[axis][block % 8] != lo || above.hi[axis][block % 8] != hi;
        above.lo[axis][block % 8] = lo;
        above.hi[axis][block % 8] = hi;
    }
    return changed;
}

void BoxIndex::refit_above(int32_t slot) {
    int32_t block = slot / 8;
    for (size_t level = 0; level + 1 < packed_.levels.size(); ++level, block /= 8)
        if (!refit_block(level, block)) return;
}

void BoxIndex::set(int32_t item, const Box& box) {
    if (item >= static_cast<int32_t>(slot_.size())) {
        slot_.resize(item + 1, -1);
        boxes_.resize(item + 1, empty_box());
    }
    if (slot_[item] < 0) append(item);
    boxes_[item] = box;
    place(slot_[item], box);
    refit_above(slot_[item]);
    wear(1);
}

void BoxIndex::set_many(const std::vector<int32_t>& items, const std::vector<Box>& boxes) {
    if (4 * items.size() < count_ || count_ == 0) {
        for (size_t i = 0; i < items.size(); ++i) set(items[i], boxes[i]);
        return;
    }
    for (size_t i = 0; i < items.size(); ++i) {
        const int32_t item = items[i];
        if (item >= static_cast<int32_t>(slot_.size()) || slot_[item] < 0) {
            set(item, boxes[i]);
            continue;
        }
        boxes_[item] = boxes[i];
        place(slot_[item], boxes[i]);
    }
    for (size_t level = 0; level + 1 < packed_.levels.size(); ++level)
        for (size_t block = 0; block < packed_.levels[level].size(); ++block)
            refit_block(level, static_cast<int32_t>(block));
    wear(items.size());
}

void BoxIndex::remove(int32_t item) {
    const int32_t slot = slot_[item];
    slot_[item] = -1;
    packed_.items[slot] = -1;
    clear_lane(packed_.levels[0][slot / 8], slot % 8);
    refit_above(slot);
    spare_.push_back(slot);
    --count_;
    wear(1);
}

// Checked rarely enough that its cost is negligible.
void BoxIndex::wear(size_t changes) {
    changes_ += changes;
    if (8 * changes_ < count_ + 64) return;
    changes_ = 0;
    const bool grown = 4 * appended_ > count_ + 64, shrunk = spare_.size() > count_ + 64;
    if (grown || shrunk || size_of_blocks(packed_.levels[0]) > worn * fresh_size_) build();
}

void BoxIndex::build() {
    std::vector<int32_t> items;
    std::vector<Box> boxes;
    for (size_t item = 0; item < slot_.size(); ++item)
        if (slot_[item] >= 0) {
            items.push_back(static_cast<int32_t>(item));
            boxes.push_back(boxes_[item]);
        }
    packed_ = pack_boxes(boxes);
    for (int32_t& i : packed_.items) i = items[i];
    spare_.clear();
    if (!packed_.levels.empty()) packed_.items.resize(8 * packed_.levels[0].size(), -1);
    for (size_t slot = 0; slot < packed_.items.size(); ++slot) {
        if (packed_.items[slot] >= 0)
            slot_[packed_.items[slot]] = static_cast<int32_t>(slot);
        else
            spare_.push_back(static_cast<int32_t>(slot));
    }
    appended_ = 0;
    fresh_size_ = packed_.levels.empty() ? 0 : size_of_blocks(packed_.levels[0]);
}

void BoxIndex::overlapping(const Box& box, std::vector<int32_t>& out) const {
    BoxSearch search = search_boxes(packed_, box);
    for (int32_t place; (place = next(search)) >= 0;) out.push_back(packed_.items[place]);
}

size_t BoxIndex::nbytes() const {
    size_t n = (packed_.items.capacity() + slot_.capacity() + spare_.capacity()) * sizeof(int32_t) +
               boxes_.capacity() * sizeof(Box);
    for (const auto& level : packed_.levels) n += level.capacity() * sizeof(BoxBlock);
    return n;
}

}  // namespace fgenv
