// Python classes of a shape and its feature graph.
#include "bind/bind.h"

#include <chrono>
#include <numbers>

#include "bind/arrays.h"
#include "shape/shape.h"

namespace fgenv {
namespace {

GraphSettings settings_of(const std::string& method, double valley, double ridge, double tolerance) {
    GraphSettings s;
    s.method = method == "loop"        ? Method::loop
               : method == "crease"    ? Method::crease
               : method == "tolerance" ? Method::tolerance
                                       : Method::exact;
    s.valley = valley;
    s.ridge = ridge;
    s.tolerance = tolerance;
    return s;
}

// Checks for Ctrl-C and calls a Python function, or None, with the share of the work that is done. What either
// raises ends the build. The build runs without the GIL.
BuildMonitor monitor_for(nb::handle progress) {
    using Clock = std::chrono::steady_clock;
    return [progress, last = Clock::now()](double done) mutable {
        if (Clock::now() - last < std::chrono::milliseconds(20)) return;
        const nb::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!progress.is_none()) progress(done);
        last = Clock::now();
    };
}

Mesh mesh_from(nb::handle vertices, nb::handle faces, const BuildMonitor& monitor) {
    const Array<double> v = points(vertices, "vertices");
    const Array<int64_t> f = indices(faces, "faces");
    const auto fail = [](const std::string& text) { throw nb::value_error(text.c_str()); };
    if (v.dims.size() != 2) fail("vertices: got shape " + to_string(v.dims) + ", expected (n, 3)");
    if (f.dims.size() == 1 && f.dims[0] == 0) fail("faces: got no faces, expected at least one");
    if (f.dims.size() != 2 || f.dims[1] != 3)
        fail("faces: got shape " + to_string(f.dims) + ", expected triangles (m, 3)");
    if (f.dims[0] == 0) fail("faces: got no faces, expected at least one");
    const int64_t n = v.dims[0];
    if (n > (int64_t{1} << 28) || f.dims[0] > (int64_t{1} << 28))
        fail("faces: got more than 2^28 vertices or faces, expected fewer; split the mesh");
    std::vector<Vec3> points(n);
    for (int64_t i = 0; i < n; ++i) points[i] = {v.data()[3 * i], v.data()[3 * i + 1], v.data()[3 * i + 2]};
    for (int64_t i = 0; i < 3 * n; ++i)
        if (std::fabs(v.data()[i]) > 1e9)
            fail("vertices[" + std::to_string(i / 3) + "]: got a coordinate over 1e9 m, expected meters");
    std::vector<Face> triangles(f.dims[0]);
    for (size_t i = 0; i < triangles.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const int64_t index = f.data()[3 * i + k];
            if (index < 0 || index >= n)
                fail("faces[" + std::to_string(i) + "]: got vertex " + std::to_string(index) +
                     ", expected an index into " + std::to_string(n) + " vertices");
            triangles[i][k] = static_cast<int32_t>(index);
        }
    nb::gil_scoped_release released;
    return read_mesh(std::move(points), std::move(triangles), monitor);
}

void require_faces(const Mesh& mesh) {
    if (mesh.faces.empty()) throw nb::value_error("faces: got only faces of zero area, expected a surface");
}

nb::object rows3(const std::vector<Vec3>& v) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return copy_out(reinterpret_cast<const double*>(v.data()), {static_cast<int64_t>(v.size())}, {3});
}

struct Graph {  // a feature graph and its vertices
    FeatureGraph graph;
    std::vector<Vec3> points;
};

Graph graph_of(const FeatureGraph& graph, const Mesh& mesh) {
    Graph out{graph, {}};
    out.graph.kept = {};
    out.graph.lossless = {};
    for (int32_t v : graph.points) out.points.push_back(mesh.vertices[v]);
    return out;
}

nb::dict repairs_of(const Repairs& r) {
    nb::dict out;
    out["merged_vertices"] = r.merged_vertices;
    out["unused_vertices"] = r.unused_vertices;
    out["degenerate_faces"] = r.degenerate_faces;
    out["duplicate_faces"] = r.duplicate_faces;
    out["flipped_faces"] = r.flipped_faces;
    return out;
}

// Bit (i, j), i < j, of the strict upper triangle, row by row, most significant bit first.
nb::object packed_adjacency(const Graph& g) {
    const int64_t n = static_cast<int64_t>(g.points.size());
    const int64_t bits = n * (n - 1) / 2;
    if (bits > (int64_t{1} << 33))
        throw nb::value_error(
            ("adjacency: got " + std::to_string(n) + " feature points, expected a matrix of at most 1 GiB; use edges")
                .c_str());
    Output<uint8_t> out = make_output<uint8_t>({(bits + 7) / 8});
    for (const auto& e : g.graph.edges) {
        const int64_t i = std::min(e[0], e[1]), j = std::max(e[0], e[1]);
        const int64_t k = i * n - i * (i + 1) / 2 + (j - i - 1);
        out.data[k / 8] |= static_cast<uint8_t>(0x80 >> k % 8);
    }
    return nb::cast(out.array);
}

}  // namespace

void bind_shape(nb::module_& m) {
    nb::class_<Graph>(m, "FeatureGraph")
        .def(
            "__init__",
            [](Graph* self, nb::handle vertices, nb::handle faces, const std::string& method, double valley,
               double ridge, double tolerance) {
                Mesh mesh = mesh_from(vertices, faces, monitor_for(nb::none()));
                require_faces(mesh);
                new (self) Graph(graph_of(build_graph(mesh, settings_of(method, valley, ridge, tolerance)), mesh));
            },
            nb::arg("vertices").none(), nb::arg("faces").none(), nb::arg("method"), nb::kw_only(), nb::arg("valley"),
            nb::arg("ridge"), nb::arg("tolerance"))
        .def_prop_ro("points", [](const Graph& g) { return rows3(g.points); })
        .def_prop_ro("edges",
                     [](const Graph& g) {
                         return copy_out(reinterpret_cast<const int32_t*>(g.graph.edges.data()),
                                         {static_cast<int64_t>(g.graph.edges.size())}, {2});
                     })
        .def_prop_ro("kind_codes",
                     [](const Graph& g) {
                         return copy_out(reinterpret_cast<const uint8_t*>(g.graph.kinds.data()),
                                         {static_cast<int64_t>(g.graph.kinds.size())});
                     })
        .def_prop_ro("adjacency", &packed_adjacency)
        .def_prop_ro("certificate", [](const Graph& g) { return g.graph.certificate; });

    nb::class_<Shape>(m, "Shape")
        .def(
            "__init__",
            [](Shape* self, nb::handle vertices, nb::handle faces, const std::string& method, double valley,
               double ridge, double tolerance, nb::handle progress) {
                const BuildMonitor monitor = monitor_for(progress);
                Mesh mesh = mesh_from(vertices, faces, monitor);
                require_faces(mesh);
                nb::gil_scoped_release released;
                new (self) Shape(build_shape(std::move(mesh), settings_of(method, valley, ridge, tolerance), monitor));
            },
            nb::arg("vertices").none(), nb::arg("faces").none(), nb::arg("method"), nb::kw_only(), nb::arg("valley"),
            nb::arg("ridge"), nb::arg("tolerance"), nb::arg("progress") = nb::none())
        .def_prop_ro("vertices", [](const Shape& s) { return rows3(s.mesh.vertices); })
        .def_prop_ro("faces",
                     [](const Shape& s) {
                         return copy_out(reinterpret_cast<const int32_t*>(s.mesh.faces.data()),
                                         {static_cast<int64_t>(s.mesh.faces.size())}, {3});
                     })
        .def_prop_ro("flat_faces",
                     [](const Shape& s) {
                         return copy_out(reinterpret_cast<const double*>(s.mesh.flat.data()),
                                         {static_cast<int64_t>(s.mesh.flat.size())}, {3, 3});
                     })
        .def_prop_ro("bounds",
                     [](const Shape& s) {
                         const Box& b = s.mesh.bounds;
                         const double rows[6] = {b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z};
                         return copy_out(rows, {2}, {3});
                     })
        .def_prop_ro("watertight", [](const Shape& s) { return s.mesh.watertight; })
        .def_prop_ro("shells", [](const Shape& s) { return s.shells; })
        .def_prop_ro("feature_counts",
                     [](const Shape& s) { return nb::make_tuple(s.graph.points.size(), s.graph.edges.size()); })
        .def_prop_ro("radius", [](const Shape& s) { return s.radius; })
        .def_prop_ro("repairs", [](const Shape& s) { return repairs_of(s.mesh.repairs); })
        .def_prop_ro("nbytes", [](const Shape& s) { return memory_bytes(s); })
        .def_prop_ro("native_graph", [](const Shape& s) { return graph_of(s.graph, s.mesh); });
}

}  // namespace fgenv
