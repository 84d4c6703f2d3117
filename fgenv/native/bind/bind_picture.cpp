// Python class of a painter: bodies with their colors and the light, once; poses in, a picture out.
#include "bind/bind.h"

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include "bind/arguments.h"
#include "bind/parallel.h"
#include "render/picture.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr int64_t most_pixels = int64_t{1} << 26;
constexpr double farthest = 1e12;  // meters, as of poses
constexpr int most_samples = 16;
constexpr int64_t chunk = 4;  // tiles

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

// `n` finite vectors, one a row.
std::vector<Vec3> vectors(nb::handle value, const char* name, int64_t n) {
    const Array<double> array = points(value, name);
    const Dims expected = n == 1 ? Dims{3} : Dims{n, 3};
    if (array.dims != expected && array.dims != Dims{n, 3})
        fail(std::string(name) + ": got shape " + to_string(array.dims) + ", expected " + to_string(expected));
    std::vector<Vec3> out;
    for (const double *v = array.data(), *end = v + 3 * n; v < end; v += 3) out.push_back({v[0], v[1], v[2]});
    return out;
}

double positive(double value, const char* name) {
    if (!(value > 0 && value <= farthest))
        fail(std::string(name) + ": got " + number(value) + ", expected above 0 and at most " + number(farthest));
    return value;
}

// None: flat faces.
std::shared_ptr<const NormalMaps> maps_of(nb::handle value, const Shape& shape) {
    if (value.is_none()) return nullptr;
    const Array<double> array = doubles(value, "maps");
    const int64_t faces = static_cast<int64_t>(shape.mesh.faces.size());
    if (array.dims != Dims{faces, 3, 4})
        fail("maps: got shape " + to_string(array.dims) + ", expected " + to_string({faces, 3, 4}) +
             ", one matrix per face");
    auto maps = std::make_shared<NormalMaps>(faces);
    for (int64_t i = 0; i < faces; ++i)
        for (int k = 0; k < 12; ++k) (*maps)[i][k] = static_cast<float>(array.data()[12 * i + k]);
    return maps;
}

struct Painter {
    Scene scene;
};

Lighting light_of(nb::handle sun, double strength, nb::handle ambient, nb::handle sky) {
    const std::vector<Vec3> to = vectors(sun, "sun", 1), around = vectors(ambient, "ambient", 2),
                            seen = vectors(sky, "sky", 2);
    if (to[0] == Vec3{0, 0, 0}) fail("sun: got length 0, expected a direction");
    if (!std::isfinite(strength)) fail("strength: got " + number(strength) + ", expected a finite number");
    return {unit(to[0]), strength, around[0], around[1], seen[0], seen[1]};
}

void make_painter(Painter* self, const std::vector<std::shared_ptr<Shape>>& shapes, nb::sequence maps,
                  const std::vector<int64_t>& which, nb::handle colors, const std::vector<double>& opacities,
                  nb::handle sun, double strength, nb::handle ambient, nb::handle sky) {
    if (nb::len(maps) != shapes.size())
        fail("maps: got " + std::to_string(nb::len(maps)) + ", expected " + std::to_string(shapes.size()) +
             ", one for each shape");
    std::vector<std::shared_ptr<const NormalMaps>> read;
    for (size_t i = 0; i < shapes.size(); ++i) {
        if (!shapes[i]) throw nb::type_error("shapes: got None, expected Shapes");
        read.push_back(maps_of(maps[i], *shapes[i]));
    }
    Painter painter{{{}, light_of(sun, strength, ambient, sky)}};
    const int64_t n = static_cast<int64_t>(which.size());
    if (opacities.size() != which.size())
        fail("opacities: got " + std::to_string(opacities.size()) + ", expected " + std::to_string(n));
    const std::vector<Vec3> color = n ? vectors(colors, "colors", n) : std::vector<Vec3>{};
    for (int64_t i = 0; i < n; ++i) {
        if (which[i] < 0 || which[i] >= static_cast<int64_t>(shapes.size()))
            fail("which: got " + std::to_string(which[i]) + ", expected the index of a shape");
        if (!(opacities[i] > 0 && opacities[i] <= 1))
            fail("opacities[" + std::to_string(i) + "]: got " + number(opacities[i]) +
                 ", expected above 0 and at most 1");
        painter.scene.bodies.push_back({shapes[which[i]], read[which[i]], color[i], opacities[i]});
    }
    new (self) Painter(std::move(painter));
}

// Height, grid, fade, linear red, green, blue; or None.
std::optional<Ground> ground_of(nb::handle value) {
    if (value.is_none()) return std::nullopt;
    const Array<double> array = doubles(value, "floor");
    if (array.dims != Dims{6}) fail("floor: got shape " + to_string(array.dims) + ", expected (6,)");
    const double* f = array.data();
    if (!(std::fabs(f[0]) <= farthest)) fail("floor: got height " + number(f[0]) + ", expected at most 1e12 m");
    return Ground{f[0], positive(f[1], "floor: grid"), positive(f[2], "floor: fade"), {f[3], f[4], f[5]}};
}

// Rows of x, y, radius, linear red, green, blue.
std::vector<Mark> marks_of(nb::handle value) {
    const Array<double> array = doubles(value, "marks");
    if (array.dims.size() != 2 || array.dims[1] != 6)
        fail("marks: got shape " + to_string(array.dims) + ", expected (n, 6): x, y, radius, red, green, blue");
    std::vector<Mark> marks;
    for (int64_t i = 0; i < array.dims[0]; ++i) {
        const double* m = array.data() + 6 * i;
        for (int k = 0; k < 6; ++k)
            if (!std::isfinite(m[k]))
                fail("marks[" + std::to_string(i) + "]: got " + number(m[k]) + ", expected finite numbers");
        if (!(m[2] > 0))
            fail("marks[" + std::to_string(i) + "]: got radius " + number(m[2]) + ", expected more than 0");
        marks.push_back({m[0], m[1], m[2], {m[3], m[4], m[5]}});
    }
    return marks;
}

Camera camera_of(nb::handle eye, nb::handle axes, double pixels_per_slope, int64_t width, int64_t height) {
    const std::vector<Vec3> rows = vectors(axes, "axes", 3);
    if (width < 1 || height < 1 || width > most_pixels || height > most_pixels || width * height > most_pixels)
        fail("width, height: got " + std::to_string(width) + ", " + std::to_string(height) +
             ", expected at least 1, and at most " + std::to_string(most_pixels) + " pixels");
    const Vec3 from = vectors(eye, "eye", 1)[0];
    if (!(norm(from) <= farthest)) fail("eye: got a point over 1e12 m from the origin, expected a nearer one");
    return {from,
            rows[0],
            rows[1],
            rows[2],
            positive(pixels_per_slope, "pixels_per_slope"),
            static_cast<int>(width),
            static_cast<int>(height)};
}

// The picture (height, width, 3), sRGB bytes, and the depths (height, width) if asked for, else None.
nb::object paint(const Painter& self, nb::handle places, nb::handle eye, nb::handle axes, double pixels_per_slope,
                 int64_t width, int64_t height, nb::handle floor, nb::handle marks, int64_t samples, double contrast,
                 bool with_depth, nb::handle threads) {
    const Poses array = poses(places, "poses");
    const int64_t n = static_cast<int64_t>(self.scene.bodies.size());
    if (array.dims != Dims{n})
        fail("poses: got shape " + to_string(array.array.dims) + ", expected " + to_string({n, 4, 4}) +
             ", one for each body");
    if (samples < 1 || samples > most_samples)
        fail("samples: got " + std::to_string(samples) + ", expected 1 to " + std::to_string(most_samples));
    const int n_threads = threads_of(threads);
    Picture picture(self.scene, array.all(), camera_of(eye, axes, pixels_per_slope, width, height), ground_of(floor),
                    marks_of(marks), {static_cast<int>(samples), contrast});
    Output<uint8_t> out = make_output<uint8_t>({height, width, 3});
    std::optional<Output<double>> depth;
    if (with_depth) depth = make_output<double>({height, width});
    double* depths = depth ? depth->data : nullptr;
    parallel_for(picture.tiles(), n_threads, [&](int64_t a, int64_t b) { picture.look(a, b, depths); }, chunk);
    parallel_for(picture.tiles(), n_threads, [&](int64_t a, int64_t b) { picture.finish(a, b, out.data); }, chunk);
    return nb::make_tuple(out.array, depth ? nb::cast(depth->array) : nb::none());
}

}  // namespace

void bind_picture(nb::module_& m) {
    nb::class_<Painter>(m, "Painter")
        .def("__init__", &make_painter, "shapes"_a, "maps"_a, "which"_a, nb::kw_only(), "colors"_a, "opacities"_a,
             "sun"_a, "strength"_a, "ambient"_a, "sky"_a)
        .def("paint", &paint, "poses"_a.none(), nb::kw_only(), "eye"_a, "axes"_a, "pixels_per_slope"_a, "width"_a,
             "height"_a, "floor"_a.none(), "marks"_a, "samples"_a, "contrast"_a, "with_depth"_a, "threads"_a.none());
}

}  // namespace fgenv
