#include "shape/mesh.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "math/disjoint_sets.h"
#include "math/predicates.h"

namespace fgenv {
namespace {

// Open-addressing table from a key's hash to a small index; keys are compared by the caller.
class IndexTable {
public:
    explicit IndexTable(size_t n) {
        size_t capacity = 16;
        while (capacity < 2 * n) capacity *= 2;
        slots_.assign(capacity, -1);
    }
    // The slot that holds an index for which `same(index)`, or the free one to put it.
    template <class Same>
    int32_t& find(uint64_t hash, Same same) {
        size_t i = (hash * 0x9E3779B97F4A7C15ull) >> 20 & (slots_.size() - 1);
        while (slots_[i] >= 0 && !same(slots_[i])) i = (i + 1) & (slots_.size() - 1);
        return slots_[i];
    }

private:
    std::vector<int32_t> slots_;
};

uint64_t bits(double x) {
    uint64_t u;
    std::memcpy(&u, &x, sizeof u);
    return u;
}

// Gives equal positions one index (STL repeats a vertex for every face).
void merge_vertices(Mesh& mesh) {
    auto& v = mesh.vertices;
    for (Vec3& p : v) p = p + Vec3{0, 0, 0};  // -0 becomes 0: equal positions, equal bits
    IndexTable table(v.size());
    std::vector<int32_t> remap(v.size());
    std::vector<Vec3> kept;
    kept.reserve(v.size());
    for (size_t i = 0; i < v.size(); ++i) {
        const uint64_t hash = bits(v[i].x) * 0xff51afd7ed558ccdull ^
                              (bits(v[i].y) + 0x1234567) * 0xc4ceb9fe1a85ec53ull ^
                              (bits(v[i].z) + 0x7654321) * 0x2545F4914F6CDD1Dull;
        int32_t& slot = table.find(hash ^ hash >> 31, [&](int32_t j) { return kept[j] == v[i]; });
        if (slot < 0) {
            slot = static_cast<int32_t>(kept.size());
            kept.push_back(v[i]);
        }
        remap[i] = slot;
    }
    mesh.repairs.merged_vertices = static_cast<int64_t>(v.size() - kept.size());
    for (Face& f : mesh.faces)
        for (int32_t& i : f) i = remap[i];
    v = std::move(kept);
}

Face smallest_first(Face f) {
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    return f;
}

void drop_duplicate_faces(Mesh& mesh) {
    IndexTable table(mesh.faces.size());
    std::vector<Face> kept;
    kept.reserve(mesh.faces.size());
    for (const Face& f : mesh.faces) {
        const Face key = smallest_first(f);
        const uint64_t hash = static_cast<uint64_t>(key[0]) * 0x8da6b343ull ^
                              static_cast<uint64_t>(key[1]) * 0xd8163841ull ^
                              static_cast<uint64_t>(key[2]) * 0xcb1ab31full;
        int32_t& slot = table.find(hash, [&](int32_t j) { return smallest_first(kept[j]) == key; });
        if (slot >= 0) continue;
        slot = static_cast<int32_t>(kept.size());
        kept.push_back(f);
    }
    mesh.repairs.duplicate_faces = static_cast<int64_t>(mesh.faces.size() - kept.size());
    mesh.faces = std::move(kept);
}

void drop_unused_vertices(Mesh& mesh) {
    std::vector<int32_t> remap(mesh.vertices.size(), -1);
    for (const Face& f : mesh.faces)
        for (int32_t i : f) remap[i] = 0;
    int32_t n = 0;
    for (size_t i = 0; i < remap.size(); ++i)
        if (remap[i] == 0) {
            mesh.vertices[n] = mesh.vertices[i];
            remap[i] = n++;
        }
    mesh.repairs.unused_vertices += static_cast<int64_t>(mesh.vertices.size()) - n;
    mesh.vertices.resize(n);
    for (Face& f : mesh.faces)
        for (int32_t& i : f) i = remap[i];
}

uint64_t edge_hash(int32_t a, int32_t b) {
    return (static_cast<uint64_t>(a) << 32 | static_cast<uint32_t>(b)) * 0xff51afd7ed558ccdull;
}

// The edges in the order in which the faces are walked, for each face (0,1), (1,2), (2,0).
void find_edges(Mesh& mesh) {
    IndexTable table(2 * mesh.faces.size());
    mesh.edges.clear();
    mesh.edges.reserve(3 * mesh.faces.size() / 2 + 8);
    for (size_t f = 0; f < mesh.faces.size(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int32_t from = mesh.faces[f][k], to = mesh.faces[f][(k + 1) % 3];
            const int32_t a = std::min(from, to), b = std::max(from, to);
            int32_t& slot =
                table.find(edge_hash(a, b), [&](int32_t e) { return mesh.edges[e].a == a && mesh.edges[e].b == b; });
            if (slot < 0) {
                slot = static_cast<int32_t>(mesh.edges.size());
                mesh.edges.push_back({a, b, {static_cast<int32_t>(f), -1}, 1, false});
                continue;
            }
            Edge& e = mesh.edges[slot];
            if (e.faces_around++ == 1) e.face[1] = static_cast<int32_t>(f);
        }
}

bool runs_forward(const Face& f, const Edge& e) {
    return (f[0] == e.a && f[1] == e.b) || (f[1] == e.a && f[2] == e.b) || (f[2] == e.a && f[0] == e.b);
}

// True if the faces of every two-faced edge run along it in opposite directions.
bool find_opposed(Mesh& mesh) {
    bool all = true;
    for (Edge& e : mesh.edges) {
        e.opposed =
            e.faces_around == 2 && runs_forward(mesh.faces[e.face[0]], e) != runs_forward(mesh.faces[e.face[1]], e);
        all &= e.opposed || e.faces_around != 2;
    }
    return all;
}

// Faces on both sides of a two-faced edge must run along it in opposite directions. Where they do
// not, the orientation is spread from face to face; each connected part keeps that of its larger area.
void orient(Mesh& mesh) {
    const size_t n = mesh.faces.size();
    if (find_opposed(mesh)) return;

    std::vector<int32_t> first(n + 1, 0), links;
    for (const Edge& e : mesh.edges)
        if (e.faces_around == 2) ++first[e.face[0] + 1], ++first[e.face[1] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    links.resize(first[n]);
    std::vector<int32_t> fill(first.begin(), first.end() - 1);
    for (size_t i = 0; i < mesh.edges.size(); ++i)
        if (mesh.edges[i].faces_around == 2)
            for (int32_t f : mesh.edges[i].face) links[fill[f]++] = static_cast<int32_t>(i);

    std::vector<int8_t> flip(n, -1);
    std::vector<int32_t> part;
    for (size_t seed = 0; seed < n; ++seed) {
        if (flip[seed] >= 0) continue;
        part.assign(1, static_cast<int32_t>(seed));
        flip[seed] = 0;
        double flipped_area = 0, kept_area = 0;
        for (size_t i = 0; i < part.size(); ++i) {
            const int32_t f = part[i];
            (flip[f] ? flipped_area : kept_area) += norm(area_vector(mesh, f));
            for (int32_t l = first[f]; l < first[f + 1]; ++l) {
                const Edge& e = mesh.edges[links[l]];
                const int32_t g = e.face[0] == f ? e.face[1] : e.face[0];
                if (flip[g] >= 0) continue;
                flip[g] = flip[f] ^ (e.opposed ? 0 : 1);
                part.push_back(g);
            }
        }
        if (flipped_area > kept_area)
            for (int32_t f : part) flip[f] ^= 1;
    }
    for (size_t f = 0; f < n; ++f)
        if (flip[f]) {
            std::swap(mesh.faces[f][1], mesh.faces[f][2]);
            ++mesh.repairs.flipped_faces;
        }
    find_opposed(mesh);
}

// Shells are the edge-connected parts; one is closed if along every edge as many faces run one way
// as the other, so that winding numbers with respect to it are whole.
void find_shells(Mesh& mesh) {
    DisjointSets sets(mesh.faces.size());
    std::vector<int32_t> balance(mesh.edges.size(), 0);
    IndexTable table(mesh.edges.size());
    for (size_t i = 0; i < mesh.edges.size(); ++i) {
        const Edge& e = mesh.edges[i];
        if (e.face[1] >= 0) sets.join(e.face[0], e.face[1]);
        balance[i] = e.faces_around == 2 ? (e.opposed ? 0 : 2) : e.faces_around == 1 ? 1 : 0;
        if (e.faces_around > 2) {
            table.find(edge_hash(e.a, e.b), [](int32_t) { return false; }) = static_cast<int32_t>(i);
        }
    }
    for (size_t f = 0; f < mesh.faces.size(); ++f)  // edges with three faces and more
        for (int k = 0; k < 3; ++k) {
            const int32_t from = mesh.faces[f][k], to = mesh.faces[f][(k + 1) % 3];
            const int32_t a = std::min(from, to), b = std::max(from, to);
            const int32_t i =
                table.find(edge_hash(a, b), [&](int32_t e) { return mesh.edges[e].a == a && mesh.edges[e].b == b; });
            if (i < 0) continue;
            balance[i] += from == a ? 1 : -1;
            sets.join(mesh.edges[i].face[0], static_cast<int32_t>(f));
        }
    const int32_t shells = sets.label(mesh.shell);
    mesh.closed.assign(shells, 1);
    for (size_t i = 0; i < mesh.edges.size(); ++i)
        if (balance[i] != 0) mesh.closed[mesh.shell[mesh.edges[i].face[0]]] = 0;
}

// Drops the faces of zero area. One between three different vertices may close a T-junction, so a shell
// counts as closed if it is with them or without.
void drop_flat_faces(Mesh& mesh) {
    const auto flat = [&](const Face& f) {
        const Vec3 a = mesh.vertices[f[0]], b = mesh.vertices[f[1]], c = mesh.vertices[f[2]];
        const Vec3 n = cross(b - a, c - a);
        return dot(n, n) == 0 || collinear(a, b, c);  // or too thin for a normal
    };
    const std::vector<uint8_t> closed_before = mesh.closed;
    std::vector<int32_t> shell_before;
    size_t n = 0;
    for (size_t f = 0; f < mesh.faces.size(); ++f) {
        const Face& v = mesh.faces[f];
        if (flat(v)) {
            mesh.flat.push_back({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]});
            continue;
        }
        shell_before.push_back(mesh.shell[f]);
        mesh.faces[n++] = mesh.faces[f];
    }
    if (n == mesh.faces.size()) return;
    mesh.repairs.degenerate_faces += static_cast<int64_t>(mesh.faces.size() - n);
    mesh.faces.resize(n);
    drop_unused_vertices(mesh);
    find_edges(mesh);
    find_opposed(mesh);
    find_shells(mesh);
    // A shell closed with its flat faces stays one: its pieces have no inside of their own.
    const int32_t shells = static_cast<int32_t>(mesh.closed.size());
    mesh.closed.resize(shells + closed_before.size(), 0);
    for (size_t f = 0; f < n; ++f) {
        if (!closed_before[shell_before[f]]) continue;
        mesh.shell[f] = shells + shell_before[f];
        mesh.closed[mesh.shell[f]] = 1;
    }
}

}  // namespace

Mesh read_mesh(std::vector<Vec3> vertices, std::vector<Face> faces, const BuildMonitor& monitor) {
    Mesh mesh;
    report(monitor, 0);
    mesh.vertices = std::move(vertices);
    mesh.faces = std::move(faces);
    merge_vertices(mesh);
    report(monitor, 0.4 * mesh_share);

    const auto repeated = [](const Face& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; };
    const size_t before = mesh.faces.size();
    std::erase_if(mesh.faces, repeated);
    mesh.repairs.degenerate_faces = static_cast<int64_t>(before - mesh.faces.size());
    drop_duplicate_faces(mesh);
    drop_unused_vertices(mesh);
    report(monitor, 0.6 * mesh_share);

    find_edges(mesh);
    report(monitor, 0.8 * mesh_share);
    orient(mesh);
    find_shells(mesh);
    report(monitor, 0.9 * mesh_share);
    drop_flat_faces(mesh);
    mesh.watertight = !mesh.faces.empty() &&
                      std::all_of(mesh.shell.begin(), mesh.shell.end(), [&](int32_t s) { return mesh.closed[s]; });
    for (const Vec3& p : mesh.vertices) grow(mesh.bounds, p);
    return mesh;
}

}  // namespace fgenv
