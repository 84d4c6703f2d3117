// Certifies which pairs of moving faces stay apart around a moment, four pairs at a time, by the plane
// between their nearest points (conservative advancement, as FaceAdvance in face_advance.h).
#include "query/faces4.h"
#include "query/kernels.h"

namespace fgenv::FGENV_ISA {
namespace {

FGENV_INLINE D4 root(D4 x) {
    D4 out;
    for (int k = 0; k < width; ++k) out[k] = std::sqrt(x[k]);
    return out;
}

// Shortest vector from f to g, and its squared length.
FGENV_INLINE void shortest_way(const Faces& f, const Faces& g, V4 way) {
    D4 best = splat(HUGE_VAL), s, t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const D4 d = segments(f.v[i], f.side[i], f.length[i], f.inv_length[i], g.v[j], g.side[j], g.length[j],
                                  g.inv_length[j], s, t);
            const L4 nearer = d < best;
            best = nearer ? d : best;
            for (int x = 0; x < 3; ++x)
                way[x] = nearer ? g.v[j][x] + t * g.side[j][x] - f.v[i][x] - s * f.side[i][x] : way[x];
        }
    for (int i = 0; i < 3; ++i)
        for (int side = 0; side < 2; ++side) {
            const Faces &from = side ? g : f, &to = side ? f : g;
            const D4 d = above_face(from.v[i], to);
            V4 r;
            subtract(from.v[i], to.v[2], r);
            const D4 height = dot(r, to.n) * to.inv_n;
            const L4 nearer = d < best;
            best = nearer ? d : best;
            for (int x = 0; x < 3; ++x) way[x] = nearer ? (side ? height : -height) * to.n[x] : way[x];
        }
}

struct Extremes {
    D4 least, most;
};

FGENV_INLINE Extremes along(const V4 n, const V4 (&p)[3]) {
    const D4 a = dot(n, p[0]), b = dot(n, p[1]), c = dot(n, p[2]);
    return {min(min(a, b), c), max(max(a, b), c)};
}

// Velocities along n of corners at `arm` from an origin.
FGENV_INLINE Extremes rates(const V4 n, const V4 (&arm)[3], Vec3 v, Vec3 w) {
    // n . (v + w x r) = n . v + (n x w) . r
    const V4 turn = {n[1] * w.z - n[2] * w.y, n[2] * w.x - n[0] * w.z, n[0] * w.y - n[1] * w.x};
    const D4 shift = n[0] * v.x + n[1] * v.y + n[2] * v.z;
    const Extremes e = along(turn, arm);
    return {e.least + shift, e.most + shift};
}

FGENV_INLINE D4 farthest(const V4 (&arm)[3]) {
    return root(max(max(dot(arm[0], arm[0]), dot(arm[1], arm[1])), dot(arm[2], arm[2])));
}

}  // namespace

int drop_separated(const Shape& a, const Shape& b, const SeparationWindow& m, FacePair* pairs, int count) {
    int left = 0;
    for (int first = 0; first < count; first += width) {
        Points pa[3], pb[3];
        for (int l = 0; l < width; ++l) {
            const FacePair pair = pairs[first + l < count ? first + l : count - 1];
            for (int k = 0; k < 3; ++k) {
                put(pa[k], l, rotate(m.a, a.mesh.vertices[a.mesh.faces[pair.a][k]]));
                put(pb[k], l, rotate(m.b, b.mesh.vertices[b.mesh.faces[pair.b][k]]));
            }
        }
        Faces f, g;
        V4 arm_a[3];
        for (int k = 0; k < 3; ++k) {
            read(pa[k], arm_a[k]);
            read(pb[k], g.v[k]);
            for (int x = 0; x < 3; ++x) f.v[k][x] = arm_a[k][x] + splat(m.a.t[x]);
        }
        derive(f);
        derive(g);
        V4 n = {};
        shortest_way(f, g, n);
        const D4 inverse = reciprocal(root(dot(n, n)));
        for (int x = 0; x < 3; ++x) n[x] = n[x] * inverse;
        const D4 gap = along(n, g.v).least - along(n, f.v).most - splat(m.margin + m.slack);
        const Extremes ra = rates(n, arm_a, m.va, m.wa), rb = rates(n, g.v, m.vb, m.wb);
        const D4 bend =
            splat(0.5) * (splat(m.acceleration_a[0] + m.acceleration_b[0]) +
                          splat(m.acceleration_a[1]) * farthest(arm_a) + splat(m.acceleration_b[1]) * farthest(g.v));
        const D4 after = splat(m.after), before = splat(m.before);
        const L4 apart = (gap > (ra.most - rb.least) * after + bend * after * after) &
                         (gap > (rb.most - ra.least) * before + bend * before * before) & (gap > splat(0.0));
        for (int l = 0; l < width && first + l < count; ++l)
            if (!apart[l]) pairs[left++] = pairs[first + l];
    }
    return left;
}

}  // namespace fgenv::FGENV_ISA
