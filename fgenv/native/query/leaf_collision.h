// Two leaves: culling in floats, then the verdict. Included by the kernels that walk pairs of trees.
#pragma once

#include "query/edge_face.h"
#include "query/face_culling.h"
#include "query/kernels.h"

namespace fgenv {

struct Query {
    const Shape& a;
    const Shape& b;
    const Rigid& pose;  // b in a's frame
    PairFrames frames;
    int first_bit;  // of the edges asked for, in Leaf::edges
    Witness* witness;
};

// The verdict on two faces: the graph's edges of each against the other, exact, on one set of vertices.
static inline bool faces_meet(const Query& q, const Leaf& la, int i, const Leaf& lb, int j) {
    Vec3 a[3], b[3];
    for (int k = 0; k < 3; ++k) {
        a[k] = q.a.mesh.vertices[la.vertex[k][i]];
        b[k] = apply(q.pose, q.b.mesh.vertices[lb.vertex[k][j]]);
    }
    int side_a[3], side_b[3];
    orient3d(three(b[0]), three(b[1]), three(b[2]), three(a[0], a[1], a[2]), side_a);
    if (side_a[0] == side_a[1] && side_a[1] == side_a[2] && side_a[0] != 0) return false;
    orient3d(three(a[0]), three(a[1]), three(a[2]), three(b[0], b[1], b[2]), side_b);
    if (side_b[0] == side_b[1] && side_b[1] == side_b[2] && side_b[0] != 0) return false;
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        Witness::Side found = Witness::none;
        if (la.edges[i] >> (q.first_bit + k) & 1 && edge_meets_face(a[k], side_a[k], a[l], side_a[l], b))
            found = Witness::edge_of_a;
        else if (lb.edges[j] >> (q.first_bit + k) & 1 && edge_meets_face(b[k], side_b[k], b[l], side_b[l], a))
            found = Witness::edge_of_b;
        if (found == Witness::none) continue;
        if (q.witness) *q.witness = {found, la.face[i], lb.face[j], k, {0, 0, 0}};
        return true;
    }
    return false;
}

// Which faces of a leaf may meet a box; their vertices are left in `faces`, relative to the leaf.
FGENV_INLINE uint32_t faces_near_box(const Leaf& leaf, PosedBox box, float slack, FacesF& faces) {
    load_faces(leaf, faces);
    float extent = 0;
    for (int i = 0; i < 3; ++i) {
        box.c[i] -= leaf.center[i];
        extent += std::fabs(box.c[i]) + 2 * box.h[i];
    }
    const bool larger = size(leaf) > box.h[0] + box.h[1] + box.h[2];
    return faces_near_box(faces, box, slack, local_errors(2 * size(leaf) + extent), leaf.valid, larger);
}

// `box_a`, `box_b`: the leaves' boxes, each in the other's frame.
static inline bool leaves_meet(const Query& q, const Leaf& la, const PosedBox& box_a, const Leaf& lb,
                               const PosedBox& box_b) {
    FacesF a, b;
    const PairFrame& frame = q.frames.b_in_a;
    uint32_t in_a = faces_near_box(la, box_b, frame.slack, a);
    if (!in_a) return false;
    uint32_t in_b = faces_near_box(lb, box_a, frame.slack, b);
    if (!in_b) return false;
    float shift[3];
    const Local local = load_leaves(la, lb, q.pose, frame, a, b, shift);
    find_boxes(b);
    find_normals(b);

    // With a witness the order must not depend on how the tests round: the first pair found is reported.
    if (q.witness || __builtin_popcount(in_a) <= __builtin_popcount(in_b)) {
        for (; in_a; in_a &= in_a - 1) {
            const int i = __builtin_ctz(in_a);
            for (uint32_t m = faces_near_face(a, i, b, local, in_b); m; m &= m - 1)
                if (faces_meet(q, la, i, lb, __builtin_ctz(m))) return true;
        }
    } else {
        for (; in_b; in_b &= in_b - 1) {
            const int j = __builtin_ctz(in_b);
            for (uint32_t m = faces_near_face(b, j, a, local, in_a); m; m &= m - 1)
                if (faces_meet(q, la, __builtin_ctz(m), lb, j)) return true;
        }
    }
    return false;
}

// Whether a face of a leaf may meet a box. Asked before a box is opened against a leaf with larger faces:
// their planes are sharper than the leaf's box.
static inline bool reaches(const Leaf& leaf, const PosedBox& box, float slack) {
    FacesF faces;
    return faces_near_box(leaf, box, slack, faces) != 0;
}

}  // namespace fgenv
