// A dynamic spatial index of boxes: a packed tree with eight boxes per block. Updates refit the boxes; the
// tree is rebuilt when the boxes have grown too far.
#pragma once

#include "shape/packed_boxes.h"

namespace fgenv {

static inline bool overlap(const Box& a, const Box& b) {
    return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
           b.lo.z <= a.hi.z;
}
static inline bool holds(const Box& outer, const Box& inner) {
    return outer.lo.x <= inner.lo.x && inner.hi.x <= outer.hi.x && outer.lo.y <= inner.lo.y &&
           inner.hi.y <= outer.hi.y && outer.lo.z <= inner.lo.z && inner.hi.z <= outer.hi.z;
}
static inline Box widened(const Box& box, double by) {
    const Vec3 d{by, by, by};
    return {box.lo - d, box.hi + d};
}

class BoxIndex {
public:
    void set(int32_t item, const Box& box);  // adds or moves an item; items are small integers
    void remove(int32_t item);
    // Sets several boxes; refits each level once.
    void set_many(const std::vector<int32_t>& items, const std::vector<Box>& boxes);

    const PackedBoxes& packed() const { return packed_; }
    size_t size() const { return count_; }
    size_t nbytes() const;

    // Appends the items with boxes that overlap `box` to `out`, in no particular order.
    void overlapping(const Box& box, std::vector<int32_t>& out) const;

private:
    void place(int32_t slot, const Box& box);  // lowest level only
    void append(int32_t item);
    bool refit_block(size_t level, int32_t block);  // updates the level above; false if unchanged
    void refit_above(int32_t slot);
    void build();
    void wear(size_t changes);

    PackedBoxes packed_;
    std::vector<int32_t> slot_;   // by item, -1: none
    std::vector<int32_t> spare_;  // slots without an item
    std::vector<Box> boxes_;      // by item
    size_t count_ = 0, appended_ = 0, changes_ = 0;
    double fresh_size_ = 0;  // total width of the blocks when built
};

}  // namespace fgenv
