#include "shape/shape.h"

#include <algorithm>
#include <limits>

#include "math/disjoint_sets.h"

namespace fgenv {
namespace {

// Component of each vertex: of the surface, or of the feature graph where that keeps only a part of
// the edges (a bump of one patch may stick out of a solid that holds the rest).
std::vector<int32_t> vertex_components(const Mesh& mesh, const FeatureGraph& graph, int32_t& count) {
    DisjointSets surface(mesh.vertices.size()), kept(mesh.vertices.size());
    for (size_t i = 0; i < mesh.edges.size(); ++i) {
        surface.join(mesh.edges[i].a, mesh.edges[i].b);
        if (graph.kept[i]) kept.join(mesh.edges[i].a, mesh.edges[i].b);
    }
    std::vector<int32_t> label;
    if (graph.settings.method == Method::exact) {
        count = surface.label(label);
        return label;
    }
    std::vector<uint8_t> on_graph(mesh.vertices.size(), 0), has_graph(mesh.vertices.size(), 0);
    for (int32_t v : graph.points) on_graph[v] = has_graph[surface.root(v)] = 1;
    count = kept.label(label);
    for (size_t v = 0; v < label.size(); ++v)  // a surface without a feature is asked at one vertex
        if (!on_graph[v] && (has_graph[surface.root(static_cast<int32_t>(v))] ||
                             surface.root(static_cast<int32_t>(v)) != static_cast<int32_t>(v)))
            label[v] = -1;
    return label;
}

std::vector<Part> find_parts(const Mesh& mesh, const FeatureGraph& graph) {
    int32_t count = 0;
    const std::vector<int32_t> label = vertex_components(mesh, graph, count);
    std::vector<Part> parts(count);
    std::vector<uint8_t> seen(count, 0);
    for (size_t v = 0; v < label.size(); ++v) {
        if (label[v] < 0) continue;
        Part& part = parts[label[v]];
        const Vec3 p = mesh.vertices[v];
        if (!seen[label[v]]) part.fill(p);
        seen[label[v]] = 1;
        for (int axis = 0; axis < 3; ++axis) {
            if (coordinate(p, axis) < coordinate(part[2 * axis], axis)) part[2 * axis] = p;
            if (coordinate(p, axis) > coordinate(part[2 * axis + 1], axis)) part[2 * axis + 1] = p;
        }
    }
    size_t n = 0;
    for (size_t i = 0; i < parts.size(); ++i)
        if (seen[i]) parts[n++] = parts[i];
    parts.resize(n);
    return parts;
}

PackedBoxes find_anchors(const std::vector<Part>& parts) {
    std::vector<Box> points;
    for (const Part& part : parts) points.push_back({part[0], part[0]});
    return pack_boxes(points);
}

PackedBoxes find_solids(const Mesh& mesh, double& longest) {
    std::vector<Box> shells(mesh.closed.size(), empty_box()), solids;
    for (size_t f = 0; f < mesh.faces.size(); ++f)
        for (int32_t v : mesh.faces[f]) grow(shells[mesh.shell[f]], mesh.vertices[v]);
    for (size_t i = 0; i < shells.size(); ++i)
        if (mesh.closed[i] && shells[i].lo.x <= shells[i].hi.x) {
            solids.push_back(shells[i]);
            longest = std::max(longest, norm(shells[i].hi - shells[i].lo));
        }
    return pack_boxes(solids);
}

int32_t count_shells(const Mesh& mesh) {
    std::vector<uint8_t> used(mesh.closed.size(), 0);
    for (int32_t shell : mesh.shell) used[shell] = 1;
    return static_cast<int32_t>(std::count(used.begin(), used.end(), 1));
}

constexpr size_t most_corners = 4096;
constexpr size_t most_pieces = 64;

Piece piece_of(const Mesh& mesh, const std::vector<int32_t>& corners, size_t begin, size_t end) {
    Box box = empty_box();
    for (size_t i = begin; i < end; ++i) grow(box, mesh.vertices[corners[i]]);
    Piece piece{0.5 * (box.lo + box.hi), 0, static_cast<int32_t>(begin), static_cast<int32_t>(end)};
    for (size_t i = begin; i < end; ++i)
        piece.radius = greater(piece.radius, norm(mesh.vertices[corners[i]] - piece.center));
    return piece;
}

void find_pieces(Shape& shape, const Mesh& mesh) {
    if (mesh.vertices.size() > most_corners) return;
    std::vector<std::pair<int32_t, int32_t>> of_shell;
    for (size_t f = 0; f < mesh.faces.size(); ++f)
        for (int32_t v : mesh.faces[f]) of_shell.emplace_back(mesh.shell[f], v);
    std::sort(of_shell.begin(), of_shell.end());
    of_shell.erase(std::unique(of_shell.begin(), of_shell.end()), of_shell.end());
    size_t begin = 0;
    for (size_t i = 0; i < of_shell.size(); ++i) {
        shape.corners.push_back(of_shell[i].second);
        if (i + 1 < of_shell.size() && of_shell[i + 1].first == of_shell[i].first) continue;
        shape.pieces.push_back(piece_of(mesh, shape.corners, begin, i + 1));
        begin = i + 1;
    }
    if (shape.pieces.size() > most_pieces) shape.pieces.clear();
    shape.corners.shrink_to_fit();
    shape.pieces.shrink_to_fit();
}

// As `posed_box` takes it: the axes are floats.
std::array<Vec3, 8> corners_of(const OrientedBox& box) {
    std::array<Vec3, 8> out;
    for (int k = 0; k < 8; ++k) {
        Vec3 p{box.center[0], box.center[1], box.center[2]};
        for (int i = 0; i < 3; ++i) {
            const double by = (k >> i & 1 ? 1 : -1) * box.half[i] * (1 + 1e-6);
            p = p + by * Vec3{box.axis[i][0], box.axis[i][1], box.axis[i][2]};
        }
        out[k] = p;
    }
    return out;
}

template <class T>
size_t bytes(const std::vector<T>& v) {
    return v.capacity() * sizeof(T);
}

size_t bytes(const PackedBoxes& boxes) {
    size_t n = bytes(boxes.items);
    for (const auto& level : boxes.levels) n += bytes(level);
    return n;
}

}  // namespace

Shape build_shape(Mesh mesh, const GraphSettings& settings, const BuildMonitor& monitor) {
    Shape shape;
    report(monitor, mesh_share);
    shape.graph = build_graph(mesh, settings);
    report(monitor, graph_share);
    shape.tree = build_tree(mesh, shape.graph, monitor);
    shape.parts = find_parts(mesh, shape.graph);
    shape.anchors = find_anchors(shape.parts);
    shape.smallest_part = std::numeric_limits<double>::infinity();
    for (const Part& part : shape.parts) {
        const double length = std::max({norm(part[1] - part[0]), norm(part[3] - part[2]), norm(part[5] - part[4])});
        shape.smallest_part = std::min(shape.smallest_part, length);
    }
    shape.solids = find_solids(mesh, shape.largest_solid);
    for (const Vec3& p : mesh.vertices) {
        shape.radius = std::max(shape.radius, norm(p));
        shape.reach = std::max({shape.reach, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    }
    find_pieces(shape, mesh);
    shape.shells = count_shells(mesh);
    shape.box = corners_of(shape.tree.boxes[0]);
    shape.mesh = std::move(mesh);
    // Only the build needed these.
    shape.graph.kept = {};
    shape.graph.lossless = {};
    shape.mesh.edges = {};
    shape.mesh.shell = {};
    shape.tree.nodes.shrink_to_fit();
    shape.tree.oriented.shrink_to_fit();
    shape.tree.boxes.shrink_to_fit();
    shape.tree.leaves.shrink_to_fit();
    return shape;
}

size_t memory_bytes(const Shape& s) {
    return sizeof(Shape) + bytes(s.mesh.vertices) + bytes(s.mesh.faces) + bytes(s.mesh.closed) + bytes(s.graph.points) +
           bytes(s.graph.edges) + bytes(s.graph.kinds) + bytes(s.tree.nodes) + bytes(s.tree.oriented) +
           bytes(s.tree.boxes) + bytes(s.tree.leaves) + bytes(s.parts) + bytes(s.anchors) + bytes(s.solids) +
           bytes(s.corners) + bytes(s.pieces);
}

}  // namespace fgenv
