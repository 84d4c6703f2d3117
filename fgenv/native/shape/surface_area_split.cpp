#include "shape/surface_area_split.h"

#include <algorithm>
#include <limits>

namespace fgenv {
namespace {

constexpr int32_t sweep_limit = 64;  // faces; up to this many, every position is tried

// Cost of testing a set of faces, in leaves: a half-filled leaf has the cost of a full one.
double leaf_count(int32_t faces) { return (faces + lanes - 1) / lanes; }

struct Bounds {
    float lo[3] = {1e30f, 1e30f, 1e30f}, hi[3] = {-1e30f, -1e30f, -1e30f};
    void add(const float* l, const float* h) {
        for (int i = 0; i < 3; ++i) {
            lo[i] = l[i] < lo[i] ? l[i] : lo[i];
            hi[i] = h[i] > hi[i] ? h[i] : hi[i];
        }
    }
    double half_area() const {
        const double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
        return x * y + y * z + z * x;
    }
};

struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = -1;
    int32_t left = 0;  // faces on the left (sweep), or the first bin on the right
};

// The best position among the faces sorted along each axis; leaves them sorted along the best one.
Split split_at_faces(Item* items, int32_t count) {
    Split best;
    double right_area[sweep_limit];
    const auto sort_along = [&](int axis) {
        std::sort(items, items + count, [axis](const Item& a, const Item& b) {
            return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.face < b.face;
        });
    };
    for (int axis = 0; axis < 3; ++axis) {
        sort_along(axis);
        Bounds bounds;
        for (int32_t i = count - 1; i > 0; --i) {
            bounds.add(items[i].lo, items[i].hi);
            right_area[i] = bounds.half_area();
        }
        bounds = {};
        for (int32_t i = 1; i < count; ++i) {
            bounds.add(items[i - 1].lo, items[i - 1].hi);
            const double cost = bounds.half_area() * leaf_count(i) + right_area[i] * leaf_count(count - i);
            if (cost < best.cost) best = {cost, axis, i};
        }
    }
    if (best.axis >= 0 && best.axis != 2) sort_along(best.axis);
    return best;
}

constexpr int bins = 16;

struct Bin {
    Bounds bounds;
    int32_t count = 0;
};

// Bins of equal width along each axis between the outermost centers.
struct Binning {
    Bounds centers;
    float scale[3];
    Bin bin[3][bins];

    int bin_of(const Item& item, int axis) const {
        return static_cast<int>((item.center[axis] - centers.lo[axis]) * scale[axis]);
    }
};

void fill_bins(const Item* items, int32_t count, Binning& b) {
    for (int32_t i = 0; i < count; ++i) b.centers.add(items[i].center, items[i].center);
    for (int axis = 0; axis < 3; ++axis) {
        const float width = b.centers.hi[axis] - b.centers.lo[axis];
        b.scale[axis] = width > 1e-30f ? bins * 0.9999f / width : 0;
    }
    for (int32_t i = 0; i < count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = b.bin[axis][b.bin_of(items[i], axis)];
            bin.bounds.add(items[i].lo, items[i].hi);
            ++bin.count;
        }
}

void try_borders(const Bin (&bin)[bins], int axis, int32_t count, Split& best) {
    double right_area[bins];
    Bounds sum;
    for (int b = bins - 1; b > 0; --b) {
        sum.add(bin[b].bounds.lo, bin[b].bounds.hi);
        right_area[b] = sum.half_area();
    }
    sum = {};
    int32_t left = 0;
    for (int b = 1; b < bins; ++b) {
        sum.add(bin[b - 1].bounds.lo, bin[b - 1].bounds.hi);
        left += bin[b - 1].count;
        if (left == 0 || left == count) continue;
        const double cost = sum.half_area() * leaf_count(left) + right_area[b] * leaf_count(count - left);
        if (cost < best.cost) best = {cost, axis, b};
    }
}

// The best border between bins; reorders the faces so that the left part comes first.
Split split_at_bins(Item* items, int32_t count) {
    Binning b;
    fill_bins(items, count, b);
    Split best;
    for (int axis = 0; axis < 3; ++axis) try_borders(b.bin[axis], axis, count, best);
    if (best.axis < 0) return best;
    Item* middle = std::stable_partition(items, items + count,
                                         [&](const Item& item) { return b.bin_of(item, best.axis) < best.left; });
    best.left = static_cast<int32_t>(middle - items);
    return best;
}

}  // namespace

int32_t split_by_surface_area(Item* items, int32_t count) {
    return (count <= sweep_limit ? split_at_faces(items, count) : split_at_bins(items, count)).left;
}

}  // namespace fgenv
