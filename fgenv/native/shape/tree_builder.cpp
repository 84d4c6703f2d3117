// Builds a binary tree by surface-area splits along the axes of the fitted box, then cuts it into nodes of
// eight with the least sum of areas (H. Ylitie et al., "Efficient incoherent ray traversal on GPUs through
// compressed wide BVHs", 2017, section 3.1).
#include "shape/tree.h"

#include <algorithm>
#include <limits>

#include "shape/oriented_box.h"
#include "shape/surface_area_split.h"

namespace fgenv {
namespace {

constexpr int halving_depth = max_depth - 40;  // from here on parts are at most half: 31 levels more

constexpr int32_t report_above = 4096;  // faces; smaller parts take under a millisecond

struct Range {
    int32_t first, count;
    Box upright;
    OrientedBox fitted;
};

class TreeBuilder {
public:
    TreeBuilder(const Mesh& mesh, const FeatureGraph& graph, const BuildMonitor& monitor, Tree& tree)
        : mesh_(mesh), monitor_(monitor), tree_(tree), items_(mesh.faces.size()), edge_bits_(mesh.faces.size(), 0) {
        for (size_t f = 0; f < items_.size(); ++f) items_[f].face = static_cast<int32_t>(f);
        // A kept edge is tested with either of its faces: the first pair of faces that meet decides.
        for (size_t i = 0; i < mesh.edges.size(); ++i) {
            const int expected = graph.kept[i] | graph.lossless[i] << 3;
            const Edge& e = mesh.edges[i];
            for (int32_t face : e.face) {
                if (!expected || face < 0) continue;
                const Face& f = mesh.faces[face];
                const int k = f[0] != e.a && f[0] != e.b ? 1 : f[1] != e.a && f[1] != e.b ? 2 : 0;
                edge_bits_[face] |= static_cast<uint8_t>(expected << k);
            }
        }
    }

    void build() {
        const Range all = fit(0, static_cast<int32_t>(items_.size()));
        push_node();
        set_lane(0, 0, all, add_wide(add_binary(all, 1)));
    }

private:
    Range fit(int32_t first, int32_t count) {
        Range range{first, count, empty_box(), {}};
        corners_.clear();
        for (int32_t i = first; i < first + count; ++i)
            for (int32_t v : mesh_.faces[items_[i].face]) {
                corners_.push_back(mesh_.vertices[v]);
                grow(range.upright, mesh_.vertices[v]);
            }
        range.fitted = fit_box(corners_, range.upright);
        return range;
    }

    int32_t push_node() {
        Node node{};
        Oriented oriented{};
        for (int axis = 0; axis < 3; ++axis) {
            std::fill(node.half[axis], node.half[axis] + lanes, -1e30f);
            std::fill(oriented.half[axis], oriented.half[axis] + lanes, -1e30f);
        }
        tree_.nodes.push_back(node);
        tree_.oriented.push_back(oriented);
        tree_.boxes.resize(lanes * tree_.nodes.size());
        return static_cast<int32_t>(tree_.nodes.size() - 1);
    }

    static float center_of(const Box& box, int axis) {
        return static_cast<float>(0.5 * (coordinate(box.lo, axis) + coordinate(box.hi, axis)));
    }

    static float half_of(const Box& box, int axis) {
        const float center = center_of(box, axis);
        const double half = std::max(coordinate(box.hi, axis) - center, center - coordinate(box.lo, axis));
        return std::nextafterf(static_cast<float>(half), std::numeric_limits<float>::infinity());
    }

    void set_lane(int32_t node, int lane, const Range& range, int32_t child) {
        Node& n = tree_.nodes[node];
        n.child[lane] = child;
        OrientedBox& box = tree_.boxes[lanes * node + lane];
        box = range.fitted;
        box.child = child;
        Oriented& o = tree_.oriented[node];
        for (int i = 0; i < 3; ++i) {
            n.center[i][lane] = center_of(range.upright, i);
            n.half[i][lane] = half_of(range.upright, i);
            o.center[i][lane] = box.center[i];
            o.half[i][lane] = box.half[i];
            for (int k = 0; k < 3 && i < 2; ++k) o.axis[i][k][lane] = box.axis[i][k];
        }
    }

    // Places the faces of a range in the frame of its box.
    void place_items(const Range& range) {
        const auto& axis = range.fitted.axis;
        for (int32_t i = range.first; i < range.first + range.count; ++i) {
            Item& item = items_[i];
            const Face& f = mesh_.faces[item.face];
            for (int k = 0; k < 3; ++k) {
                const Vec3 along{axis[k][0], axis[k][1], axis[k][2]};
                const float a = static_cast<float>(dot(along, mesh_.vertices[f[0]]));
                const float b = static_cast<float>(dot(along, mesh_.vertices[f[1]]));
                const float c = static_cast<float>(dot(along, mesh_.vertices[f[2]]));
                item.lo[k] = std::min({a, b, c});
                item.hi[k] = std::max({a, b, c});
                item.center[k] = 0.5f * (item.lo[k] + item.hi[k]);
            }
        }
    }

    // Two parts, the left one first in items_. Deep down the faces are simply halved, so that the
    // depth has a bound whatever the mesh is.
    std::pair<Range, Range> split(const Range& range, int depth) {
        place_items(range);
        Item* items = items_.data() + range.first;
        int32_t left = 0;
        if (depth < halving_depth) left = split_by_surface_area(items, range.count);
        if (left <= 0 || left >= range.count) left = range.count / 2;
        return {fit(range.first, left), fit(range.first + left, range.count - left)};
    }

    // A node of the binary tree. cost[i]: the least sum of areas of the wide nodes below, if the subtree
    // may take i + 1 lanes of the wide node above it; left_lanes[i]: how many of them go to the left
    // child then, 0 where it is best to take fewer.
    struct Binary {
        Range range;
        int32_t left = -1, right = -1;
        double cost[lanes] = {};
        int8_t left_lanes[lanes] = {};
    };

    int32_t add_binary(const Range& range, int depth) {
        const int32_t index = static_cast<int32_t>(binary_.size());
        binary_.push_back({range});
        if (range.count > report_above) report_placed();
        if (range.count <= lanes) {
            placed_ += range.count;
            return index;
        }
        const auto [a, b] = split(range, depth);
        const int32_t left = add_binary(a, depth + 1), right = add_binary(b, depth + 1);
        Binary& node = binary_[index];
        node.left = left;
        node.right = right;
        double best[lanes + 1];
        int8_t best_left[lanes + 1];
        for (int n = 2; n <= lanes; ++n) {
            best[n] = std::numeric_limits<double>::infinity();
            for (int8_t i = 1; i < n; ++i) {
                const double cost = binary_[left].cost[i - 1] + binary_[right].cost[n - i - 1];
                if (cost < best[n]) {
                    best[n] = cost;
                    best_left[n] = i;
                }
            }
        }
        node.cost[0] = area(range.fitted) + best[lanes];
        node.left_lanes[0] = best_left[lanes];
        for (int n = 2; n <= lanes; ++n) {
            const bool fewer = node.cost[n - 2] <= best[n];
            node.cost[n - 1] = fewer ? node.cost[n - 2] : best[n];
            node.left_lanes[n - 1] = fewer ? 0 : best_left[n];
        }
        return index;
    }

    void report_placed() const {
        const double share = static_cast<double>(placed_) / static_cast<double>(items_.size());
        report(monitor_, graph_share + (1 - graph_share) * share);
    }

    static double area(const OrientedBox& box) {
        const float* h = box.half;
        return h[0] * h[1] + h[1] * h[2] + h[2] * h[0];
    }

    // The binary nodes that take the `n` lanes of a wide node given to a subtree.
    void gather(int32_t index, int n, std::vector<int32_t>& children) const {
        const Binary& node = binary_[index];
        while (n > 1 && node.left >= 0 && node.left_lanes[n - 1] == 0) --n;
        if (n == 1 || node.left < 0) {
            children.push_back(index);
            return;
        }
        gather(node.left, node.left_lanes[n - 1], children);
        gather(node.right, n - node.left_lanes[n - 1], children);
    }

    int32_t add_wide(int32_t index) {
        if (binary_[index].left < 0) return add_leaf(binary_[index].range);
        std::vector<int32_t> children;
        gather(binary_[index].left, binary_[index].left_lanes[0], children);
        gather(binary_[index].right, lanes - binary_[index].left_lanes[0], children);
        const int32_t node = push_node();
        for (size_t i = 0; i < children.size(); ++i)
            set_lane(node, static_cast<int>(i), binary_[children[i]].range, add_wide(children[i]));
        return node;
    }

    int32_t add_leaf(const Range& range) {
        Leaf leaf{};
        leaf.valid = (1u << range.count) - 1;
        for (int axis = 0; axis < 3; ++axis) {
            leaf.center[axis] = center_of(range.upright, axis);
            leaf.half[axis] = half_of(range.upright, axis);
        }
        for (int lane = 0; lane < lanes; ++lane) {  // spare lanes repeat the last face
            const int32_t f = items_[range.first + std::min(lane, range.count - 1)].face;
            leaf.face[lane] = f;
            leaf.edges[lane] = edge_bits_[f];
            leaf.bounds[lane] = mesh_.closed[mesh_.shell[f]];
            for (int k = 0; k < 3; ++k) {
                leaf.vertex[k][lane] = mesh_.faces[f][k];
                for (int axis = 0; axis < 3; ++axis)
                    leaf.v[k][axis][lane] =
                        static_cast<float>(coordinate(mesh_.vertices[mesh_.faces[f][k]], axis) - leaf.center[axis]);
            }
        }
        tree_.leaves.push_back(leaf);
        return ~static_cast<int32_t>(tree_.leaves.size() - 1);
    }

    const Mesh& mesh_;
    const BuildMonitor& monitor_;
    Tree& tree_;
    int64_t placed_ = 0;  // faces in leaves
    std::vector<Item> items_;
    std::vector<Binary> binary_;
    std::vector<uint8_t> edge_bits_;
    std::vector<Vec3> corners_;  // of the faces at hand, three each
};

}  // namespace

Tree build_tree(const Mesh& mesh, const FeatureGraph& graph, const BuildMonitor& monitor) {
    Tree tree;
    TreeBuilder(mesh, graph, monitor, tree).build();
    return tree;
}

}  // namespace fgenv
