// A mesh as the queries need it: shared vertices, faces with area, consistent winding, its edges.
#pragma once

#include <vector>

#include "math/geometry.h"
#include "shape/build_monitor.h"

namespace fgenv {

// At most two faces are stored; `faces_around` counts all.
struct Edge {
    int32_t a, b;     // vertices, a < b
    int32_t face[2];  // the first two faces around it, face[1] = -1 on a border
    int32_t faces_around;
    bool opposed;  // exactly two faces, and they run along the edge in opposite directions
};

// Changes made while reading the mesh.
struct Repairs {
    int64_t merged_vertices = 0;
    int64_t unused_vertices = 0;
    int64_t degenerate_faces = 0;  // zero area, or a vertex twice
    int64_t duplicate_faces = 0;   // same vertices, same turn
    int64_t flipped_faces = 0;     // wound against their neighbors
};

struct Mesh {
    std::vector<Vec3> vertices;
    std::vector<Face> faces;
    std::vector<Edge> edges;
    std::vector<int32_t> shell;   // per face: edge-connected component
    std::vector<uint8_t> closed;  // per shell: it bounds a volume
    bool watertight = false;      // every shell is closed
    Box bounds = empty_box();
    Repairs repairs;
    std::vector<Triangle> flat;  // the dropped faces of zero area that may close T-junctions
};

// Indices must be in range and coordinates finite.
Mesh read_mesh(std::vector<Vec3> vertices, std::vector<Face> faces, const BuildMonitor& monitor = {});

static inline Triangle triangle(const Mesh& mesh, int32_t face) {
    const Face& f = mesh.faces[face];
    return {mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
}

// Not normalized; length is twice the area.
static inline Vec3 area_vector(const Mesh& mesh, int32_t face) {
    const Face& f = mesh.faces[face];
    const Vec3 o = mesh.vertices[f[0]];
    return cross(mesh.vertices[f[1]] - o, mesh.vertices[f[2]] - o);
}

static inline int32_t opposite_vertex(const Face& f, const Edge& e) {
    for (int32_t v : f)
        if (v != e.a && v != e.b) return v;
    return -1;
}

}  // namespace fgenv
