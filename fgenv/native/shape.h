// A shape: an immutable mesh, its feature graph and its tree, built once and shared by every body.
#pragma once

#include <string>

#include "tree.h"

namespace fgenv {

// A connected part of the surface (or, for a graph with a tolerance, of the feature graph), by six of
// its points: the extreme ones. If one of them is inside a solid and nothing crosses, all are.
using Part = std::array<Vec3, 6>;

struct Shape {
    Mesh mesh;
    FeatureGraph graph;
    Tree tree;
    std::vector<Part> parts;
    bool solid = false;  // has a closed shell: other bodies can be inside it
    double radius = 0;   // of the farthest vertex from the origin of the shape's frame, metres
};

Shape build_shape(Mesh mesh, const GraphSettings& settings);

size_t memory_bytes(const Shape& shape);

}  // namespace fgenv
