// A shape: an immutable mesh, its feature graph and its tree, built once and shared by every body.
#pragma once

#include <string>

#include "shape/packed_boxes.h"
#include "shape/tree.h"

namespace fgenv {

// A connected part of the surface (or, for a graph with a tolerance, of the feature graph), by six of
// its points: the extreme ones. If one of them is inside a solid and nothing crosses, all are.
using Part = std::array<Vec3, 6>;

// A shell's corners, [begin, end) of `Shape::corners`, and a ball around them.
struct Piece {
    Vec3 center;
    double radius;
    int32_t begin, end;
};

struct Shape {
    Mesh mesh;
    FeatureGraph graph;
    Tree tree;
    std::vector<Part> parts;
    PackedBoxes anchors;           // the first point of each part
    PackedBoxes solids;            // around each closed shell: where a part can be inside
    std::vector<int32_t> corners;  // vertices, shell by shell; empty where there are very many
    std::vector<Piece> pieces;     // one a shell, where a plane may part what none parts as a whole
    std::array<Vec3, 8> box;       // corners of an oriented box around it
    double radius = 0;             // of the farthest vertex from the origin of the shape's frame, meters
    double reach = 0;              // the largest coordinate, up to its sign
    double smallest_part = 0;      // a part is at least this long
    double largest_solid = 0;      // a closed shell is at most this long
    int32_t shells = 0;            // parts of the surface connected by edges
};

Shape build_shape(Mesh mesh, const GraphSettings& settings, const BuildMonitor& monitor = {});

size_t memory_bytes(const Shape& shape);

}  // namespace fgenv
