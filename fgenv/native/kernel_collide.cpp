// Boolean query: dual descent with oriented culling, then edges against faces, then containment.
// S. Gottschalk et al., "OBBTree", 1996, for the separating axes of boxes; T. Moeller, "A fast
// triangle-triangle intersection test", 1997, for the order of the leaf tests.
#include "edge_face.h"
#include "kernels.h"
#include "pair_frame.h"

#ifdef COUNT
namespace fgenv { extern long cnt[16]; }
#define C_(i) (++fgenv::cnt[i])
#define CN_(i,n) (fgenv::cnt[i]+=(n))
#else
#define C_(i) ((void)0)
#define CN_(i,n) ((void)0)
#endif
namespace fgenv::FGENV_ISA {

int winding(const Shape& shape, Vec3 p, bool& touching);
int32_t segment(const Shape& shape, Vec3 p, Vec3 q);

namespace {

struct Query {
    const Shape& a;
    const Shape& b;
    const Rigid& pose;  // b in a's frame
    PairFrames frames;
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

// Which of a node's eight boxes meet `box`: separating axes are the faces' normals of both, then the
// products of their edges.
FGENV_INLINE uint32_t meeting(const Oriented& n, const OrientedBoxF& box, float slack) {
    C_(0);
    F8 d[3], r[3][3], abs_r[3][3], along_n[3], along_b[3], h[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = load(n.centre[k]) - splat(box.c[k]);
        h[k] = load(n.half[k]);
    }
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i) {
        const F8 x = load(n.axis[i][0]), y = load(n.axis[i][1]), z = load(n.axis[i][2]);
        along_n[i] = d[0] * x + d[1] * y + d[2] * z;
        F8 radius = h[i] + splat(slack);
        for (int j = 0; j < 3; ++j) {
            r[i][j] = x * splat(box.axis[j][0]) + y * splat(box.axis[j][1]) + z * splat(box.axis[j][2]);
            abs_r[i][j] = abs(r[i][j]);
            radius += abs_r[i][j] * splat(box.h[j]);
        }
        meet &= abs(along_n[i]) <= radius;
    }
    for (int j = 0; j < 3; ++j) {
        along_b[j] = d[0] * splat(box.axis[j][0]) + d[1] * splat(box.axis[j][1]) + d[2] * splat(box.axis[j][2]);
        const F8 radius = h[0] * abs_r[0][j] + h[1] * abs_r[1][j] + h[2] * abs_r[2][j] + splat(box.h[j] + slack);
        meet &= abs(along_b[j]) <= radius;
    }
#ifndef NO9
    if (!bits(meet)) return 0;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const F8 along = along_n[i2] * r[i1][j] - along_n[i1] * r[i2][j];
            const F8 radius = h[i1] * abs_r[i2][j] + h[i2] * abs_r[i1][j] + splat(box.h[j1]) * abs_r[i][j2] +
                              splat(box.h[j2]) * abs_r[i][j1] + splat(2 * slack);
            meet &= abs(along) <= radius;
        }
    }
#endif
    return bits(meet);
}

// Eight faces with what the culling tests need of them.
struct Faces {
    F8 v[3][3];  // vertex, axis
    F8 n[3];     // normal, not normalised
    F8 lo[3], hi[3];
    F8 scale;    // sum of the lengths of two sides (1-norm)
};

// Float errors of a leaf pair in the frame of a's leaf, where coordinates are no larger than `size`.
// A coordinate is off by less than `slack`: rounding the vertex, the rotation, three products, the sums
// (10 units at most). A volume is a determinant of three differences, each off by 2 slack: for the
// differences u, v, w it is off by less than volume_slack (|u||v| + |v||w| + |w||u|) in 1-norms.
struct Local {
    float size, slack, volume_slack;
};

FGENV_INLINE void load_faces(const Leaf& leaf, Faces& out) {
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) out.v[k][i] = load(leaf.v[k][i]);
}

// Turned, then moved by `shift`.
FGENV_INLINE void load_faces(const Leaf& leaf, const float r[3][3], const float shift[3], Faces& out) {
    for (int k = 0; k < 3; ++k) {
        const F8 x = load(leaf.v[k][0]), y = load(leaf.v[k][1]), z = load(leaf.v[k][2]);
        for (int i = 0; i < 3; ++i)
            out.v[k][i] = splat(r[i][0]) * x + splat(r[i][1]) * y + splat(r[i][2]) * z + splat(shift[i]);
    }
}

FGENV_INLINE void find_boxes(Faces& f) {
    for (int i = 0; i < 3; ++i) {
        f.lo[i] = min(min(f.v[0][i], f.v[1][i]), f.v[2][i]);
        f.hi[i] = max(max(f.v[0][i], f.v[1][i]), f.v[2][i]);
    }
}

FGENV_INLINE void find_normals(Faces& f) {
    F8 u[3], w[3];
    f.scale = F8{};
    for (int i = 0; i < 3; ++i) {
        u[i] = f.v[1][i] - f.v[0][i];
        w[i] = f.v[2][i] - f.v[0][i];
        f.scale += abs(u[i]) + abs(w[i]);
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        f.n[i] = u[j] * w[k] - u[k] * w[j];
    }
}

// Which faces may meet a box: the box's axes, then their own planes.
FGENV_INLINE uint32_t reaching(Faces& f, const float lo[3], const float hi[3], const Local& local,
                               uint32_t among) {
    find_boxes(f);
    I8 meet = I8{} == 0;
    for (int i = 0; i < 3; ++i)
        meet &= (f.lo[i] <= splat(hi[i] + local.slack)) & (f.hi[i] >= splat(lo[i] - local.slack));
    among &= bits(meet);
    if (!among) return 0;
    find_normals(f);
    F8 at_centre = F8{}, radius = f.scale * splat(local.volume_slack * local.size);
    for (int i = 0; i < 3; ++i) {
        at_centre += f.n[i] * (splat(0.5f * (lo[i] + hi[i])) - f.v[0][i]);
        radius += abs(f.n[i]) * splat(0.5f * (hi[i] - lo[i]) + local.slack);
    }
    return among & bits(abs(at_centre) <= radius);
}

FGENV_INLINE float size(const BoxF& box) { return box.h[0] + box.h[1] + box.h[2]; }

// The box around some of eight faces.
FGENV_INLINE void around(const Faces& f, uint32_t among, float lo[3], float hi[3]) {
    for (int i = 0; i < 3; ++i) {
        lo[i] = 1e30f;
        hi[i] = -1e30f;
    }
    for (; among; among &= among - 1) {
        const int k = __builtin_ctz(among);
        for (int i = 0; i < 3; ++i) {
            lo[i] = f.lo[i][k] < lo[i] ? f.lo[i][k] : lo[i];
            hi[i] = f.hi[i][k] > hi[i] ? f.hi[i][k] : hi[i];
        }
    }
}

// Which of eight faces g may meet face i of f: boxes, the two planes, then the nine products of sides.
// For the axis u x w of sides u of f and w of g the shapes' extents along it are the plane values
// already at hand (n_f . w and n_g . u), so one triple product an axis is left.
FGENV_INLINE uint32_t crossing(const Faces& f, int i, const Faces& g, const Local& local,
                               uint32_t among) {
    I8 meet = I8{} == 0;
    for (int x = 0; x < 3; ++x)
        meet &= (g.lo[x] <= splat(f.hi[x][i] + local.slack)) &
                (g.hi[x] >= splat(f.lo[x][i] - local.slack));
    among &= bits(meet);
    C_(8);if (!among) return 0;C_(9);

    const F8 zero = F8{};
    const F8 reach = (g.scale + splat(f.scale[i])) * splat(local.volume_slack);  // boxes meet: all is near
    const F8 own = reach * splat(f.scale[i]), theirs = reach * g.scale;
    F8 g_side[3], f_side[3];  // of the plane of the other
    for (int k = 0; k < 3; ++k) {
        g_side[k] = zero;
        for (int x = 0; x < 3; ++x) g_side[k] += splat(f.n[x][i]) * (g.v[k][x] - splat(f.v[0][x][i]));
    }
    meet = (min(min(g_side[0], g_side[1]), g_side[2]) <= own) &
           (max(max(g_side[0], g_side[1]), g_side[2]) >= -own);
    among &= bits(meet);
    if (!among) return 0;C_(10);

    for (int k = 0; k < 3; ++k) {
        f_side[k] = zero;
        for (int x = 0; x < 3; ++x) f_side[k] += g.n[x] * (splat(f.v[k][x][i]) - g.v[0][x]);
    }
    meet = (min(min(f_side[0], f_side[1]), f_side[2]) <= theirs) &
           (max(max(f_side[0], f_side[1]), f_side[2]) >= -theirs);
    among &= bits(meet);
    if (!among) return 0;C_(11);CN_(12,__builtin_popcount(among));

    const F8 both = own + theirs;
    for (int k = 0; k < 3; ++k) {
        F8 u[3];
        for (int x = 0; x < 3; ++x) u[x] = splat(f.v[(k + 1) % 3][x][i] - f.v[k][x][i]);
        const F8 g_extent = f_side[(k + 1) % 3] - f_side[k];  // n_g . u
        for (int l = 0; l < 3; ++l) {
            F8 w[3], q[3];
            for (int x = 0; x < 3; ++x) {
                w[x] = g.v[(l + 1) % 3][x] - g.v[l][x];
                q[x] = g.v[l][x] - splat(f.v[k][x][i]);
            }
            const F8 at = (u[1] * w[2] - u[2] * w[1]) * q[0] + (u[2] * w[0] - u[0] * w[2]) * q[1] +
                          (u[0] * w[1] - u[1] * w[0]) * q[2];
            const F8 f_extent = g_side[l] - g_side[(l + 1) % 3];  // -n_f . w
            meet &= (at + min(g_extent, zero) <= max(f_extent, zero) + both) &
                    (at + max(g_extent, zero) >= min(f_extent, zero) - both);
        }
    }
    return among & bits(meet);
}

// The verdict on two faces: the graph's edges of each against the other, exact, on one set of vertices.
bool faces_meet(const Query& q, const Leaf& la, int i, const Leaf& lb, int j) {
    C_(6);
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
        if (la.edges[i] >> k & 1 && edge_meets_face(a[k], side_a[k], a[l], side_a[l], b))
            found = Witness::edge_of_a;
        else if (lb.edges[j] >> k & 1 && edge_meets_face(b[k], side_b[k], b[l], side_b[l], a))
            found = Witness::edge_of_b;
        if (found == Witness::none) continue;
        if (q.witness) *q.witness = {found, la.face[i], lb.face[j], k, {0, 0, 0}};
        return true;
    }
    return false;
}

bool leaves_meet(const Query& q, const Leaf& la, const BoxF& box_a, const Leaf& lb, const BoxF& box_b) {
    C_(1);
    // b's leaf seen from the centre of a's. The centres are subtracted in double.
    const Vec3 centre = apply(q.pose, {box_b.c[0], box_b.c[1], box_b.c[2]}) -
                        Vec3{box_a.c[0], box_a.c[1], box_a.c[2]};
    const float shift[3] = {static_cast<float>(centre.x), static_cast<float>(centre.y),
                            static_cast<float>(centre.z)};
    const PairFrame& frame = q.frames.b_in_a;
    Local local;
    local.size = 2 * (size(box_a) + size(box_b)) + std::fabs(shift[0]) + std::fabs(shift[1]) + std::fabs(shift[2]);
    local.slack = 10 * 0x1p-24f * local.size;
    local.volume_slack = 4 * local.slack;

    // The faces of the larger box go first, against the other's small box; then the faces of that
    // against the box of what is left.
    Faces a, b;
    load_faces(la, a);
    load_faces(lb, frame.r, shift, b);
    uint32_t in_a, in_b;
    float lo[3], hi[3];
    if (size(box_a) > size(box_b)) {
        for (int i = 0; i < 3; ++i) {
            const float h = frame.abs_r[i][0] * box_b.h[0] + frame.abs_r[i][1] * box_b.h[1] +
                            frame.abs_r[i][2] * box_b.h[2];
            lo[i] = shift[i] - h;
            hi[i] = shift[i] + h;
        }
        if (!(in_a = reaching(a, lo, hi, local, la.valid))) return false;
        C_(2);
        around(a, in_a, lo, hi);
        if (!(in_b = reaching(b, lo, hi, local, lb.valid))) return false;
    } else {
        for (int i = 0; i < 3; ++i) {
            lo[i] = -box_a.h[i];
            hi[i] = box_a.h[i];
        }
        if (!(in_b = reaching(b, lo, hi, local, lb.valid))) return false;
        C_(2);
        around(b, in_b, lo, hi);
        if (!(in_a = reaching(a, lo, hi, local, la.valid))) return false;
    }
    C_(4);CN_(3,__builtin_popcount(in_b));CN_(5,__builtin_popcount(in_a));

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

bool surfaces_meet(const Query& q) {
    struct Pair {
        Ref a, b;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    const Tree &ta = q.a.tree, &tb = q.b.tree;
    const PairFrame &b_in_a = q.frames.b_in_a, &a_in_b = q.frames.a_in_b;
    if (!(meeting(ta.oriented[0], placed(oriented_box(tb, 0), b_in_a), b_in_a.slack) & 1)) return false;
    stack[top++] = {0, 0};
    while (top) {
        const Pair pair = stack[--top];
        const int32_t ca = child_of(ta, pair.a), cb = child_of(tb, pair.b);
        const BoxF box_a = box_of(ta, pair.a), box_b = box_of(tb, pair.b);
        if (ca < 0 && cb < 0) {
            if (leaves_meet(q, ta.leaves[~ca], box_a, tb.leaves[~cb], box_b)) return true;
            continue;
        }
        if (cb < 0 || (ca >= 0 && size(box_a) >= size(box_b))) {
            const uint32_t m = meeting(ta.oriented[ca], placed(oriented_box(tb, pair.b), b_in_a), b_in_a.slack);
            for (uint32_t s = m; s; s &= s - 1)
                stack[top++] = {static_cast<Ref>(lanes * ca + __builtin_ctz(s)), pair.b};
        } else {
            const uint32_t m = meeting(tb.oriented[cb], placed(oriented_box(ta, pair.a), a_in_b), a_in_b.slack);
            for (uint32_t s = m; s; s &= s - 1)
                stack[top++] = {pair.a, static_cast<Ref>(lanes * cb + __builtin_ctz(s))};
        }
    }
    return false;
}

// A part of `inner` is inside `outer`, given that their surfaces do not meet.
bool contained(const Shape& inner, const Shape& outer, const Rigid& inner_in_outer, Vec3& point) {
    if (!outer.solid) return false;
    for (const Part& part : inner.parts) {
        bool fits = true;
        for (const Vec3& p : part)
            if (!inside(outer.mesh.bounds, apply(inner_in_outer, p))) {
                fits = false;
                break;
            }
        if (!fits) continue;
        bool touching = false;
        if (winding(outer, apply(inner_in_outer, part[0]), touching) != 0 || touching) {
            point = part[0];
            return true;
        }
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

bool collide(const Shape& a, const Shape& b, const Rigid& pose, Witness* witness) {
    if (a.graph.settings.method == Method::loop || b.graph.settings.method == Method::loop)
        return chords_meet(a, b, pose, witness);
    const Query query{a, b, pose, pair_frames(a, b, pose), witness};
    if (surfaces_meet(query)) return true;
    Vec3 point;
    Witness::Side side = Witness::none;
    if (contained(b, a, pose, point)) side = Witness::b_inside_a;
    else if (a.parts.size() && b.solid && contained(a, b, inverse(pose), point)) side = Witness::a_inside_b;
    if (side == Witness::none) return false;
    if (witness) *witness = {side, -1, -1, -1, point};
    return true;
}

}  // namespace fgenv::FGENV_ISA
