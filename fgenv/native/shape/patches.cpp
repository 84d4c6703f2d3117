#include "shape/patches.h"

#include <algorithm>
#include <limits>

#include "math/disjoint_sets.h"

namespace fgenv {
namespace {

// cos of the widest angle between a face's normal and its slab's: short of a right angle, since a
// face seen nearly edge-on makes the overlap test below depend on rounding.
constexpr double min_cosine = 0.05;

// A patch keeps its members' projections to test each new one: bounded, so growth stays linear.
constexpr size_t max_patch_faces = 1024;

struct Triangle2 {
    double p[3][2];  // counter-clockwise
    double lo[2], hi[2];
};

struct Slab {
    Vec3 normal, u, v;
    double lo = 0, hi = 0;
};

Slab slab_along(Vec3 normal) {
    Slab s;
    s.normal = unit(normal);
    const Vec3 n = s.normal;
    const Vec3 axis = std::fabs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    s.u = unit(cross(n, axis));
    s.v = cross(n, s.u);
    return s;
}

Triangle2 project(const Mesh& mesh, int32_t face, const Slab& s) {
    Triangle2 t;
    for (int axis = 0; axis < 2; ++axis) {
        for (int i = 0; i < 3; ++i) t.p[i][axis] = dot(axis == 0 ? s.u : s.v, mesh.vertices[mesh.faces[face][i]]);
        t.lo[axis] = std::min({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
        t.hi[axis] = std::max({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
    }
    return t;
}

// All of t lies on the outer side of one of s's sides, up to `slack` (relative to the side's length).
bool side_separates(const Triangle2& s, const Triangle2& t, double slack) {
    for (int i = 0; i < 3; ++i) {
        const double* a = s.p[i];
        const double* b = s.p[(i + 1) % 3];
        const double nx = b[1] - a[1], ny = a[0] - b[0];  // outward
        const double limit = -slack * std::sqrt(nx * nx + ny * ny);
        bool outside = true;
        for (const auto& p : t.p) outside &= nx * (p[0] - a[0]) + ny * (p[1] - a[1]) >= limit;
        if (outside) return true;
    }
    return false;
}

bool interiors_overlap(const Triangle2& s, const Triangle2& t, double slack) {
    if (s.hi[0] <= t.lo[0] || t.hi[0] <= s.lo[0] || s.hi[1] <= t.lo[1] || t.hi[1] <= s.lo[1]) return false;
    return !side_separates(s, t, slack) && !side_separates(t, s, slack);
}

double rounding_slack(const Mesh& mesh) { return 1e-12 * norm(mesh.bounds.hi - mesh.bounds.lo); }

std::vector<std::array<int32_t, 3>> face_neighbors(const Mesh& mesh, const std::vector<uint8_t>* kept) {
    std::vector<std::array<int32_t, 3>> next(mesh.faces.size(), {-1, -1, -1});
    for (size_t i = 0; i < mesh.edges.size(); ++i) {
        const Edge& e = mesh.edges[i];
        if (e.faces_around != 2 || !e.opposed || (kept && (*kept)[i])) continue;
        for (int side = 0; side < 2; ++side)
            *std::find(next[e.face[side]].begin(), next[e.face[side]].end(), -1) = e.face[1 - side];
    }
    return next;
}

// Widens the slab by the face's heights; false (and unchanged) if it would be too thick.
bool widen(Slab& s, const Mesh& mesh, int32_t face, double tolerance) {
    double lo = s.lo, hi = s.hi;
    for (int32_t v : mesh.faces[face]) {
        const double h = dot(s.normal, mesh.vertices[v]);
        lo = std::min(lo, h);
        hi = std::max(hi, h);
    }
    if (hi - lo > tolerance) return false;
    s.lo = lo;
    s.hi = hi;
    return true;
}

bool projects_one_to_one(std::vector<Triangle2>& t, double slack) {
    std::sort(t.begin(), t.end(), [](const Triangle2& a, const Triangle2& b) { return a.lo[0] < b.lo[0]; });
    for (size_t i = 0; i < t.size(); ++i)
        for (size_t j = i + 1; j < t.size() && t[j].lo[0] < t[i].hi[0]; ++j)
            if (interiors_overlap(t[i], t[j], slack)) return false;
    return true;
}

}  // namespace

std::vector<int32_t> grow_patches(const Mesh& mesh, double tolerance) {
    const auto next = face_neighbors(mesh, nullptr);
    const double slack = rounding_slack(mesh);
    std::vector<int32_t> patch(mesh.faces.size(), -1);
    std::vector<int32_t> front;
    std::vector<Triangle2> members;
    int32_t patches = 0;
    for (size_t seed = 0; seed < mesh.faces.size(); ++seed) {
        if (patch[seed] >= 0) continue;
        Slab slab = slab_along(area_vector(mesh, static_cast<int32_t>(seed)));
        slab.lo = slab.hi = dot(slab.normal, mesh.vertices[mesh.faces[seed][0]]);
        front.assign(1, static_cast<int32_t>(seed));
        members.assign(1, project(mesh, front[0], slab));
        patch[seed] = patches;
        for (size_t i = 0; i < front.size() && members.size() < max_patch_faces; ++i)
            for (int32_t g : next[front[i]]) {
                if (g < 0 || patch[g] >= 0) continue;
                if (dot(unit(area_vector(mesh, g)), slab.normal) < min_cosine) continue;
                const Triangle2 t = project(mesh, g, slab);
                const bool overlaps = std::any_of(members.begin(), members.end(),
                                                  [&](const auto& m) { return interiors_overlap(m, t, slack); });
                if (overlaps || !widen(slab, mesh, g, tolerance)) continue;
                patch[g] = patches;
                front.push_back(g);
                members.push_back(t);
            }
        ++patches;
    }
    return patch;
}

double patch_certificate(const Mesh& mesh, const std::vector<uint8_t>& kept) {
    DisjointSets sets(mesh.faces.size());
    for (size_t i = 0; i < mesh.edges.size(); ++i)
        if (!kept[i]) sets.join(mesh.edges[i].face[0], mesh.edges[i].face[1]);
    std::vector<int32_t> patch;
    const int32_t patches = sets.label(patch);
    std::vector<std::vector<int32_t>> members(patches);
    for (size_t f = 0; f < patch.size(); ++f) members[patch[f]].push_back(static_cast<int32_t>(f));

    double thickest = 0;
    std::vector<Triangle2> projected;
    for (const auto& faces : members) {
        Vec3 sum{0, 0, 0};
        for (int32_t f : faces) sum = sum + area_vector(mesh, f);
        Slab slab = slab_along(sum);
        slab.lo = slab.hi = dot(slab.normal, mesh.vertices[mesh.faces[faces[0]][0]]);
        projected.clear();
        for (int32_t f : faces) {
            if (dot(unit(area_vector(mesh, f)), slab.normal) < min_cosine)
                return std::numeric_limits<double>::infinity();
            widen(slab, mesh, f, std::numeric_limits<double>::infinity());
            projected.push_back(project(mesh, f, slab));
        }
        if (!projects_one_to_one(projected, rounding_slack(mesh))) return std::numeric_limits<double>::infinity();
        thickest = std::max(thickest, slab.hi - slab.lo);
    }
    return thickest;
}

}  // namespace fgenv
