// Fuzz target of the native core: bytes as two meshes and a pose, through reading, feature graphs, tree
// and kernels, under the address and undefined-behavior sanitizers.
//
//     tests/fuzz/native.sh 3600 CORPUS            # an hour; keeps new inputs (CXX: GCC or Clang)
//     build/fuzz/native crash-1234                # runs one input again
//
// With Clang the driver is libFuzzer; any other compiler gets the small one in native_driver.cpp. What
// must hold: a repaired mesh needs no repair; edges, shells, graphs and leaves are in range; verdicts
// and distances are those of every edge against every face; all instruction sets give the same bits.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "query/edge_face.h"
#include "query/kernels.h"

using namespace fgenv;

namespace fgenv::baseline {
extern const Kernels table;
}
#if defined(__x86_64__)
namespace fgenv::v3 {
extern const Kernels table;
}
#endif

namespace {

#define LAW(condition)                                                                   \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            std::fprintf(stderr, "%s:%d: broken: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                \
        }                                                                                \
    } while (false)

// Meters. Squares and products of larger numbers overflow: see test_edge_cases.py.
constexpr double least = 1e-60, most = 1e9;

struct Reader {
    const uint8_t* at;
    const uint8_t* end;
    uint8_t byte() { return at < end ? *at++ : 0; }
    double whole() { return (byte() % 17 - 8) / 2.0; }
    // Exact: numbers with sums and products without rounding.
    double number(bool exact) {
        static const double odd[] = {least, 1e-30, 1e-9, 1 + 0x1p-52, 1e6, 1e8, most, -most};
        if (exact) return whole();
        const int kind = byte() % 8;
        if (kind < 3) return whole();
        if (kind < 6) return (byte() * 256 + byte() - 32768) / 10007.0;
        if (kind == 6) return odd[byte() % 8];
        uint64_t u = 0;
        for (int i = 0; i < 8; ++i) u = u << 8 | byte();
        double x;
        std::memcpy(&x, &u, sizeof x);
        return std::fabs(x) >= least && std::fabs(x) <= most ? x : 1;
    }
    Vec3 point(bool exact) {
        const double x = number(exact), y = number(exact);
        return {x, y, number(exact)};
    }
};

// A box, or any faces over a few points; then faces dropped, turned, doubled, folded.
Mesh mesh_from(Reader& r, bool exact) {
    std::vector<Vec3> v;
    std::vector<Face> f;
    const int kind = r.byte() % 4;
    if (kind < 2) {
        const int n = 3 + r.byte() % 8, m = 1 + r.byte() % 40;
        for (int i = 0; i < n; ++i) v.push_back(r.point(exact));
        for (int i = 0; i < m; ++i) {
            const int a = r.byte() % n, b = r.byte() % n;
            f.push_back({a, b, r.byte() % n});
        }
    } else {
        const int boxes = kind == 2 ? 1 : 1 + r.byte() % 4;
        for (int i = 0; i < boxes; ++i) {
            const int first = static_cast<int>(v.size());
            const Vec3 lo = r.point(exact), size = r.point(exact);
            for (int k = 0; k < 8; ++k)
                v.push_back({lo.x + (k & 1) * size.x, lo.y + (k >> 1 & 1) * size.y, lo.z + (k >> 2) * size.z});
            static const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
            for (const auto& q : quads) {
                f.push_back({first + q[0], first + q[1], first + q[2]});
                f.push_back({first + q[0], first + q[2], first + q[3]});
            }
        }
        for (int changes = r.byte() % 4; changes > 0; --changes) {
            const size_t at = r.byte() % f.size();
            const int what = r.byte() % 5;
            if (what == 0 && f.size() > 1)
                f.erase(f.begin() + at);
            else if (what == 1)
                std::swap(f[at][0], f[at][1]);
            else if (what == 2)
                f.push_back(f[at]);
            else if (what == 3)
                v[f[at][0]] = r.point(exact);
            else
                v[f[at][0]] = 0.5 * (v[f[at][1]] + v[f[at][2]]);
        }
    }
    for (Vec3& p : v)
        for (double* x : {&p.x, &p.y, &p.z}) *x = lesser(greater(*x, -most), most);
    return read_mesh(std::move(v), std::move(f));
}

void check_mesh(const Mesh& m) {
    LAW(m.shell.size() == m.faces.size());
    for (const Face& f : m.faces)
        for (int32_t i : f) LAW(i >= 0 && static_cast<size_t>(i) < m.vertices.size());
    size_t sides = 0;
    for (const Edge& e : m.edges) {
        sides += e.faces_around;
        LAW(e.a < e.b && e.faces_around >= 1 && e.face[0] >= 0 && (e.face[1] >= 0) == (e.faces_around > 1));
    }
    LAW(sides == 3 * m.faces.size());
    const bool two_sided =
        std::all_of(m.edges.begin(), m.edges.end(), [](const Edge& e) { return e.opposed || e.faces_around != 2; });
    LAW(two_sided || !m.watertight);
    if (!two_sided) return;  // wound differently each time it is read
    const Mesh again = read_mesh(m.vertices, m.faces);
    LAW(again.faces == m.faces && again.vertices.size() == m.vertices.size());
    const Repairs& r = again.repairs;
    LAW(!r.merged_vertices && !r.unused_vertices && !r.degenerate_faces && !r.duplicate_faces && !r.flipped_faces);
}

GraphSettings settings_from(Reader& r) {
    static const double bends[] = {0, 0.5, 1.2, 3.14};
    static const double tolerances[] = {1e-300, 1e-3, 0.5, 1e3};
    GraphSettings s;
    s.method = static_cast<Method>(r.byte() % 4);
    const double bend = bends[r.byte() % 4];
    s.valley = 3.141592653589793 - bend;
    s.ridge = 3.141592653589793 + bend;
    s.tolerance = tolerances[r.byte() % 4];
    return s;
}

void check_shape(const Shape& s) {
    const FeatureGraph& g = s.graph;
    LAW(g.edges.size() == g.kinds.size());
    for (int32_t p : g.points) LAW(p >= 0 && static_cast<size_t>(p) < s.mesh.vertices.size());
    for (const auto& e : g.edges)
        for (int32_t p : e) LAW(p >= 0 && static_cast<size_t>(p) < g.points.size());
    std::vector<int> seen(s.mesh.faces.size());
    for (const Leaf& leaf : s.tree.leaves)
        for (int k = 0; k < lanes; ++k)
            if (leaf.valid >> k & 1) ++seen.at(leaf.face[k]);
    LAW(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

Rigid pose_from(Reader& r, bool exact) {
    Rigid t{};
    const int kind = r.byte() % 3;
    if (kind == 2 && !exact) {
        double q[4], sum = 0;
        for (double& x : q) x = r.byte() - 127.5, sum += x * x;
        for (double& x : q) x /= std::sqrt(sum);
        const double w = q[0], x = q[1], y = q[2], z = q[3];
        const double m[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
        std::memcpy(t.r, m, sizeof m);
    } else {  // a cube's rotations
        const int turn = kind ? r.byte() % 3 : 0, signs = kind ? r.byte() % 4 : 0;
        for (int i = 0; i < 3; ++i) t.r[i][(i + turn) % 3] = 1;
        for (int i = 0; i < 3; ++i)
            for (double& x : t.r[i]) x *= signs == 0 || signs == i + 1 ? 1 : -1;
    }
    for (double& x : t.t) x = lesser(greater(r.number(exact), -most), most);
    return t;
}

struct Triangle {
    Vec3 v[3];
};

std::vector<Triangle> placed(const Mesh& m, const Rigid* pose) {
    std::vector<Triangle> out;
    for (const Face& f : m.faces) {
        Triangle t{{m.vertices[f[0]], m.vertices[f[1]], m.vertices[f[2]]}};
        if (pose)
            for (Vec3& p : t.v) p = apply(*pose, p);
        out.push_back(t);
    }
    return out;
}

bool edges_meet(const Triangle& edges, const Triangle& face) {
    const Vec3* f = face.v;
    for (int k = 0; k < 3; ++k) {
        const Vec3 p = edges.v[k], q = edges.v[(k + 1) % 3];
        if (edge_meets_face(p, orient3d(f[0], f[1], f[2], p), q, orient3d(f[0], f[1], f[2], q), f)) return true;
    }
    return false;
}

bool surfaces_meet(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
    for (const Triangle& s : a)
        for (const Triangle& t : b)
            if (edges_meet(s, t) || edges_meet(t, s)) return true;
    return false;
}

// Nearest point of a triangle to p, as C. Ericson, "Real-Time Collision Detection", 5.1.5.
Vec3 nearest_on(const Triangle& t, Vec3 p) {
    const Vec3 a = t.v[0], b = t.v[1], c = t.v[2], ab = b - a, ac = c - a;
    const double d1 = dot(ab, p - a), d2 = dot(ac, p - a), d3 = dot(ab, p - b), d4 = dot(ac, p - b),
                 d5 = dot(ab, p - c), d6 = dot(ac, p - c);
    if (d1 <= 0 && d2 <= 0) return a;
    if (d3 >= 0 && d4 <= d3) return b;
    if (d6 >= 0 && d5 <= d6) return c;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

double gap_of_sides(Vec3 p, Vec3 p2, Vec3 q, Vec3 q2) {
    const Vec3 u = p2 - p, w = q2 - q, r = p - q;
    const double uu = dot(u, u), ww = dot(w, w), uw = dot(u, w), det = uu * ww - uw * uw;
    const auto clamped = [](double x) { return x >= 0 ? lesser(x, 1) : 0; };  // 0 for NaN
    double s = clamped((uw * dot(w, r) - dot(u, r) * ww) / det);
    const double t = clamped((uw * s + dot(w, r)) / ww);
    s = clamped((uw * t - dot(u, r)) / uu);
    return norm(r + s * u - t * w);
}

double gap(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
    double best = HUGE_VAL;
    for (const Triangle& s : a)
        for (const Triangle& t : b)
            for (int i = 0; i < 3; ++i) {
                best = lesser(norm(nearest_on(t, s.v[i]) - s.v[i]), best);  // in this order: skips NaN
                best = lesser(norm(nearest_on(s, t.v[i]) - t.v[i]), best);
                for (int j = 0; j < 3; ++j)
                    best = lesser(gap_of_sides(s.v[i], s.v[(i + 1) % 3], t.v[j], t.v[(j + 1) % 3]), best);
            }
    return best;
}

void check_pair(const Kernels& k, const Shape& a, const Shape& b, const Rigid& pose, bool exact) {
    const auto in_a = placed(a.mesh, nullptr), in_b = placed(b.mesh, &pose);
    Witness w;
    const bool hit = k.collide(a, b, pose, true, &w);
    const bool contained = w.side == Witness::a_inside_b || w.side == Witness::b_inside_a;
    const bool meet = surfaces_meet(in_a, in_b);
    const double reach = a.reach + b.reach + std::fabs(pose.t[0]) + std::fabs(pose.t[1]) + std::fabs(pose.t[2]);
    LAW(hit == (w.side != Witness::none));
    LAW(!hit || contained || meet);  // no false hits
    if (meet && !hit && !exact) {    // coplanar faces, placed, are so only within rounding
        Rigid nudged = pose;
        for (int axis = 0; axis < 3 && meet; ++axis)
            for (int sign = -1; sign <= 1; sign += 2) {
                nudged = pose;
                nudged.t[axis] += sign * 1e-12 * reach;
                if (!surfaces_meet(in_a, placed(b.mesh, &nudged))) return;
            }
    }
    LAW(!meet || hit);  // no missed hits
    const bool chosen = k.collide(a, b, pose, false, nullptr);
    const bool loop = a.graph.settings.method == Method::loop || b.graph.settings.method == Method::loop;
    LAW(loop || !chosen || hit);  // a coarser graph has no false hits
    const Nearest near = k.nearest(a, b, pose, HUGE_VAL, false);
    if (reach > 1e12) return;  // beyond this, floats are too coarse for a comparison
    LAW(near.face_a >= 0 && near.face_b >= 0 && near.squared >= 0);
    if (meet) return;
    const double truth = gap(in_a, in_b), found = std::sqrt(near.squared);
    LAW(std::fabs(found - truth) <= 1e-7 * truth + 1e-7 * reach * (exact ? 1e-3 : 1));
    if (truth > 1e-6 * reach && truth > 1e-100) {
        const double wide = 1.000001 * found, narrow = 0.999999 * found;
        LAW(k.nearest(a, b, pose, wide * wide, true).face_a >= 0);
        LAW(k.nearest(a, b, pose, narrow * narrow, true).face_a < 0);
    }
}

void check_rays(const Kernels& k, const Shape& s, Reader& r, bool exact) {
    const Vec3 p = r.point(exact), q = r.point(exact), way = unit(q - p);
    bool touching = false;
    k.winding(s, p, touching);
    const int32_t crossed = k.segment(s, p, q);
    LAW(crossed >= -1 && crossed < static_cast<int32_t>(s.mesh.faces.size()));
    if (norm(way) == 0) return;
    const RayHit hit = k.raycast(s, p, way, HUGE_VAL);
    LAW((hit.face >= 0) == std::isfinite(hit.distance));
    LAW(hit.face < static_cast<int32_t>(s.mesh.faces.size()));
}

bool same(double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0 || x == y; }

#if defined(__x86_64__)
void check_isas(const Shape& a, const Shape& b, const Rigid& pose) {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;
    const Kernels &one = baseline::table, &two = v3::table;
    for (bool lossless : {false, true})
        LAW(one.collide(a, b, pose, lossless, nullptr) == two.collide(a, b, pose, lossless, nullptr));
    const Nearest m = one.nearest(a, b, pose, HUGE_VAL, false), n = two.nearest(a, b, pose, HUGE_VAL, false);
    LAW(same(m.squared, n.squared) && m.on_a == n.on_a && m.on_b == n.on_b);  // faces that tie may differ
    const RayHit g = one.raycast(a, {0.1, 0.2, 0.3}, {0.6, 0.8, 0}, 1e9),
                 h = two.raycast(a, {0.1, 0.2, 0.3}, {0.6, 0.8, 0}, 1e9);
    LAW(same(g.distance, h.distance) && g.face == h.face);
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Reader r{data, data + size};
    const bool exact = r.byte() % 2;
    Mesh mesh_a = mesh_from(r, exact), mesh_b = mesh_from(r, exact);
    if (mesh_a.faces.empty() || mesh_b.faces.empty()) return 0;
    check_mesh(mesh_a);
    check_mesh(mesh_b);
    const GraphSettings settings_a = settings_from(r), settings_b = settings_from(r);
    const Shape a = build_shape(std::move(mesh_a), settings_a), b = build_shape(std::move(mesh_b), settings_b);
    check_shape(a);
    check_shape(b);
    const Rigid pose = pose_from(r, exact);
    check_pair(kernels(), a, b, pose, exact);
    check_rays(kernels(), a, r, exact);
#if defined(__x86_64__)
    check_isas(a, b, pose);
#endif
    return 0;
}
