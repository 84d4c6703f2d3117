// Python class of a world: queries at poses and at the current state, over poses in parallel.
#include "bind/bind_world.h"

#include <algorithm>

#include "bind/parallel.h"

namespace fgenv {
namespace {

using namespace nb::literals;

struct Posed {
    Places places;
    Array<double> times;
    bool has_times;
    Broadcast shape;

    double time(int64_t i) const { return has_times ? times.data()[shape.offset(1, i)] : now; }
    Place place(int64_t i) const { return places[shape.offset(0, i)]; }
    bool single() const { return shape.dims.empty(); }
};

Posed posed(const Model& model, nb::handle poses_, nb::handle times) {
    Posed out{places(model, poses_, "poses"), {}, !times.is_none(), {}};
    if (out.has_times) out.times = times_of(times, "times");
    out.shape = broadcast({{"poses", out.places.dims()}, {"times", out.times.dims}});
    return out;
}

nb::object collides(const World& w, nb::handle robot, nb::handle poses_, nb::handle times, nb::handle margin_,
                    nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Posed p = posed(model, poses_, times);
    const double margin = meters_of(margin_, "margin");
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, model);
    if (p.single()) return nb::cast(w.collides(id, p.place(0), p.time(0), margin));
    Output<bool> out = make_output<bool>(p.shape.dims);
    parallel_for(p.shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) out.data[i] = w.collides(id, p.place(i), p.time(i), margin);
    });
    return nb::cast(out.array);
}

nb::object clearance(const World& w, nb::handle robot, nb::handle poses_, nb::handle times, nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Posed p = posed(model, poses_, times);
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, model);
    Output<double> distance = make_output<double>(p.shape.dims);
    Output<int32_t> other = make_output<int32_t>(p.shape.dims);
    parallel_for(p.shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const Clearance found = w.clearance({id}, {p.place(i)}, p.time(i));
            distance.data[i] = found.distance;
            other.data[i] = found.other;
        }
    });
    return nb::make_tuple(distance.array, other.array);
}

nb::object contact_pairs(const World& w, nb::handle margin_, nb::handle threads) {
    const double margin = meters_of(margin_, "margin");
    const int n = threads_of(threads);
    const auto lock = reading(w);
    std::vector<std::pair<BodyId, BodyId>> pairs;
    std::mutex gathering;
    parallel_for(
        w.blocks(), n,
        [&](int64_t first, int64_t last) {
            std::vector<std::pair<BodyId, BodyId>> found;
            for (int64_t block = first; block < last; ++block)
                w.contact_pairs_of_block(static_cast<int32_t>(block), margin, found);
            const std::lock_guard<std::mutex> guard(gathering);
            pairs.insert(pairs.end(), found.begin(), found.end());
        },
        16);
    std::sort(pairs.begin(), pairs.end());
    std::vector<int32_t> rows;
    for (const auto& [a, b] : pairs) rows.insert(rows.end(), {a, b});
    return copy_out(rows.data(), {static_cast<int64_t>(rows.size() / 2)}, {2});
}

nb::object raycast(const World& w, nb::handle origins, nb::handle directions, nb::handle max_distance_,
                   nb::handle ignored, nb::handle threads) {
    const Array<double> o = points(origins, "origins"), d = directions_of(directions, "directions");
    const double max_distance = meters_of(max_distance_, "max_distance", true);
    const Broadcast shape = broadcast({{"origins", rows_of(o)}, {"directions", rows_of(d)}});
    const int n = threads_of(threads);
    Output<double> distance = make_output<double>(shape.dims);
    Output<int32_t> body = make_output<int32_t>(shape.dims);
    const AskedBodies ignore = ignored.is_none() ? AskedBodies{{}, false} : asked_bodies(ignored, "ignore");
    const auto lock = reading(w);
    std::vector<BodyId> skip = ignore.ids(w, "ignore");
    std::sort(skip.begin(), skip.end());
    parallel_for(shape.size, n, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const double* p = o.data() + 3 * shape.offset(0, i);
            const auto [direction, length] = ray_direction_of(d.data() + 3 * shape.offset(1, i));
            const WorldHit hit = w.raycast({p[0], p[1], p[2]}, direction, reach_of(max_distance, length), skip);
            const double meters = hit.distance * length;
            const bool within = hit.body >= 0 && meters <= max_distance;
            distance.data[i] = within ? meters : HUGE_VAL;
            body.data[i] = within ? hit.body : -1;
        }
    });
    return nb::make_tuple(distance.array, body.array);
}

}  // namespace

void bind_world_queries(nb::class_<World>& c) {
    c.def("collides", &collides, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), nb::kw_only(), "margin"_a.none(),
          "threads"_a.none())
        .def("clearance", &clearance, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), nb::kw_only(),
             "threads"_a.none())
        .def("contact_pairs", &contact_pairs, "margin"_a.none(), "threads"_a.none())
        .def("raycast", &raycast, "origins"_a.none(), "directions"_a.none(), "max_distance"_a.none(), nb::kw_only(),
             "ignore"_a.none(), "threads"_a.none());
}

}  // namespace fgenv
