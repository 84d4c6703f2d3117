#include "render/picture.h"

#include <algorithm>

namespace fgenv {
namespace {

void write(const SrgbTable& table, Vec3 light, uint8_t* out) {
    out[0] = table.byte(light.x);
    out[1] = table.byte(light.y);
    out[2] = table.byte(light.z);
}

}  // namespace

Picture::Picture(const Scene& scene, const std::vector<Rigid>& poses, const Camera& camera,
                 const std::optional<Ground>& ground, std::vector<Mark> marks, Antialiasing antialiasing)
    : scene_(scene),
      camera_(camera),
      sun_(sun_frame(scene.light.sun)),
      has_ground_(ground.has_value()),
      ground_(ground.value_or(Ground{0, 1, 1, {0, 0, 0}})),
      marks_(std::move(marks)),
      antialiasing_(antialiasing),
      slope_per_pixel_(1 / camera.pixels_per_slope),
      per_grid_(1 / ground_.grid),
      per_fade_(1 / ground_.fade),
      columns_((camera.width + side - 1) / side),
      rows_((camera.height + side - 1) / side),
      pixels_(static_cast<size_t>(camera.width) * camera.height) {
    for (size_t i = 0; i < poses.size(); ++i) {
        const PaintedBody& body = scene.bodies[i];
        (body.opacity < 1 ? translucent_ : bodies_)
            .push_back(place(*body.shape, static_cast<int32_t>(i), poses[i], camera, sun_));
    }
    std::stable_sort(bodies_.begin(), bodies_.end(),
                     [](const Placed& a, const Placed& b) { return a.nearest < b.nearest; });
    for (const Mark& m : marks_) {
        Vec3 corners[4];
        for (int k = 0; k < 4; ++k)
            corners[k] = {k & 1 ? m.x + m.radius : m.x - m.radius, k & 2 ? m.y + m.radius : m.y - m.radius,
                          ground_.height};
        double nearest;
        mark_boxes_.push_back(pixel_box(camera, corners, 4, nearest));
    }
}

PixelBox Picture::tile_box(int64_t tile) const {
    const double x = static_cast<double>(tile % columns_ * side), y = static_cast<double>(tile / columns_ * side);
    return {{x, y}, {lesser(x + side, camera_.width), lesser(y + side, camera_.height)}};
}

void Picture::aim(Bundle& bundle, const PixelBox& box) const {
    // A pixel wider: a mark's blur sticks out, and so may what rounding does.
    bundle.box = {{box.lo[0] - 1, box.lo[1] - 1}, {box.hi[0] + 1, box.hi[1] + 1}};
    bundle.n = 0;
    bundle.bodies.clear();
    bundle.translucent.clear();
    bundle.marks.clear();
    for (size_t i = 0; i < bodies_.size(); ++i)
        if (overlap(bodies_[i].box, bundle.box)) bundle.bodies.push_back(static_cast<int32_t>(i));
    for (size_t i = 0; i < translucent_.size(); ++i)
        if (overlap(translucent_[i].box, bundle.box)) bundle.translucent.push_back(static_cast<int32_t>(i));
    for (size_t i = 0; i < marks_.size(); ++i)
        if (overlap(mark_boxes_[i], bundle.box)) bundle.marks.push_back(static_cast<int32_t>(i));
}

// add(pixel, surface, color) for each ray of the bundle, which is then empty.
template <class Add>
void Picture::trace(Bundle& bundle, const Add& add) const {
    for (int i = 0; i < bundle.n; ++i) see(bundle, bundle.ray[i], bundle.seen[i]);
    cast_shadows(bundle);
    for (int i = 0; i < bundle.n; ++i) add(bundle.pixel[i], bundle.seen[i], lit(bundle.seen[i]));
    bundle.n = 0;
}

void Picture::look(int64_t first, int64_t last, double* depth) {
    Bundle bundle;
    for (int64_t tile = first; tile < last; ++tile) {
        const PixelBox box = tile_box(tile);
        aim(bundle, box);
        for (int y = static_cast<int>(box.lo[1]); y < box.hi[1]; ++y)
            for (int x = static_cast<int>(box.lo[0]); x < box.hi[0]; ++x) {
                bundle.pixel[bundle.n] = y * camera_.width + x;
                bundle.ray[bundle.n++] = ray_through(camera_, x + 0.5, y + 0.5);
            }
        trace(bundle, [&](int pixel, const Surface& s, Vec3 c) {
            const int32_t owner = s.front >= 0 ? s.front : s.owner;
            pixels_[pixel] = {{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)}, owner};
            if (depth) depth[pixel] = s.owner == sky ? HUGE_VAL : dot(camera_.ahead, s.point - camera_.eye);
        });
    }
}

// Whether two neighbors differ. Not by the floor's lines and marks: those are smooth as they are; and on
// one body by more, as round surfaces do.
bool Picture::differ(const Pixel& a, const Pixel& b) const {
    const bool same = a.owner == b.owner;
    if (same && a.owner < 0) return false;
    const double limit = (same ? 3 : 1) * antialiasing_.contrast;
    for (int k = 0; k < 3; ++k)
        if (std::fabs(a.color[k] - b.color[k]) > limit) return true;
    return false;
}

// The sides on which a pixel's neighbor differs from it.
unsigned Picture::edges(int x, int y) const {
    const Pixel* here = &pixels_[static_cast<size_t>(y) * camera_.width + x];
    return (x > 0 && differ(*here, here[-1]) ? left : 0) |
           (x + 1 < camera_.width && differ(*here, here[1]) ? right : 0) |
           (y > 0 && differ(*here, here[-camera_.width]) ? above : 0) |
           (y + 1 < camera_.height && differ(*here, here[camera_.width]) ? below : 0);
}

// Rays for the pixel `at` of the bundle's tile, to be added to its sum; what lies toward a neighbor that
// does not differ has the pixel's own color.
template <class Add>
void Picture::refine(Bundle& bundle, int x, int y, int at, unsigned edges, const Add& add) const {
    const Pixel& own = pixels_[static_cast<size_t>(y) * camera_.width + x];
    const int samples = antialiasing_.samples;
    for (int k = 0; k < samples * samples; ++k) {
        // In half steps off the middle.
        const int i = 2 * (k % samples) + 1 - samples, j = 2 * (k / samples) + 1 - samples;
        const unsigned toward = (i < 0 ? left : i > 0 ? right : 0) | (j < 0 ? above : j > 0 ? below : 0);
        if (!(edges & toward)) {
            add(at, {own.color[0], own.color[1], own.color[2]});
            continue;
        }
        bundle.pixel[bundle.n] = at;
        bundle.ray[bundle.n++] = ray_through(camera_, x + 0.5 + 0.5 * i / samples, y + 0.5 + 0.5 * j / samples);
        if (bundle.n == most) trace(bundle, [&](int pixel, const Surface&, Vec3 c) { add(pixel, c); });
    }
}

void Picture::finish(int64_t first, int64_t last, uint8_t* out) const {
    static const SrgbTable table;
    const double share = 1.0 / (antialiasing_.samples * antialiasing_.samples);
    Bundle bundle;
    for (int64_t tile = first; tile < last; ++tile) {
        const PixelBox box = tile_box(tile);
        const int x0 = static_cast<int>(box.lo[0]), y0 = static_cast<int>(box.lo[1]);
        Vec3 sum[most] = {};
        bool fine[most] = {}, aimed = false;
        const auto add = [&](int at, Vec3 c) { sum[at] = sum[at] + share * c; };
        for (int y = y0; y < box.hi[1]; ++y)
            for (int x = x0; x < box.hi[0]; ++x) {
                const unsigned sides = antialiasing_.samples > 1 ? edges(x, y) : 0;
                if (!sides) continue;
                if (!aimed) aim(bundle, box);
                aimed = true;
                const int at = (y - y0) * side + x - x0;
                fine[at] = true;
                refine(bundle, x, y, at, sides, add);
            }
        if (aimed) trace(bundle, [&](int at, const Surface&, Vec3 c) { add(at, c); });
        for (int y = y0; y < box.hi[1]; ++y)
            for (int x = x0; x < box.hi[0]; ++x) {
                const size_t pixel = static_cast<size_t>(y) * camera_.width + x;
                const int at = (y - y0) * side + x - x0;
                const float* c = pixels_[pixel].color;
                write(table, fine[at] ? sum[at] : Vec3{c[0], c[1], c[2]}, out + 3 * pixel);
            }
    }
}

}  // namespace fgenv
