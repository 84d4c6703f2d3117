// Python class of a world: what is asked of it, the loop over poses in parallel.
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

nb::object collides(const World& w, nb::handle robot, nb::handle poses_, nb::handle times, double margin,
                    nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Posed p = posed(model, poses_, times);
    meters_of(margin, "margin");
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

double resolution_of(nb::handle mode, nb::handle value) {
    std::string text;
    if (!nb::try_cast(mode, text) || (text != "continuous" && text != "discrete"))
        fail(std::string("mode: ") + nb::repr(mode).c_str() + " is unknown, expected continuous or discrete");
    if ((text == "discrete") == value.is_none())
        fail("resolution: expected meters with mode='discrete', and only then");
    double meters = 0;
    if (!value.is_none() && (!nb::try_cast(value, meters) || !(meters > 0) || std::isinf(meters)))
        fail(std::string("resolution: ") + nb::repr(value).c_str() + ", expected meters, over 0");
    return meters;
}

MotionSettings settings_of(double margin, double tolerance, double resolution, bool first, nb::handle t0,
                           nb::handle t1) {
    MotionSettings s;
    s.certify.margin = meters_of(margin, "margin");
    s.certify.tolerance = meters_of(tolerance, "tolerance");
    if (!(tolerance > 0)) fail("tolerance: expected meters, over 0");
    s.resolution = resolution;
    s.certify.first = first;
    if (t0.is_none() != t1.is_none()) fail("t0, t1: expected both (seconds), or neither");
    if (!t0.is_none() && (!nb::try_cast(t0, s.from) || !nb::try_cast(t1, s.to) || !std::isfinite(s.from) ||
                          !std::isfinite(s.to) || s.to < s.from))
        fail("t0, t1: expected finite seconds, t1 not before t0");
    return s;
}

struct Outcomes {
    Output<bool> free;
    Output<double> contact, contact_by;
    Output<int32_t> other, part;
    Output<int64_t> checks;

    explicit Outcomes(const Dims& dims)
        : free(make_output<bool>(dims)),
          contact(make_output<double>(dims)),
          contact_by(make_output<double>(dims)),
          other(make_output<int32_t>(dims)),
          part(make_output<int32_t>(dims)),
          checks(make_output<int64_t>(dims)) {}
    void put(int64_t i, const MotionOutcome& o) {
        free.data[i] = !o.contact.found;
        contact.data[i] = o.contact.found ? o.contact.free_until : 1;
        contact_by.data[i] = o.contact.found ? o.contact.shown : HUGE_VAL;
        other.data[i] = o.other;
        part.data[i] = o.part;
        checks.data[i] = o.checks;
    }
    nb::tuple tuple() const {
        return nb::make_tuple(free.array, contact.array, contact_by.array, other.array, part.array, checks.array);
    }
};

nb::tuple check_motion(const World& w, nb::handle robot, nb::handle T0, nb::handle T1, double margin, double tolerance,
                       nb::handle mode, nb::handle resolution, bool first, nb::handle t0, nb::handle t1,
                       nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Places from = places(model, T0, "T0"), to = places(model, T1, "T1");
    const MotionSettings s = settings_of(margin, tolerance, resolution_of(mode, resolution), first, t0, t1);
    const Broadcast shape = broadcast({{"T0", from.dims()}, {"T1", to.dims()}});
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, model);
    if (shape.dims.empty()) {
        const MotionOutcome o = w.check_motion(id, from[0], to[0], s);
        return nb::make_tuple(!o.contact.found, o.contact.found ? o.contact.free_until : 1.0,
                              o.contact.found ? o.contact.shown : HUGE_VAL, o.other, o.part, o.checks);
    }
    Outcomes out(shape.dims);
    parallel_for(shape.size, n, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i)
            out.put(i, w.check_motion(id, from[shape.offset(0, i)], to[shape.offset(1, i)], s));
    });
    return out.tuple();
}

nb::object meet(const World& w, nb::handle a, nb::handle A0, nb::handle A1, nb::handle b, nb::handle B0, nb::handle B1,
                double margin, double tolerance, nb::handle threads) {
    const Asked first = asked(a, "a"), second = asked(b, "b");
    const Model model_a = model_of(w, first, "a"), model_b = model_of(w, second, "b");
    const Places from_a = places(model_a, A0, "A0"), to_a = places(model_a, A1, "A1");
    const Places from_b = places(model_b, B0, "B0"), to_b = places(model_b, B1, "B1");
    MotionSettings s = settings_of(margin, tolerance, 0, false, nb::none(), nb::none());
    const Broadcast shape =
        broadcast({{"A0", from_a.dims()}, {"A1", to_a.dims()}, {"B0", from_b.dims()}, {"B1", to_b.dims()}});
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId one = mover_of(w, first, model_a, "a"), other = mover_of(w, second, model_b, "b");
    if (one == other) fail("a, b: the same robot, expected two");
    const auto ask = [&](int64_t i) {
        return w.meet(one, from_a[shape.offset(0, i)], to_a[shape.offset(1, i)], other, from_b[shape.offset(2, i)],
                      to_b[shape.offset(3, i)], s);
    };
    if (shape.dims.empty()) return nb::cast(ask(0));
    Output<bool> out = make_output<bool>(shape.dims);
    parallel_for(shape.size, n, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) out.data[i] = ask(i);
    });
    return nb::cast(out.array);
}

// Of movers that are asked together: all bodies, or robots with the same coordinates.
std::vector<Model> models_of(const World& w, const AskedBodies& all, const char* name) {
    const auto lock = reading(w);
    std::vector<Model> out;
    for (const Asked& a : all.items) {
        out.push_back(w.body(robot_of(w, a, name)).robot);
        const Model &first = out[0], &last = out.back();
        if (!first != !last || (first && (first->coordinates != last->coordinates || first->most != last->most)))
            fail(std::string(name) + ": '" + a.text() + "' has other coordinates than '" + all.items[0].text() +
                 "', expected bodies alone, or robots of one kind");
    }
    return out;
}

void refuse_twice(std::vector<BodyId> ids) {
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice != ids.end()) fail("robots: body " + std::to_string(*twice) + " is named twice");
}

// Of many movers, found with the interpreter free.
template <class F>
nb::tuple outcomes_of(F find) {
    std::vector<MotionOutcome> found;
    {
        nb::gil_scoped_release released;
        found = find();
    }
    Outcomes out({static_cast<int64_t>(found.size())});
    for (size_t i = 0; i < found.size(); ++i) out.put(static_cast<int64_t>(i), found[i]);
    return out.tuple();
}

nb::tuple check_motions(const World& w, nb::handle robots, nb::handle T0, nb::handle T1, double margin,
                        double tolerance, nb::handle t0, nb::handle t1) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Model> models = models_of(w, all, "robots");
    const Model model = models.empty() ? nullptr : models[0];
    const Places from = places(model, T0, "T0"), to = places(model, T1, "T1");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, t0, t1);
    const auto lock = reading(w);
    const std::vector<BodyId> ids = all.ids(w, "robots");
    const Dims expected{static_cast<int64_t>(ids.size())};
    const Broadcast shape = broadcast({{"robots", expected}, {"T0", from.dims()}, {"T1", to.dims()}});
    if (all.one || shape.dims != expected)
        fail(std::string("robots, T0, T1: expected (n,), ") + (model ? "(n, nq), (n, nq)" : "(n, 4, 4), (n, 4, 4)"));
    refuse_twice(ids);
    std::vector<Place> begin, end;
    for (size_t i = 0; i < ids.size(); ++i) {
        mover_of(w, all.items[i], models[i], "robots");
        begin.push_back(from[shape.offset(1, static_cast<int64_t>(i))]);
        end.push_back(to[shape.offset(2, static_cast<int64_t>(i))]);
    }
    return outcomes_of([&] { return w.check_motions(ids, begin, end, s); });
}

nb::tuple advance(World& w, nb::handle robots, nb::handle to, double margin, double tolerance, nb::handle t0,
                  nb::handle t1) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Model> models = models_of(w, all, "robots");
    const Places ends = places(models.empty() ? nullptr : models[0], to, "to");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, t0, t1);
    const auto lock = writing(w);
    std::vector<BodyId> ids;
    for (size_t i = 0; i < all.items.size(); ++i) ids.push_back(mover_of(w, all.items[i], models[i], "robots"));
    refuse_twice(ids);
    if (all.one || ends.dims() != Dims{static_cast<int64_t>(ids.size())})
        fail(std::string("robots, to: expected (n,) and (n") + ends.row());
    const std::vector<Place> there = ends.all();
    return outcomes_of([&] { return w.advance(ids, there, s); });
}

nb::object contacts(const World& w, double margin, nb::handle threads) {
    meters_of(margin, "margin");
    const int n = threads_of(threads);
    const auto lock = reading(w);
    std::vector<std::pair<BodyId, BodyId>> pairs;
    std::mutex gathering;
    parallel_for(
        w.blocks(), n,
        [&](int64_t first, int64_t last) {
            std::vector<std::pair<BodyId, BodyId>> found;
            for (int64_t block = first; block < last; ++block)
                w.contacts_of_block(static_cast<int32_t>(block), margin, found);
            const std::lock_guard<std::mutex> guard(gathering);
            pairs.insert(pairs.end(), found.begin(), found.end());
        },
        16);
    std::sort(pairs.begin(), pairs.end());
    std::vector<int32_t> rows;
    for (const auto& [a, b] : pairs) rows.insert(rows.end(), {a, b});
    return copy_out(rows.data(), {static_cast<int64_t>(rows.size() / 2)}, {2});
}

nb::object raycast(const World& w, nb::handle origins, nb::handle directions, double max_distance, nb::handle ignored,
                   nb::handle threads) {
    const Array<double> o = points(origins, "origins"), d = directions_of(directions, "directions");
    if (!(max_distance >= 0)) fail("max_distance: expected meters, 0 or more");
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
            const WorldHit hit =
                w.raycast({p[0], p[1], p[2]}, direction_of(d.data() + 3 * shape.offset(1, i)), max_distance, skip);
            distance.data[i] = hit.distance;
            body.data[i] = hit.body;
        }
    });
    return nb::make_tuple(distance.array, body.array);
}

}  // namespace

void bind_world_queries(nb::class_<World>& c) {
    c.def("collides", &collides, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), "margin"_a, "threads"_a.none())
        .def("clearance", &clearance, "robot"_a.none(), "poses"_a.none(), "times"_a.none(), "threads"_a.none())
        .def("check_motion", &check_motion, "robot"_a.none(), "T0"_a.none(), "T1"_a.none(), "margin"_a, "tolerance"_a,
             "mode"_a.none(), "resolution"_a.none(), "first"_a, "t0"_a.none(), "t1"_a.none(), "threads"_a.none())
        .def("meet", &meet, "a"_a.none(), "A0"_a.none(), "A1"_a.none(), "b"_a.none(), "B0"_a.none(), "B1"_a.none(),
             "margin"_a, "tolerance"_a, "threads"_a.none())
        .def("check_motions", &check_motions, "robots"_a.none(), "T0"_a.none(), "T1"_a.none(), "margin"_a,
             "tolerance"_a, "t0"_a.none(), "t1"_a.none())
        .def("advance", &advance, "robots"_a.none(), "to"_a.none(), "margin"_a, "tolerance"_a, "t0"_a.none(),
             "t1"_a.none())
        .def("contacts", &contacts, "margin"_a, "threads"_a.none())
        .def("raycast", &raycast, "origins"_a.none(), "directions"_a.none(), "max_distance"_a, "ignore"_a.none(),
             "threads"_a.none());
}

}  // namespace fgenv
