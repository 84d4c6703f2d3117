// Evidence of a collision of two shapes, as a point and a direction.
#include "query/contact.h"

namespace fgenv {
namespace {

Vec3 face_normal(const Shape& s, int32_t face) { return unit(area_vector(s.mesh, face)); }

// Intersection of line pq with the plane of face f; if pq lies in the plane, the middle of its part inside f.
Vec3 crossing_point(Vec3 p, Vec3 q, const Vec3 f[3]) {
    const Vec3 n = cross(f[1] - f[0], f[2] - f[0]);
    const double hp = dot(n, p - f[0]), hq = dot(n, q - f[0]);
    if (hp == hq) {
        // pq lies in the plane: clip it by the face's three sides.
        double lo = 0, hi = 1;
        for (int k = 0; k < 3; ++k) {
            const Vec3 outward = cross(f[(k + 1) % 3] - f[k], n);
            const double op = dot(outward, p - f[k]), oq = dot(outward, q - f[k]);
            if (op == oq) continue;
            const double at = op / (op - oq);
            if (oq > op)
                hi = lesser(hi, at);
            else
                lo = greater(lo, at);
        }
        return p + 0.5 * (lesser(greater(lo, 0), 1) + lesser(greater(hi, 0), 1)) * (q - p);
    }
    return p + lesser(greater(hp / (hp - hq), 0.0), 1.0) * (q - p);
}

}  // namespace

ContactInfo contact_of(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb, bool lossless) {
    const Rigid pose = relative(ta, tb);
    Witness w;
    ContactInfo out;
    out.hit = kernels().collide(a, b, pose, lossless, &w);
    if (!out.hit) return out;
    if (w.side == Witness::a_inside_b || w.side == Witness::b_inside_a) {
        out.point = apply(w.side == Witness::a_inside_b ? ta : tb, w.point);
        const Nearest way = nearest_pair(a, ta, b, tb);  // the shortest way out, for either
        out.normal = unit(rotate(ta, way.on_b - way.on_a));
        return out;
    }
    const auto corner = [](const Shape& s, const Rigid& t, int32_t face, int k) {
        return apply(t, s.mesh.vertices[s.mesh.faces[face][k]]);
    };
    out.has_edge = true;
    out.edge_of_a = w.side != Witness::edge_of_b;
    const Shape &mover = out.edge_of_a ? a : b, &target = out.edge_of_a ? b : a;
    const Rigid &t_mover = out.edge_of_a ? ta : tb, &t_target = out.edge_of_a ? tb : ta;
    out.face = out.edge_of_a ? w.face_b : w.face_a;
    for (int k = 0; k < 2; ++k)
        out.edge[k] = w.side == Witness::chord_of_a
                          ? apply(ta, a.mesh.vertices[a.graph.points[a.graph.edges[w.edge][k]]])
                          : corner(mover, t_mover, out.edge_of_a ? w.face_a : w.face_b, (w.edge + k) % 3);
    const Vec3 f[3] = {corner(target, t_target, out.face, 0), corner(target, t_target, out.face, 1),
                       corner(target, t_target, out.face, 2)};
    out.point = crossing_point(out.edge[0], out.edge[1], f);
    const Vec3 n = rotate(t_target, face_normal(target, out.face));
    out.normal = out.edge_of_a ? n : -1.0 * n;
    return out;
}

}  // namespace fgenv
