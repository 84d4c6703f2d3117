// Feature points and feature graph of a mesh, by each of the methods of the public API.
#pragma once

#include "shape/mesh.h"

namespace fgenv {

enum class Method : uint8_t { loop, crease, exact, tolerance };
enum class Kind : uint8_t { valley, ridge, border, patch, chord };

struct GraphSettings {
    Method method = Method::exact;
    double valley = 0, ridge = 0;  // radians: thresholds on the dihedral angle (loop, crease)
    double tolerance = 0;          // meters (tolerance)
};

struct FeatureGraph {
    GraphSettings settings;
    std::vector<int32_t> points;                // vertices of the mesh
    std::vector<std::array<int32_t, 2>> edges;  // into points
    std::vector<Kind> kinds;                    // per edge
    std::vector<uint8_t> kept;                  // per edge of the mesh: it is in the graph
    std::vector<uint8_t> lossless;              // per edge of the mesh: it is in the exact graph
    double certificate = 0;                     // meters; infinite: no bound; NaN: none claimed
};

FeatureGraph build_graph(const Mesh& mesh, const GraphSettings& settings);

// Dihedral angle of an edge with two faces as published: pi - <n1, n2> along a valley, pi + <n1, n2>
// along a ridge (METHOD section 1); pi where the faces are coplanar.
double dihedral(const Mesh& mesh, const Edge& edge);

}  // namespace fgenv
