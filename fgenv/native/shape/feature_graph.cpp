// Methods as in Ma Li, Wang Qiang et al., "a collision detection method based on the feature graph of
// objects, with detection masks": section 2.1 (feature points), section 2.2 (graph); and its lossless
// and bounded generalisations.
#include "shape/feature_graph.h"

#include <cmath>
#include <limits>

#include "math/predicates.h"
#include "math/trig.h"
#include "shape/patches.h"

namespace fgenv {
namespace {

// Radians. Rounding must not decide on regular solids: their angles tie with the threshold.
constexpr double angle_tie = 1e-9;

// Sign of the fold: > 0 along a valley (the neighbor rises above the face), 0 if exactly coplanar.
int fold(const Mesh& mesh, const Edge& e) {
    const Face& f = mesh.faces[e.face[0]];
    const int32_t far = opposite_vertex(mesh.faces[e.face[1]], e);
    const auto& v = mesh.vertices;
    return -orient3d(v[f[0]], v[f[1]], v[f[2]], v[far]);
}

bool two_faced(const Edge& e) { return e.faces_around == 2 && e.opposed; }

Kind kind_of(const Mesh& mesh, const Edge& e) {
    if (!two_faced(e)) return Kind::border;
    return fold(mesh, e) > 0 ? Kind::valley : Kind::ridge;
}

bool is_crease(const Mesh& mesh, const Edge& e, const GraphSettings& s) {
    const double theta = dihedral(mesh, e);
    return theta < s.valley - angle_tie || theta > s.ridge + angle_tie;
}

// Coplanar and turned the same way: two faces folded flat onto each other end at their edge.
bool is_flat(const Mesh& mesh, const Edge& e) {
    return fold(mesh, e) == 0 && dot(area_vector(mesh, e.face[0]), area_vector(mesh, e.face[1])) > 0;
}

// Numbers the vertices of the kept edges as points, in the order met.
class Builder {
public:
    Builder(const Mesh& mesh, FeatureGraph& graph) : graph_(graph), id_(mesh.vertices.size(), -1) {}
    int32_t point(int32_t vertex) {
        if (id_[vertex] < 0) {
            id_[vertex] = static_cast<int32_t>(graph_.points.size());
            graph_.points.push_back(vertex);
        }
        return id_[vertex];
    }
    void edge(const Edge& e, Kind kind) {
        const int32_t a = point(e.a), b = point(e.b);
        graph_.edges.push_back({a, b});
        graph_.kinds.push_back(kind);
    }

private:
    FeatureGraph& graph_;
    std::vector<int32_t> id_;
};

// Section 2.2: the feature points joined head to tail in the order found make one simple cycle.
void join_head_to_tail(FeatureGraph& graph) {
    const int32_t n = static_cast<int32_t>(graph.points.size());
    for (int32_t i = 0; i + 1 < n; ++i) graph.edges.push_back({i, i + 1});
    if (n > 2) graph.edges.push_back({n - 1, 0});
    graph.kinds.assign(graph.edges.size(), Kind::chord);
}

// The order in which a face runs along its edge: the published walk finds A before B.
std::array<int32_t, 2> as_first_face_runs(const Mesh& mesh, const Edge& e) {
    const Face& f = mesh.faces[e.face[0]];
    for (int k = 0; k < 3; ++k)
        if (f[k] == e.b && f[(k + 1) % 3] == e.a) return {e.b, e.a};
    return {e.a, e.b};
}

}  // namespace

double dihedral(const Mesh& mesh, const Edge& e) {
    const Vec3 n1 = unit(area_vector(mesh, e.face[0])), n2 = unit(area_vector(mesh, e.face[1]));
    const double angle = std::atan2(norm(cross(n1, n2)), dot(n1, n2));
    return fold(mesh, e) > 0 ? pi - angle : pi + angle;
}

FeatureGraph build_graph(const Mesh& mesh, const GraphSettings& settings) {
    FeatureGraph graph;
    graph.settings = settings;
    graph.kept.assign(mesh.edges.size(), 0);
    graph.lossless.assign(mesh.edges.size(), 0);
    for (size_t i = 0; i < mesh.edges.size(); ++i)
        graph.lossless[i] = !two_faced(mesh.edges[i]) || !is_flat(mesh, mesh.edges[i]);
    Builder build(mesh, graph);

    if (settings.method == Method::loop) {
        for (const Edge& e : mesh.edges)
            if (two_faced(e) && is_crease(mesh, e, settings))
                for (int32_t v : as_first_face_runs(mesh, e)) build.point(v);
        join_head_to_tail(graph);
        graph.certificate = std::numeric_limits<double>::quiet_NaN();
        return graph;
    }

    if (settings.method == Method::tolerance) {
        const std::vector<int32_t> patch = grow_patches(mesh, settings.tolerance);
        for (size_t i = 0; i < mesh.edges.size(); ++i) {
            const Edge& e = mesh.edges[i];
            graph.kept[i] = !two_faced(e) || patch[e.face[0]] != patch[e.face[1]];
        }
        graph.certificate = settings.tolerance;
    } else if (settings.method == Method::crease) {
        for (size_t i = 0; i < mesh.edges.size(); ++i) {
            const Edge& e = mesh.edges[i];
            graph.kept[i] = !two_faced(e) || is_crease(mesh, e, settings);
        }
        graph.certificate = patch_certificate(mesh, graph.kept);
    } else {
        graph.kept = graph.lossless;
        graph.certificate = 0;
    }
    for (size_t i = 0; i < mesh.edges.size(); ++i) {
        const Edge& e = mesh.edges[i];
        if (graph.kept[i])
            build.edge(e, settings.method == Method::tolerance && two_faced(e) ? Kind::patch : kind_of(mesh, e));
    }
    return graph;
}

}  // namespace fgenv
