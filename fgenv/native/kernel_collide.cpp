// Boolean query: dual descent with oriented culling, then edges against faces, then containment.
#include "box_culling.h"
#include "edge_face.h"
#include "face_culling.h"
#include "kernels.h"

namespace fgenv::FGENV_ISA {

int winding(const Shape& shape, Vec3 p, bool& touching);
int32_t segment(const Shape& shape, Vec3 p, Vec3 q);

namespace {

struct Query {
    const Shape& a;
    const Shape& b;
    const Rigid& pose;  // b in a's frame
    PairFrames frames;
    int first_bit;  // of the edges asked for, in Leaf::edges
    Witness* witness;
};

// A box in the frame of the shape whose node it is tested against.
struct OrientedBoxF {
    float c[3], h[3], axis[3][3];
};

FGENV_INLINE OrientedBoxF oriented_box(const Tree& tree, Ref ref) {
    const Oriented& n = tree.oriented[ref / lanes];
    const int k = ref % lanes;
    OrientedBoxF box;
    for (int i = 0; i < 3; ++i) {
        box.c[i] = n.centre[i][k];
        box.h[i] = n.half[i][k];
        for (int j = 0; j < 3; ++j) box.axis[i][j] = n.axis[i][j][k];
    }
    return box;
}

FGENV_INLINE OrientedBoxF placed(const OrientedBoxF& box, const PairFrame& f) {
    OrientedBoxF out;
    for (int i = 0; i < 3; ++i) {
        out.c[i] = f.r[i][0] * box.c[0] + f.r[i][1] * box.c[1] + f.r[i][2] * box.c[2] + f.t[i];
        out.h[i] = box.h[i];
        for (int j = 0; j < 3; ++j)
            out.axis[j][i] = f.r[i][0] * box.axis[j][0] + f.r[i][1] * box.axis[j][1] +
                             f.r[i][2] * box.axis[j][2];
    }
    return out;
}

// The verdict on two faces: the graph's edges of each against the other, exact, on one set of vertices.
bool faces_meet(const Query& q, const Leaf& la, int i, const Leaf& lb, int j) {
    Vec3 a[3], b[3];
    const Face& fa = q.a.mesh.faces[la.face[i]];
    const Face& fb = q.b.mesh.faces[lb.face[j]];
    for (int k = 0; k < 3; ++k) {
        a[k] = q.a.mesh.vertices[fa[k]];
        b[k] = apply(q.pose, q.b.mesh.vertices[fb[k]]);
    }
    int side_a[3], side_b[3];
    for (int k = 0; k < 3; ++k) side_a[k] = orient3d(b[0], b[1], b[2], a[k]);
    if (side_a[0] == side_a[1] && side_a[1] == side_a[2] && side_a[0] != 0) return false;
    for (int k = 0; k < 3; ++k) side_b[k] = orient3d(a[0], a[1], a[2], b[k]);
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

bool leaves_meet(const Query& q, const Leaf& la, const Leaf& lb) {
    FacesF a, b;
    float shift[3];
    const PairFrame& frame = q.frames.b_in_a;
    const Local local = load_leaves(la, lb, q.pose, frame, a, b, shift);

    // The faces of the larger box go first, against the other's small box; then the faces of that
    // against the box of what is left.
    uint32_t in_a, in_b;
    float lo[3], hi[3];
    if (size(la) > size(lb)) {
        for (int i = 0; i < 3; ++i) {
            const float h = std::fabs(frame.r[i][0]) * lb.half[0] + std::fabs(frame.r[i][1]) * lb.half[1] +
                            std::fabs(frame.r[i][2]) * lb.half[2];
            lo[i] = shift[i] - h;
            hi[i] = shift[i] + h;
        }
        if (!(in_a = reaching(a, lo, hi, local, la.valid))) return false;
        around(a, in_a, lo, hi);
        if (!(in_b = reaching(b, lo, hi, local, lb.valid))) return false;
    } else {
        for (int i = 0; i < 3; ++i) {
            lo[i] = -la.half[i];
            hi[i] = la.half[i];
        }
        if (!(in_b = reaching(b, lo, hi, local, lb.valid))) return false;
        around(b, in_b, lo, hi);
        if (!(in_a = reaching(a, lo, hi, local, la.valid))) return false;
    }

    if (__builtin_popcount(in_a) <= __builtin_popcount(in_b)) {
        for (; in_a; in_a &= in_a - 1) {
            const int i = __builtin_ctz(in_a);
            for (uint32_t m = crossing(a, i, b, local, in_b); m; m &= m - 1)
                if (faces_meet(q, la, i, lb, __builtin_ctz(m))) return true;
        }
    } else {
        for (; in_b; in_b &= in_b - 1) {
            const int j = __builtin_ctz(in_b);
            for (uint32_t m = crossing(b, j, a, local, in_a); m; m &= m - 1)
                if (faces_meet(q, la, __builtin_ctz(m), lb, j)) return true;
        }
    }
    return false;
}

// Whether a face of a leaf may meet a box. Asked before a box is opened against a leaf with larger faces:
// their planes tell more than the leaf's box.
bool reaches(const Leaf& leaf, const PlacedBox& box, float slack) {
    FacesF faces;
    load_faces(leaf, faces);
    float lo[3], hi[3], extent = 0;
    for (int i = 0; i < 3; ++i) {
        const float h = std::fabs(box.axis[0][i]) * box.h[0] + std::fabs(box.axis[1][i]) * box.h[1] +
                        std::fabs(box.axis[2][i]) * box.h[2] + slack;
        const float c = box.c[i] - leaf.centre[i];
        lo[i] = c - h;
        hi[i] = c + h;
        extent += std::fabs(c) + h;
    }
    return reaching(faces, lo, hi, local_errors(2 * size(leaf) + extent), leaf.valid) != 0;
}

bool surfaces_meet(const Query& q) {
    struct Pair {
        Ref a, b;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    const Tree &ta = q.a.tree, &tb = q.b.tree;
    const OrientedBox *boxes_a = ta.boxes.data(), *boxes_b = tb.boxes.data();
    const PairFrame &b_in_a = q.frames.b_in_a, &a_in_b = q.frames.a_in_b;
    F8 centres;
    stack[top++] = {0, 0};
    while (top) {
        const Pair pair = stack[--top];
        const OrientedBox &a = boxes_a[pair.a], &b = boxes_b[pair.b];
        const int32_t ca = a.child, cb = b.child;
        if (ca < 0 && cb < 0) {
            if (leaves_meet(q, ta.leaves[~ca], tb.leaves[~cb])) return true;
            continue;
        }
        if (ca < 0 && size(a) > size(b) && !reaches(ta.leaves[~ca], placed(b, b_in_a), b_in_a.slack)) continue;
        if (cb < 0 && size(b) > size(a) && !reaches(tb.leaves[~cb], placed(a, a_in_b), a_in_b.slack)) continue;
        const bool split_a = cb < 0 || (ca >= 0 && size(a) >= size(b));
        uint32_t m = split_a ? meeting(ta.oriented[ca], placed(b, b_in_a), b_in_a.slack, centres)
                             : meeting(tb.oriented[cb], placed(a, a_in_b), a_in_b.slack, centres);
        // The nearest comes first off the stack: that is where a hit is likeliest.
        for (float nearest = HUGE_VALF; m; m &= m - 1) {
            const int k = __builtin_ctz(m);
            stack[top] = split_a ? Pair{static_cast<Ref>(lanes * ca + k), pair.b}
                                 : Pair{pair.a, static_cast<Ref>(lanes * cb + k)};
            if (centres[k] < nearest) nearest = centres[k];
            else {
                const Pair last = stack[top];
                stack[top] = stack[top - 1];
                stack[top - 1] = last;
            }
            ++top;
        }
    }
    return false;
}

bool is_any_around(const PackedBoxes& boxes, const Box& inner) {
    BoxSearch search = search_boxes(boxes, inner.lo, inner.hi);
    return next(search) >= 0;
}

// A part of `inner` is inside `outer`, given that their surfaces do not meet. Asked are the parts whose
// first point is within outer's bounds, if all their points are within the bounds of one closed shell.
bool contained(const Shape& inner, const Shape& outer, const Rigid& inner_in_outer,
               const PairFrame& outer_frame, Vec3& point) {
    if (inner.smallest_part > 1.001 * outer.largest_solid) return false;
    const BoxF around = placed(box_of(outer.tree, 0), outer_frame);
    const Vec3 lo{around.c[0] - around.h[0], around.c[1] - around.h[1], around.c[2] - around.h[2]};
    const Vec3 hi{around.c[0] + around.h[0], around.c[1] + around.h[1], around.c[2] + around.h[2]};
    BoxSearch near = search_boxes(inner.anchors, hi, lo);
    for (int32_t index; (index = next(near)) >= 0;) {
        const Vec3 first = apply(inner_in_outer, inner.parts[index][0]);
        if (!is_any_around(outer.solids, {first, first})) continue;
        Box part{first, first};
        for (const Vec3& p : inner.parts[index]) grow(part, apply(inner_in_outer, p));
        if (!is_any_around(outer.solids, part)) continue;
        bool touching = false;
        point = inner.parts[index][0];
        if (winding(outer, first, touching) != 0 || touching) return true;
    }
    return false;
}

// The published form: the mover's head-to-tail chords against the target's faces.
bool chords_meet(const Shape& a, const Shape& b, const Rigid& pose, Witness* witness) {
    const Rigid a_in_b = inverse(pose);
    for (size_t i = 0; i < a.graph.edges.size(); ++i) {
        const Vec3 p = a.mesh.vertices[a.graph.points[a.graph.edges[i][0]]];
        const Vec3 q = a.mesh.vertices[a.graph.points[a.graph.edges[i][1]]];
        const int32_t face = segment(b, apply(a_in_b, p), apply(a_in_b, q));
        if (face < 0) continue;
        if (witness)
            *witness = {Witness::chord_of_a, -1, face, static_cast<int32_t>(i), {0, 0, 0}};
        return true;
    }
    return false;
}

}  // namespace

bool collide(const Shape& a, const Shape& b, const Rigid& pose, bool lossless, Witness* witness) {
    if (!lossless && (a.graph.settings.method == Method::loop || b.graph.settings.method == Method::loop))
        return chords_meet(a, b, pose, witness);
    const Query query{a, b, pose, pair_frames(a, b, pose), lossless ? 3 : 0, witness};
    F8 centres;
    const PairFrame& frame = query.frames.b_in_a;
    if (!meeting(a.tree.oriented[0], placed(b.tree.boxes[0], frame), frame.slack, centres)) return false;
    if (surfaces_meet(query)) return true;
    Vec3 point;
    Witness::Side side = Witness::none;
    if (contained(b, a, pose, query.frames.a_in_b, point)) side = Witness::b_inside_a;
    else if (contained(a, b, inverse(pose), query.frames.b_in_a, point)) side = Witness::a_inside_b;
    if (side == Witness::none) return false;
    if (witness) *witness = {side, -1, -1, -1, point};
    return true;
}

}  // namespace fgenv::FGENV_ISA
