// The one tree of a shape: eight boxes a node, eight faces a leaf, lanes side by side. Boolean query,
// distance, ray and containment walk it. Boxes are floats, rounded so that none shrinks; vertices are
// floats relative to their leaf, so that their rounding errors are in proportion to the leaf and not to
// the mesh. Close cases are decided in double.
#pragma once

#include <vector>

#include "shape/feature_graph.h"

namespace fgenv {

constexpr int lanes = 8;
constexpr int max_depth = 64;  // of the wide tree; bounds the stack of every query

// A node or leaf by where its box is held: 8 * parent + lane.
using Ref = uint32_t;

struct alignas(32) Node {
    float center[3][lanes];
    float half[3][lanes];  // -1e30 in an empty lane: overlaps nothing
    int32_t child[lanes];  // node, or ~leaf
};

// A box in a frame of its own: thin where the surface is flat, whichever way it faces (S. Gottschalk et
// al., "OBBTree", 1996). For pairs of shapes; rays use the upright ones.
struct alignas(64) OrientedBox {
    float center[3], half[3];
    float axis[3][3];  // rows, orthonormal
    int32_t child;     // as in Node
};

// A node's eight, lanes side by side; half is -1e30 in an empty lane.
struct alignas(32) Oriented {
    float center[3][lanes], half[3][lanes];
    float axis[2][3][lanes];  // the third is their product
};

struct alignas(32) Leaf {
    float v[3][3][lanes];      // vertex, axis, lane; relative to the center of the leaf's box
    float center[3], half[3];  // upright box
    int32_t face[lanes];
    int32_t vertex[3][lanes];  // of the mesh
    uint32_t valid;            // bit a lane
    uint8_t edges[lanes];      // bit k: edge (k, k + 1) of the face is in the graph and tested here;
                               // bit 3 + k: it is in the exact graph
    uint8_t bounds[lanes];     // 1: the face belongs to a closed shell
};

struct Tree {
    std::vector<Node> nodes;         // nodes[0] holds the root in lane 0
    std::vector<Oriented> oriented;  // as nodes
    std::vector<OrientedBox> boxes;  // the same, by Ref
    std::vector<Leaf> leaves;
};

Tree build_tree(const Mesh& mesh, const FeatureGraph& graph, const BuildMonitor& monitor = {});

}  // namespace fgenv
