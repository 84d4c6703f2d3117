// Binned surface-area splits (I. Wald, "On fast construction of SAH-based bounding volume
// hierarchies", 2007), then the binary tree's largest nodes are opened until eight hang side by side.
#include "tree.h"

#include "oriented_box.h"

#include <algorithm>
#include <limits>

namespace fgenv {
namespace {

constexpr int bins = 32;
constexpr int halving_depth = max_depth - 40;  // from here on parts are at most half: 31 levels more

struct Item {
    Box box;
    Vec3 centre;
    int32_t face;
};

struct Range {
    int32_t first, count;
    Box box;
};

Box bound(const std::vector<Item>& items, int32_t first, int32_t count) {
    Box box = empty_box();
    for (int32_t i = first; i < first + count; ++i) grow(box, items[i].box);
    return box;
}

// What a set of faces costs to test, in leaves: a half-filled leaf costs as much as a full one.
double leaf_count(int32_t faces) { return (faces + lanes - 1) / lanes; }

struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    int32_t left = 0;
};

// Every position of the faces sorted along an axis; the cheapest of the three axes.
Split sweep(std::vector<Item>& items, Range range) {
    Split best;
    std::vector<double> right_area(range.count);
    const auto begin = items.begin() + range.first, end = begin + range.count;
    for (int axis = 0; axis < 3; ++axis) {
        std::sort(begin, end, [axis](const Item& a, const Item& b) {
            const double ca = coordinate(a.centre, axis), cb = coordinate(b.centre, axis);
            return ca != cb ? ca < cb : a.face < b.face;
        });
        Box box = empty_box();
        for (int32_t i = range.count - 1; i > 0; --i) {
            grow(box, begin[i].box);
            right_area[i] = half_area(box);
        }
        box = empty_box();
        for (int32_t i = 1; i < range.count; ++i) {
            grow(box, begin[i - 1].box);
            const double cost = half_area(box) * leaf_count(i) +
                                right_area[i] * leaf_count(range.count - i);
            if (cost < best.cost) best = {cost, axis, i};
        }
    }
    if (best.axis != 2)
        std::sort(begin, end, [axis = best.axis](const Item& a, const Item& b) {
            const double ca = coordinate(a.centre, axis), cb = coordinate(b.centre, axis);
            return ca != cb ? ca < cb : a.face < b.face;
        });
    return best;
}

// The same at bin borders; 0 on the left if the centres coincide.
Split split_at_bins(std::vector<Item>& items, Range range) {
    Split best;
    Box centres = empty_box();
    for (int32_t i = range.first; i < range.first + range.count; ++i) grow(centres, items[i].centre);
    double best_border = 0, best_lo = 0, best_scale = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double lo = coordinate(centres.lo, axis);
        const double width = coordinate(centres.hi, axis) - lo;
        if (!(width > 0)) continue;
        const double scale = bins * (1 - 1e-9) / width;
        Box box[bins];
        int32_t count[bins] = {};
        std::fill(box, box + bins, empty_box());
        for (int32_t i = range.first; i < range.first + range.count; ++i) {
            const int b = static_cast<int>((coordinate(items[i].centre, axis) - lo) * scale);
            grow(box[b], items[i].box);
            ++count[b];
        }
        double right_area[bins];
        Box sum = empty_box();
        for (int b = bins - 1; b > 0; --b) {
            grow(sum, box[b]);
            right_area[b] = half_area(sum);
        }
        sum = empty_box();
        int32_t left = 0;
        for (int b = 1; b < bins; ++b) {
            grow(sum, box[b - 1]);
            left += count[b - 1];
            if (left == 0 || left == range.count) continue;
            const double cost =
                half_area(sum) * leaf_count(left) + right_area[b] * leaf_count(range.count - left);
            if (cost < best.cost) {
                best = {cost, axis, left};
                best_border = b;
                best_lo = lo;
                best_scale = scale;
            }
        }
    }
    if (best.left > 0)
        std::stable_partition(items.begin() + range.first, items.begin() + range.first + range.count,
                              [&](const Item& item) {
                                  return static_cast<int>((coordinate(item.centre, best.axis) - best_lo) *
                                                          best_scale) < best_border;
                              });
    return best;
}

class TreeBuilder {
public:
    TreeBuilder(const Mesh& mesh, const FeatureGraph& graph, Tree& tree)
        : mesh_(mesh), tree_(tree), items_(mesh.faces.size()), edge_bits_(mesh.faces.size(), 0) {
        for (size_t f = 0; f < items_.size(); ++f) {
            Item& item = items_[f];
            item.box = empty_box();
            for (int32_t v : mesh.faces[f]) grow(item.box, mesh.vertices[v]);
            item.centre = 0.5 * (item.box.lo + item.box.hi);
            item.face = static_cast<int32_t>(f);
        }
        // Each kept edge is tested with one of its faces: whatever it crosses, that face touches too.
        for (size_t i = 0; i < mesh.edges.size(); ++i) {
            if (!graph.kept[i]) continue;
            const Edge& e = mesh.edges[i];
            const Face& f = mesh.faces[e.face[0]];
            const int k = f[0] != e.a && f[0] != e.b ? 1 : f[1] != e.a && f[1] != e.b ? 2 : 0;
            edge_bits_[e.face[0]] |= static_cast<uint8_t>(1 << k);
        }
    }

    void build() {
        const int32_t n = static_cast<int32_t>(items_.size());
        const Range all{0, n, bound(items_, 0, n)};
        push_node();
        const int32_t child = n <= lanes ? add_leaf(all) : add_node(all, 1);
        set_lane(0, 0, all, child);
    }

private:
    int32_t push_node() {
        Node node{};
        Oriented oriented{};
        for (int axis = 0; axis < 3; ++axis) {
            std::fill(node.half[axis], node.half[axis] + lanes, -1e30f);
            std::fill(oriented.half[axis], oriented.half[axis] + lanes, -1e30f);
        }
        tree_.nodes.push_back(node);
        tree_.oriented.push_back(oriented);
        return static_cast<int32_t>(tree_.nodes.size() - 1);
    }

    static float centre_of(const Box& box, int axis) {
        return static_cast<float>(0.5 * (coordinate(box.lo, axis) + coordinate(box.hi, axis)));
    }

    void set_lane(int32_t node, int lane, const Range& range, int32_t child) {
        Node& n = tree_.nodes[node];
        const Box& box = range.box;
        for (int axis = 0; axis < 3; ++axis) {
            const double lo = coordinate(box.lo, axis), hi = coordinate(box.hi, axis);
            const float centre = centre_of(box, axis);
            const double half = std::max(hi - centre, centre - lo);
            n.centre[axis][lane] = centre;
            n.half[axis][lane] =
                std::nextafterf(static_cast<float>(half), std::numeric_limits<float>::infinity());
        }
        n.child[lane] = child;

        corners_.clear();
        for (int32_t i = range.first; i < range.first + range.count; ++i)
            for (int32_t v : mesh_.faces[items_[i].face]) corners_.push_back(mesh_.vertices[v]);
        const OrientedBox fitted = fit_box(corners_, box);
        Oriented& o = tree_.oriented[node];
        for (int i = 0; i < 3; ++i) {
            o.centre[i][lane] = fitted.centre[i];
            o.half[i][lane] = fitted.half[i];
            for (int k = 0; k < 3; ++k) o.axis[i][k][lane] = fitted.axis[i][k];
        }
    }

    // Two parts, the left one first in items_. Deep down the faces are simply halved, so that the
    // depth has a bound whatever the mesh is.
    std::pair<Range, Range> split(const Range& range, int depth) {
        int32_t left = 0;
        if (depth < halving_depth)
            left = range.count <= 256 ? sweep(items_, range).left : split_at_bins(items_, range).left;
        if (left <= 0 || left >= range.count) left = range.count / 2;
        const Range a{range.first, left, bound(items_, range.first, left)};
        const Range b{range.first + left, range.count - left,
                      bound(items_, range.first + left, range.count - left)};
        return {a, b};
    }

    int32_t add_node(const Range& range, int depth) {
        std::vector<Range> parts{range};
        while (parts.size() < lanes) {
            int widest = -1;
            for (size_t i = 0; i < parts.size(); ++i)
                if (parts[i].count > lanes &&
                    (widest < 0 || half_area(parts[i].box) > half_area(parts[widest].box)))
                    widest = static_cast<int>(i);
            if (widest < 0) break;
            const auto [a, b] = split(parts[widest], depth);
            parts[widest] = a;
            parts.push_back(b);
        }
        const int32_t index = push_node();
        for (size_t i = 0; i < parts.size(); ++i) {
            const int32_t child =
                parts[i].count <= lanes ? add_leaf(parts[i]) : add_node(parts[i], depth + 1);
            set_lane(index, static_cast<int>(i), parts[i], child);
        }
        return index;
    }

    int32_t add_leaf(const Range& range) {
        Leaf leaf{};
        leaf.valid = (1u << range.count) - 1;
        for (int axis = 0; axis < 3; ++axis) leaf.centre[axis] = centre_of(range.box, axis);
        for (int lane = 0; lane < lanes; ++lane) {  // spare lanes repeat the last face
            const int32_t f = items_[range.first + std::min(lane, range.count - 1)].face;
            leaf.face[lane] = f;
            leaf.edges[lane] = edge_bits_[f];
            leaf.bounds[lane] = mesh_.closed[mesh_.shell[f]];
            for (int k = 0; k < 3; ++k)
                for (int axis = 0; axis < 3; ++axis)
                    leaf.v[k][axis][lane] = static_cast<float>(
                        coordinate(mesh_.vertices[mesh_.faces[f][k]], axis) - leaf.centre[axis]);
        }
        tree_.leaves.push_back(leaf);
        return ~static_cast<int32_t>(tree_.leaves.size() - 1);
    }

    const Mesh& mesh_;
    Tree& tree_;
    std::vector<Item> items_;
    std::vector<uint8_t> edge_bits_;
    std::vector<Vec3> corners_;  // of the faces at hand, three each
};

}  // namespace

Tree build_tree(const Mesh& mesh, const FeatureGraph& graph) {
    Tree tree;
    TreeBuilder(mesh, graph, tree).build();
    return tree;
}

}  // namespace fgenv
