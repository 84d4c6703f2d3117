#include "query/tree_heights.h"

#include "math/rotation.h"
#include "query/gjk.h"

namespace fgenv {
namespace {

template <class Height>
double highest(const Shape& s, Ref ref, const Height& height, double* out) {
    const int32_t child = s.tree.boxes[ref].child;
    double top = -HUGE_VAL;
    if (child < 0) {
        const Leaf& leaf = s.tree.leaves[~child];
        for (uint32_t m = leaf.valid; m; m &= m - 1)
            for (int k = 0; k < 3; ++k) top = greater(top, height(s.mesh.vertices[leaf.vertex[k][__builtin_ctz(m)]]));
    } else {
        const Node& node = s.tree.nodes[child];
        for (int lane = 0; lane < lanes; ++lane)
            if (node.half[0][lane] >= 0)
                top = greater(top, highest(s, static_cast<Ref>(lanes * child + lane), height, out));
    }
    out[ref] = top;
    return top;
}

Vec3 farthest(const Shape& s, Vec3 along) {
    Vec3 out = s.mesh.vertices[0];
    double most = -HUGE_VAL;
    for (const Vec3& p : s.mesh.vertices)
        if (const double height = dot(along, p); height > most) {
            most = height;
            out = p;
        }
    return out;
}

double gap(const TreeHeights& h, Vec3 n) {
    return dot(n, apply(h.pose, farthest(h.b, -1.0 * unrotate(h.pose, n))) - farthest(h.a, n));
}

}  // namespace

TreeHeights* new_heights(const Shape& a, const Shape& b, const Rigid& pose) {
    const double coordinates = norm({pose.t[0], pose.t[1], pose.t[2]}) + 1.8 * (a.reach + b.reach);
    return new TreeHeights{
        a, b, pose, 4e-15 * coordinates, new double[a.tree.boxes.size()], new double[b.tree.boxes.size()]};
}

void measure(TreeHeights& h, Vec3 normal) {
    const Vec3 between_hulls = unit(direction_apart(
        [&](Vec3 n) { return apply(h.pose, farthest(h.b, -1.0 * unrotate(h.pose, n))) - farthest(h.a, n); }, normal,
        1e-15));
    if (gap(h, between_hulls) > gap(h, normal)) normal = between_hulls;
    highest(h.a, 0, [&](Vec3 p) { return dot(normal, p); }, h.top);
    highest(h.b, 0, [&](Vec3 p) { return -dot(normal, apply(h.pose, p)); }, h.bottom);
    for (size_t i = 0; i < h.b.tree.boxes.size(); ++i) h.bottom[i] = -h.bottom[i];
}

void free_heights(TreeHeights* h) {
    delete[] h->top;
    delete[] h->bottom;
    delete h;
}

}  // namespace fgenv
