// Queries: arrays in, arrays out, the loop over poses in parallel.
#include "bind/bind.h"

#include "bind/arguments.h"
#include "bind/parallel.h"
#include "query/contact.h"
#include "query/kernels.h"

namespace fgenv {
namespace {

using namespace nb::literals;

const Shape& shape_of(nb::handle value, const char* name) {
    Shape* shape = nullptr;
    if (!nb::try_cast(value, shape, false) || !shape)
        throw nb::type_error(
            (std::string(name) + ": got " + Py_TYPE(value.ptr())->tp_name + ", expected a Shape").c_str());
    return *shape;
}

nb::object collide(nb::handle A, nb::handle Ta, nb::handle B, nb::handle Tb, nb::handle margin_, nb::handle threads) {
    const Shape &a = shape_of(A, "a"), &b = shape_of(B, "b");
    const Poses ta = poses(Ta, "Ta"), tb = poses(Tb, "Tb");
    const double margin = meters_of(margin_, "margin");
    const int n_threads = threads_of(threads);
    if (ta.single() && tb.single()) {
        const bool hit = hits(a, b, relative(ta[0], tb[0]), margin, false);
        return nb::cast(hit);
    }
    const Broadcast shape = broadcast({{"Ta", ta.dims}, {"Tb", tb.dims}});
    Output<bool> out = make_output<bool>(shape.dims);
    parallel_for(shape.size, n_threads, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i)
            out.data[i] = hits(a, b, relative(ta[shape.offset(0, i)], tb[shape.offset(1, i)]), margin, false);
    });
    return nb::cast(out.array);
}

double distance_of(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb) {
    const Rigid pose = relative(ta, tb);
    if (kernels().collide(a, b, pose, true, nullptr)) return 0;
    return distance_apart(kernels().nearest(a, b, pose, HUGE_VAL, false).squared);
}

nb::object distance(nb::handle A, nb::handle Ta, nb::handle B, nb::handle Tb, nb::handle threads) {
    const Shape &a = shape_of(A, "a"), &b = shape_of(B, "b");
    const Poses ta = poses(Ta, "Ta"), tb = poses(Tb, "Tb");
    const int n_threads = threads_of(threads);
    if (ta.single() && tb.single()) return nb::cast(distance_of(a, ta[0], b, tb[0]));
    const Broadcast shape = broadcast({{"Ta", ta.dims}, {"Tb", tb.dims}});
    Output<double> out = make_output<double>(shape.dims);
    parallel_for(shape.size, n_threads, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i)
            out.data[i] = distance_of(a, ta[shape.offset(0, i)], b, tb[shape.offset(1, i)]);
    });
    return nb::cast(out.array);
}

nb::tuple tuple_of(Vec3 p) { return nb::make_tuple(p.x, p.y, p.z); }

nb::object contact_point(nb::handle A, nb::handle Ta, nb::handle B, nb::handle Tb) {
    const Shape &a = shape_of(A, "a"), &b = shape_of(B, "b");
    const Poses ta = poses(Ta, "Ta"), tb = poses(Tb, "Tb");
    if (!ta.single() || !tb.single())
        throw nb::value_error(
            "Ta, Tb: got arrays of poses, expected one pose each, shape (4, 4); use collide for arrays");
    const ContactInfo c = contact_of(a, ta[0], b, tb[0], false);
    if (!c.hit) return nb::none();
    nb::object edge = nb::none();
    if (c.has_edge) edge = nb::make_tuple(tuple_of(c.edge[0]), tuple_of(c.edge[1]));
    return nb::make_tuple(tuple_of(c.point), tuple_of(c.normal), edge, c.face, c.edge_of_a);
}

nb::object nearest_points(nb::handle A, nb::handle Ta, nb::handle B, nb::handle Tb, nb::handle threads) {
    const Shape &a = shape_of(A, "a"), &b = shape_of(B, "b");
    const Poses ta = poses(Ta, "Ta"), tb = poses(Tb, "Tb");
    const int n_threads = threads_of(threads);
    const Broadcast shape = broadcast({{"Ta", ta.dims}, {"Tb", tb.dims}});
    Output<double> d = make_output<double>(shape.dims), pa = make_output<double>(shape.dims, {3}),
                   pb = make_output<double>(shape.dims, {3}), n = make_output<double>(shape.dims, {3});
    const auto put = [](double* row, Vec3 p) {
        row[0] = p.x;
        row[1] = p.y;
        row[2] = p.z;
    };
    parallel_for(shape.size, n_threads, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const Rigid at = ta[shape.offset(0, i)], bt = tb[shape.offset(1, i)];
            const ContactInfo c = contact_of(a, at, b, bt, true);
            if (c.hit) {
                d.data[i] = 0;
                put(pa.data + 3 * i, c.point);
                put(pb.data + 3 * i, c.point);
                put(n.data + 3 * i, c.normal);
                continue;
            }
            const Nearest near = nearest_pair(a, at, b, bt);
            d.data[i] = distance_apart(near.squared);
            put(pa.data + 3 * i, apply(at, near.on_a));
            put(pb.data + 3 * i, apply(at, near.on_b));
            put(n.data + 3 * i, unit(rotate(at, near.on_a - near.on_b)));
        }
    });
    return nb::make_tuple(d.array, pa.array, pb.array, n.array);
}

nb::object contains(const Shape& s, nb::handle points_, nb::handle T, nb::handle threads) {
    if (!s.mesh.watertight)
        throw nb::value_error("contains: got a mesh that is not watertight, expected a closed mesh; close its borders");
    const Array<double> p = points(points_, "points");
    const Poses t = poses(T, "T");
    const Broadcast shape = broadcast({{"points", rows_of(p)}, {"T", t.dims}});
    std::vector<Rigid> inverses;
    for (const Rigid& item : t.all()) inverses.push_back(inverse(item));
    Output<bool> out = make_output<bool>(shape.dims);
    parallel_for(shape.size, threads_of(threads), [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const double* row = p.data() + 3 * shape.offset(0, i);
            bool touching = false;
            const Vec3 local = apply(inverses[shape.offset(1, i)], {row[0], row[1], row[2]});
            out.data[i] = kernels().winding(s, local, touching) != 0 || touching;
        }
    });
    return nb::cast(out.array);
}

nb::object raycast(const Shape& s, nb::handle origins, nb::handle directions, nb::handle T, nb::handle max_distance_,
                   nb::handle threads) {
    const Array<double> o = points(origins, "origins"), d = directions_of(directions, "directions");
    const Poses t = poses(T, "T");
    const double max_distance = meters_of(max_distance_, "max_distance", true);
    const Broadcast shape = broadcast({{"origins", rows_of(o)}, {"directions", rows_of(d)}, {"T", t.dims}});
    std::vector<Rigid> inverses;
    for (const Rigid& item : t.all()) inverses.push_back(inverse(item));
    Output<double> at = make_output<double>(shape.dims);
    Output<int32_t> face = make_output<int32_t>(shape.dims);
    parallel_for(shape.size, threads_of(threads), [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const double* p = o.data() + 3 * shape.offset(0, i);
            const double* v = d.data() + 3 * shape.offset(1, i);
            const Rigid& pose = inverses[shape.offset(2, i)];
            const auto [direction, length] = ray_direction_of(v);
            const RayHit hit = kernels().raycast(s, apply(pose, {p[0], p[1], p[2]}), rotate(pose, direction),
                                                 reach_of(max_distance, length));
            const double meters = hit.distance * length;
            const bool within = hit.face >= 0 && meters <= max_distance;
            at.data[i] = within ? meters : HUGE_VAL;
            face.data[i] = within ? hit.face : -1;
        }
    });
    return nb::make_tuple(at.array, face.array);
}

}  // namespace

void bind_queries(nb::module_& m) {
    m.def("collide", &collide, "a"_a.none(), "Ta"_a.none(), "b"_a.none(), "Tb"_a.none(), nb::kw_only(),
          "margin"_a.none() = 0.0, "threads"_a = nb::none(),
          R"(Whether two posed shapes collide.

Exact for shapes of method `exact`. Touching counts, and so does containment in a watertight shape.
If either shape's method is `loop`, a's cycle is tested against b's faces, as published.

Args:
    a, b: shapes.
    Ta, Tb: their poses (..., 4, 4), rigid, meters; leading dimensions broadcast.
    margin: meters; shapes no farther apart than this collide. With a margin over 0 the result is
        exact for all methods, as distances are.
    threads: for arrays; None: FGENV_THREADS, else all cores. The result does not depend on it.

Returns:
    bool for single poses, else a bool array of the broadcast shape.

Raises:
    TypeError, ValueError: the argument, the value received and the value expected.)");
    m.def("distance", &distance, "a"_a.none(), "Ta"_a.none(), "b"_a.none(), "Tb"_a.none(), nb::kw_only(),
          "threads"_a = nb::none(),
          R"(Distance of two posed shapes in meters; 0 exactly where they collide, containment included.

Exact for all methods, to within the rounding of coordinates: 4e-15 of their size. A gap that rounding
hides has a distance above 0 and below 1e-150.

Args:
    a, b, Ta, Tb, threads: as for collide.

Returns:
    float for single poses, else a float64 array of the broadcast shape.)");
    m.def("nearest_points", &nearest_points, "a"_a.none(), "Ta"_a.none(), "b"_a.none(), "Tb"_a.none(), nb::kw_only(),
          "threads"_a = nb::none());
    m.def("contact_point", &contact_point, "a"_a.none(), "Ta"_a.none(), "b"_a.none(), "Tb"_a.none());
    m.def("contains", &contains, "shape"_a, "points"_a.none(), "T"_a.none(), nb::kw_only(), "threads"_a = nb::none());
    m.def("raycast", &raycast, "shape"_a, "origins"_a.none(), "directions"_a.none(), "T"_a.none(), nb::kw_only(),
          "max_distance"_a.none(), "threads"_a = nb::none());
}

}  // namespace fgenv
