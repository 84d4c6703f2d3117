// The last test: does an edge meet a face? Closed (touching counts) and exact for the vertices given.
#pragma once

#include "math/lanes.h"
#include "math/predicates.h"

namespace fgenv {

// Three points side by side; the fourth lane repeats the third.
struct Three {
    D4 x, y, z;
};

FGENV_INLINE Three three(Vec3 p, Vec3 q, Vec3 r) {
    return {D4{p.x, q.x, r.x, r.x}, D4{p.y, q.y, r.y, r.y}, D4{p.z, q.z, r.z, r.z}};
}
FGENV_INLINE Three three(Vec3 p) { return {splat(p.x), splat(p.y), splat(p.z)}; }
FGENV_INLINE Three operator-(const Three& p, const Three& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
FGENV_INLINE Vec3 lane(const Three& p, int k) { return {p.x[k], p.y[k], p.z[k]}; }

// Three signs of orient3d at once, by the same filter.
static inline void orient3d(const Three& a, const Three& b, const Three& c, const Three& d, int (&sign)[3]) {
    const Three ad = a - d, bd = b - d, cd = c - d;
    const D4 bc = bd.x * cd.y, cb = cd.x * bd.y;
    const D4 ca = cd.x * ad.y, ac = ad.x * cd.y;
    const D4 ab = ad.x * bd.y, ba = bd.x * ad.y;
    const D4 det = ad.z * (bc - cb) + bd.z * (ca - ac) + cd.z * (ab - ba);
    const D4 bound = splat(orient3d_bound) * ((abs(bc) + abs(cb)) * abs(ad.z) + (abs(ca) + abs(ac)) * abs(bd.z) +
                                              (abs(ab) + abs(ba)) * abs(cd.z));
    for (int k = 0; k < 3; ++k)
        sign[k] = det[k] > bound[k]    ? 1
                  : det[k] < -bound[k] ? -1
                                       : orient3d_exact(lane(a, k), lane(b, k), lane(c, k), lane(d, k));
}

static inline bool on_segment_2d(const double a[2], const double b[2], const double p[2]) {
    return lesser(a[0], b[0]) <= p[0] && p[0] <= greater(a[0], b[0]) && lesser(a[1], b[1]) <= p[1] &&
           p[1] <= greater(a[1], b[1]);
}

static inline bool segments_meet_2d(const double p[2], const double q[2], const double a[2], const double b[2]) {
    const int pa = orient2d(p, q, a), pb = orient2d(p, q, b);
    const int ap = orient2d(a, b, p), aq = orient2d(a, b, q);
    if (pa * pb < 0 && ap * aq < 0) return true;
    return (pa == 0 && on_segment_2d(p, q, a)) || (pb == 0 && on_segment_2d(p, q, b)) ||
           (ap == 0 && on_segment_2d(a, b, p)) || (aq == 0 && on_segment_2d(a, b, q));
}

static inline bool in_triangle_2d(const double t[3][2], int turn, const double p[2]) {
    return turn * orient2d(t[0], t[1], p) >= 0 && turn * orient2d(t[1], t[2], p) >= 0 &&
           turn * orient2d(t[2], t[0], p) >= 0;
}

// Segment pq in the plane of face f: both are seen along an axis along which the face has area.
static inline bool coplanar_meet(Vec3 p, Vec3 q, const Vec3 f[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        double t[3][2];
        for (int i = 0; i < 3; ++i) {
            t[i][0] = coordinate(f[i], u);
            t[i][1] = coordinate(f[i], v);
        }
        const int turn = orient2d(t[0], t[1], t[2]);
        if (turn == 0) continue;
        const double p2[2] = {coordinate(p, u), coordinate(p, v)};
        const double q2[2] = {coordinate(q, u), coordinate(q, v)};
        return in_triangle_2d(t, turn, p2) || segments_meet_2d(p2, q2, t[0], t[1]) ||
               segments_meet_2d(p2, q2, t[1], t[2]) || segments_meet_2d(p2, q2, t[2], t[0]);
    }
    return false;  // placing it flattened the face to a line: its neighbors' faces hold that line
}

// Segment pq against face f, given on which sides of the face's plane p and q lie.
static inline bool edge_meets_face(Vec3 p, int side_p, Vec3 q, int side_q, const Vec3 f[3]) {
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return coplanar_meet(p, q, f);
    int s[3];
    orient3d(three(p), three(q), three(f[0], f[1], f[2]), three(f[1], f[2], f[0]), s);
    return s[0] * s[1] >= 0 && s[1] * s[2] >= 0 && s[2] * s[0] >= 0;
}

static inline bool edge_meets_face(Vec3 p, Vec3 q, const Vec3 f[3]) {
    return edge_meets_face(p, orient3d(f[0], f[1], f[2], p), q, orient3d(f[0], f[1], f[2], q), f);
}

}  // namespace fgenv
