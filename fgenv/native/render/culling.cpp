#include "render/culling.h"

namespace fgenv {
namespace {

constexpr double behind = 1e-9;  // meters ahead: less is behind the eye

}  // namespace

SunFrame sun_frame(Vec3 to) {
    const Vec3 aside = std::fabs(to.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const Vec3 u = unit(cross(aside, to));
    return {u, cross(to, u), to};
}

PixelBox pixel_box(const Camera& camera, const Vec3* points, int n, double& nearest) {
    PixelBox box{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    nearest = HUGE_VAL;
    double farthest = -HUGE_VAL;
    for (int k = 0; k < n; ++k) {
        const Vec3 d = points[k] - camera.eye;
        const double depth = dot(camera.ahead, d), scale = camera.pixels_per_slope / greater(depth, behind);
        nearest = lesser(nearest, depth);
        farthest = greater(farthest, depth);
        const double at[2] = {0.5 * camera.width + dot(camera.right, d) * scale,
                              0.5 * camera.height + dot(camera.down, d) * scale};
        for (int i = 0; i < 2; ++i) {
            box.lo[i] = lesser(box.lo[i], at[i]);
            box.hi[i] = greater(box.hi[i], at[i]);
        }
    }
    if (farthest < behind) return {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    if (nearest < behind) return {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}};
    return box;
}

Placed place(const Shape& shape, int32_t body, const Rigid& pose, const Camera& camera, const SunFrame& sun) {
    Placed out;
    out.shape = &shape;
    out.body = body;
    out.pose = pose;
    out.back = inverse(pose);
    out.eye = apply(out.back, camera.eye);
    out.sun = rotate(out.back, sun.to);
    out.sun_inverse = inverse_of(out.sun);
    const Box& b = shape.mesh.bounds;
    Vec3 corners[8];
    out.shade = empty_box();
    for (int k = 0; k < 8; ++k) {
        corners[k] = apply(pose, {k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z});
        grow(out.shade, in_sun_frame(sun, corners[k]));
    }
    out.box = pixel_box(camera, corners, 8, out.nearest);
    return out;
}

}  // namespace fgenv
