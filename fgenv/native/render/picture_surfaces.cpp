// The surfaces that the rays of a picture meet, and the light on them.
#include <algorithm>

#include "render/picture.h"

namespace fgenv {
namespace {

Vec3 mixed(Vec3 a, Vec3 b, double t) { return a + t * (b - a); }
Vec3 product(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// How much of a pixel so wide is inside an edge that lies `inside` its middle.
double covered(double inside, double per_width) { return lesser(greater(0.5 + inside * per_width, 0), 1); }

// Beyond 1e15 there is nothing to round.
double rounded(double x) {
    return std::fabs(x) < 1e15 ? static_cast<double>(static_cast<int64_t>(x + (x < 0 ? -0.5 : 0.5))) : x;
}

}  // namespace

void Picture::see(Bundle& bundle, Vec3 ray, Surface& out) const {
    out = {};
    out.owner = sky;
    const double high = lesser(greater(ray.z, 0), 1);
    out.sky = mixed(scene_.light.horizon, scene_.light.zenith, fifth_root(high * high * high));
    Sight sight;
    for (int32_t index : bundle.bodies) {
        const Placed& body = bodies_[index];
        if (body.nearest > sight.distance) break;
        look_at(body, index, ray, sight);
    }
    if (has_ground_ && ray.z != 0) {
        const double slant = 1 / ray.z, distance = (ground_.height - camera_.eye.z) * slant;
        if (distance > 0 && distance < lesser(sight.distance, 4 * ground_.fade)) {
            see_ground(bundle, distance, slant, ray, out);
            sight = {distance, -1, -1};
        }
    }
    if (sight.body >= 0) see_body(bodies_[sight.body], sight, ray, out);
    if (!bundle.translucent.empty()) composite(bundle, ray, sight.distance, out);
}

// Blends the translucent bodies before a distance over the surface, the farthest first (the "over"
// operator of Porter and Duff 1984).
void Picture::composite(Bundle& bundle, Vec3 ray, double distance, Surface& out) const {
    bundle.layers.clear();
    for (int32_t index : bundle.translucent) {
        Sight sight;
        sight.distance = distance;
        look_at(translucent_[index], index, ray, sight);
        if (sight.body >= 0) bundle.layers.push_back(sight);
    }
    std::stable_sort(bundle.layers.begin(), bundle.layers.end(),
                     [](const Sight& a, const Sight& b) { return a.distance > b.distance; });
    for (const Sight& layer : bundle.layers) {
        Surface body{};
        see_body(translucent_[layer.body], layer, ray, body);
        body.sunny = greater(dot(body.normal, sun_.to), 0);
        const double opacity = scene_.bodies[body.owner].opacity;
        out.veil = mixed(out.veil, lit(body), opacity);
        out.transmittance *= 1 - opacity;
        out.front = body.owner;
    }
}

void Picture::see_body(const Placed& body, const Sight& sight, Vec3 ray, Surface& out) const {
    const PaintedBody& paint = scene_.bodies[body.body];
    const Vec3 d = rotate(body.back, ray), flat = area_vector(body.shape->mesh, sight.face);
    Vec3 normal = flat;
    if (paint.maps) {
        const Vec3 p = body.eye + sight.distance * d;
        const std::array<float, 12>& m = (*paint.maps)[sight.face];
        normal = {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                  m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
    }
    // The face itself says which side is seen: a round normal may lean over the rim.
    if (dot(flat, d) > 0) normal = -1.0 * normal;
    out.point = camera_.eye + sight.distance * ray;
    out.normal = rotate(body.pose, unit(normal));
    out.albedo = paint.color;
    out.solid = 1;
    out.owner = body.body;
}

void Picture::see_ground(const Bundle& bundle, double distance, double slant, Vec3 ray, Surface& out) const {
    out.point = camera_.eye + distance * ray;
    out.point.z = ground_.height;
    out.normal = {0, 0, camera_.eye.z > ground_.height ? 1.0 : -1.0};
    out.albedo = ground_albedo(bundle, out.point, ray, slant, distance * slope_per_pixel_);
    const double relative = distance * per_fade_;
    out.solid = decay(relative * relative);
    out.owner = sunny_ground;
}

// The floor's color with its grid and marks, seen by pixels of a width (meters) across the ray; slant is
// 1 / ray.z.
Vec3 Picture::ground_albedo(const Bundle& bundle, Vec3 point, Vec3 ray, double slant, double width) const {
    const double half = 0.01 * ground_.grid;  // of a line's width
    const double blur = greater(half, width * std::fabs(slant)), per_blur = 1 / blur;
    double line = 0;
    for (int i = 0; i < 2; ++i) {
        const double across = coordinate(point, i) * per_grid_;
        const double off = std::fabs(across - rounded(across)) * ground_.grid;
        if (off < half + 0.5 * blur) line = greater(line, covered(half - off, per_blur) * (half * per_blur));
    }
    Vec3 albedo = (1 - 0.3 * line) * ground_.color;
    for (int32_t index : bundle.marks) {
        const Mark& mark = marks_[index];
        const double x = point.x - mark.x, y = point.y - mark.y, far = greater(std::sqrt(x * x + y * y), 1e-12);
        // A pixel lies along the ray, as long as the ray is slant: its extent on the way from the middle.
        const double along = (ray.x * x + ray.y * y) / far * slant;
        const double extent = width * std::sqrt(1 + along * along), per_extent = 1 / extent;
        const double hole = covered(mark.radius - greater(0.15 * mark.radius, 2 * extent) - far, per_extent);
        const double ring = covered(mark.radius - far, per_extent) - hole;
        albedo = mixed(albedo, mark.color, 0.9 * ring + 0.25 * hole);
    }
    return albedo;
}

void Picture::cast_shadows(Bundle& bundle) const {
    Box lit = empty_box();  // in the sun's frame
    Vec3 origin[most], across[most];
    for (int i = 0; i < bundle.n; ++i) {
        Surface& s = bundle.seen[i];
        s.sunny = s.solid > 0 ? greater(dot(s.normal, sun_.to), 0) : 0;
        if (s.sunny == 0) continue;
        // Off the surface by more than rounding, by less than anyone sees.
        const double size = greater(greater(std::fabs(s.point.x), std::fabs(s.point.y)), std::fabs(s.point.z));
        origin[i] = s.point + (1e-4 * (1 + size)) * s.normal;
        across[i] = in_sun_frame(sun_, origin[i]);
        grow(lit, across[i]);
    }
    bundle.casters.clear();
    for (size_t i = 0; i < bodies_.size(); ++i) {
        const Box& shade = bodies_[i].shade;
        if (shade.lo.x <= lit.hi.x && shade.hi.x >= lit.lo.x && shade.lo.y <= lit.hi.y && shade.hi.y >= lit.lo.y &&
            shade.hi.z >= lit.lo.z)
            bundle.casters.push_back(static_cast<int32_t>(i));
    }
    for (int i = 0; i < bundle.n; ++i) {
        Surface& s = bundle.seen[i];
        for (size_t k = 0; k < bundle.casters.size() && s.sunny > 0; ++k) {
            if (!hides_sun(bodies_[bundle.casters[k]], origin[i], across[i])) continue;
            s.sunny = 0;
            if (s.owner == sunny_ground) s.owner = shaded_ground;
            std::swap(bundle.casters[0], bundle.casters[k]);  // likely hides the next point too
        }
    }
}

Vec3 Picture::lit(const Surface& s) const {
    const auto veiled = [&](Vec3 c) { return s.transmittance * c + s.veil; };
    if (s.solid == 0) return veiled(s.sky);
    const Lighting& light = scene_.light;
    const double sun = light.strength * s.sunny;
    const Vec3 all = mixed(light.below, light.above, 0.5 + 0.5 * s.normal.z) + Vec3{sun, sun, sun};
    return veiled(mixed(s.sky, product(s.albedo, all), s.solid));
}

}  // namespace fgenv
