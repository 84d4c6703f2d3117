// A body where it stands, as seen from the eye and from the sun: bounds to leave it out by, and rays in
// its own frame.
#pragma once

#include "query/kernels.h"

namespace fgenv {

struct Camera {
    Vec3 eye, right, down, ahead;  // unit vectors
    double pixels_per_slope;       // pixels that a meter takes up at a meter ahead
    int width, height;
};

// Axes across the sun's rays, and to the sun.
struct SunFrame {
    Vec3 u, v, to;
};

struct PixelBox {
    double lo[2], hi[2];  // columns, rows
};

static inline bool overlap(const PixelBox& a, const PixelBox& b) {
    return a.lo[0] <= b.hi[0] && b.lo[0] <= a.hi[0] && a.lo[1] <= b.hi[1] && b.lo[1] <= a.hi[1];
}

struct Placed {
    const Shape* shape;
    int32_t body;
    Rigid pose, back;
    Vec3 eye, sun, sun_inverse;  // in the body's frame
    PixelBox box;
    double nearest;  // depth ahead, meters: none of it is nearer
    Box shade;       // in the sun's frame
};

Placed place(const Shape& shape, int32_t body, const Rigid& pose, const Camera& camera, const SunFrame& sun);
SunFrame sun_frame(Vec3 to);
// Bounds of points in the picture: empty if all are behind the eye, the whole plane if some are.
PixelBox pixel_box(const Camera& camera, const Vec3* points, int n, double& nearest);

static inline Vec3 in_sun_frame(const SunFrame& sun, Vec3 p) { return {dot(sun.u, p), dot(sun.v, p), dot(sun.to, p)}; }

// Unit vector through a place on the picture; the middle of the pixel in the top left corner is (0.5, 0.5).
static inline Vec3 ray_through(const Camera& camera, double x, double y) {
    return unit((x - 0.5 * camera.width) * camera.right + (y - 0.5 * camera.height) * camera.down +
                camera.pixels_per_slope * camera.ahead);
}

// Not infinite, so that 0 times it is 0.
static inline Vec3 inverse_of(Vec3 d) {
    const auto inverse = [](double x) { return 1.0 / (std::fabs(x) > 1e-18 ? x : std::copysign(1e-18, x)); };
    return {inverse(d.x), inverse(d.y), inverse(d.z)};
}

// Whether o + s d, 0 <= s <= reach, may pass the box.
static inline bool passes(const Box& box, Vec3 o, Vec3 inverse, double reach) {
    double near = 0, far = reach;
    for (int i = 0; i < 3; ++i) {
        const double at = coordinate(o, i), by = coordinate(inverse, i);
        const double a = (coordinate(box.lo, i) - at) * by, b = (coordinate(box.hi, i) - at) * by;
        near = greater(near, lesser(a, b));
        far = lesser(far, greater(a, b));
    }
    return near <= far * (1 + 1e-12);
}

struct Sight {
    double distance = HUGE_VAL;    // meters
    int32_t body = -1, face = -1;  // the first: in the order of the list
};

// The nearer of a sight and what a unit ray from the eye meets of a body.
static inline void look_at(const Placed& body, int32_t index, Vec3 ray, Sight& sight) {
    const Vec3 d = rotate(body.back, ray);
    if (!passes(body.shape->mesh.bounds, body.eye, inverse_of(d), sight.distance)) return;
    const RayHit hit = kernels().raycast(*body.shape, body.eye, d, sight.distance);
    if (hit.face >= 0 && hit.distance < sight.distance) sight = {hit.distance, index, hit.face};
}

// Whether the body hides the sun from a point, given in the sun's frame too.
static inline bool hides_sun(const Placed& body, Vec3 p, Vec3 p_in_sun_frame) {
    const Box& shade = body.shade;
    const Vec3 q = p_in_sun_frame;
    if (q.x < shade.lo.x || q.x > shade.hi.x || q.y < shade.lo.y || q.y > shade.hi.y || q.z > shade.hi.z) return false;
    const Vec3 o = apply(body.back, p);
    if (!passes(body.shape->mesh.bounds, o, body.sun_inverse, HUGE_VAL)) return false;
    return kernels().obstructed(*body.shape, o, body.sun);
}

}  // namespace fgenv
