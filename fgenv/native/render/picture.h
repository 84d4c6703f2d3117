// A picture of bodies by the ray kernel: Lambert surfaces under a sun with hard shadows and a sky, on a
// floor with a grid. tests/oracles/shader.py renders the same scene in NumPy.
#pragma once

#include <memory>
#include <optional>

#include "render/culling.h"
#include "render/srgb.h"

namespace fgenv {

// For each face rows (3, 4): times (x, y, z, 1) of a point on it, the normal there, not of unit length.
using NormalMaps = std::vector<std::array<float, 12>>;

struct PaintedBody {
    std::shared_ptr<const Shape> shape;
    std::shared_ptr<const NormalMaps> maps;  // null: flat faces
    Vec3 color;                              // linear, as all colors here
    double opacity = 1;                      // below 1: translucent, unshaded and without a shadow
};

struct Lighting {
    Vec3 sun;  // unit vector to it
    double strength;
    Vec3 above, below;     // light of the sky and from the ground
    Vec3 zenith, horizon;  // the sky as seen
};

struct Ground {
    double height, grid, fade;  // meters
    Vec3 color;
};

// A ring on the floor around a pale disc.
struct Mark {
    double x, y, radius;  // meters
    Vec3 color;
};

struct Scene {
    std::vector<PaintedBody> bodies;
    Lighting light;
};

struct Antialiasing {
    int samples;      // squared: as fine is a pixel at an edge; 1: no finer
    double contrast;  // of linear color between neighbors: more is an edge
};

// One picture. First `look` at every tile, then `finish` every tile: in any order, on any thread. `look`
// writes the depth ahead of each pixel (meters; infinite for the sky) unless `depth` is null.
class Picture {
public:
    Picture(const Scene& scene, const std::vector<Rigid>& poses, const Camera& camera,
            const std::optional<Ground>& ground, std::vector<Mark> marks, Antialiasing antialiasing);

    int64_t tiles() const { return static_cast<int64_t>(columns_) * rows_; }
    void look(int64_t first, int64_t last, double* depth);
    void finish(int64_t first, int64_t last, uint8_t* out) const;  // out (height, width, 3)

private:
    static constexpr int side = 8, most = side * side;  // pixels of a tile; rays of a bundle
    static constexpr unsigned left = 1, right = 2, above = 4, below = 8;
    struct Pixel {  // of one ray
        float color[3];
        int32_t owner;  // a body, or one of those below
    };
    static constexpr int32_t sky = -1, sunny_ground = -2, shaded_ground = -3;

    struct Surface {  // the surface that a ray meets
        int32_t owner;
        Vec3 point, normal, albedo, sky;
        double solid;  // 0: the sky alone, 1: the surface alone
        double sunny;
        int32_t front = -1;        // nearest translucent body before the surface
        double transmittance = 1;  // of the translucent bodies before the surface
        Vec3 veil = {0, 0, 0};     // light that these bodies add
    };
    struct Bundle {  // rays through one tile, and the bodies and marks that they may meet
        PixelBox box;
        std::vector<int32_t> bodies, translucent, marks, casters;  // bodies by their nearest depth
        std::vector<Sight> layers;                                 // scratch of one ray
        int n = 0;
        int pixel[most];
        Vec3 ray[most];
        Surface seen[most];
    };

    PixelBox tile_box(int64_t tile) const;
    void aim(Bundle& bundle, const PixelBox& box) const;
    template <class Add>
    void trace(Bundle& bundle, const Add& add) const;
    bool differ(const Pixel& a, const Pixel& b) const;
    unsigned edges(int x, int y) const;
    template <class Add>
    void refine(Bundle& bundle, int x, int y, int at, unsigned edges, const Add& add) const;

    void see(Bundle& bundle, Vec3 ray, Surface& out) const;
    void composite(Bundle& bundle, Vec3 ray, double distance, Surface& out) const;
    void see_body(const Placed& body, const Sight& sight, Vec3 ray, Surface& out) const;
    void see_ground(const Bundle& bundle, double distance, double slant, Vec3 ray, Surface& out) const;
    Vec3 ground_albedo(const Bundle& bundle, Vec3 point, Vec3 ray, double slant, double width) const;
    void cast_shadows(Bundle& bundle) const;
    Vec3 lit(const Surface& surface) const;

    const Scene& scene_;
    Camera camera_;
    SunFrame sun_;
    bool has_ground_;
    Ground ground_;
    std::vector<Placed> bodies_, translucent_;  // nearest first
    std::vector<Mark> marks_;
    std::vector<PixelBox> mark_boxes_;
    Antialiasing antialiasing_;
    double slope_per_pixel_, per_grid_, per_fade_;
    int columns_, rows_;  // of tiles
    std::vector<Pixel> pixels_;
};

}  // namespace fgenv
