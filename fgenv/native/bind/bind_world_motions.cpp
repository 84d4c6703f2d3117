// Python class of a world: motions of one robot or of several at once, over poses in parallel.
#include <algorithm>

#include "bind/bind_world.h"
#include "bind/parallel.h"

namespace fgenv {
namespace {

using namespace nb::literals;

double resolution_of(nb::handle mode, nb::handle value) {
    std::string text;
    if (!nb::try_cast(mode, text) || (text != "continuous" && text != "discrete"))
        fail(std::string("mode: got ") + nb::repr(mode).c_str() + ", expected continuous or discrete");
    if ((text == "discrete") == value.is_none())
        fail(std::string("resolution: got ") + nb::repr(value).c_str() +
             ", expected meters with mode='discrete', else None");
    double meters = 0;
    if (!value.is_none() && (!nb::try_cast(value, meters) || !(meters > 0) || std::isinf(meters)))
        fail(std::string("resolution: got ") + nb::repr(value).c_str() + ", expected meters above 0");
    return meters;
}

MotionSettings settings_of(nb::handle margin, nb::handle tolerance, double resolution, bool first,
                           nb::handle start_time, nb::handle end_time) {
    MotionSettings s;
    s.certify.margin = meters_of(margin, "margin");
    s.certify.tolerance = meters_of(tolerance, "tolerance");
    if (!(s.certify.tolerance > 0)) fail(received("tolerance", tolerance, "meters above 0"));
    s.resolution = resolution;
    s.certify.first = first;
    if (start_time.is_none() != end_time.is_none())
        fail("start_time, end_time: got one of them, expected both (seconds) or neither");
    if (!start_time.is_none() && (!nb::try_cast(start_time, s.from) || !nb::try_cast(end_time, s.to) ||
                                  !std::isfinite(s.from) || !std::isfinite(s.to) || s.to < s.from))
        fail(std::string("start_time, end_time: got ") + nb::repr(start_time).c_str() + " and " +
             nb::repr(end_time).c_str() + ", expected one number each: finite seconds, end_time not before start_time");
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

nb::tuple check_motion(const World& w, nb::handle robot, nb::handle start, nb::handle end, nb::handle margin,
                       nb::handle tolerance, nb::handle mode, nb::handle resolution, nb::handle first,
                       nb::handle start_time, nb::handle end_time, nb::handle threads) {
    const Asked a = asked(robot, "robot");
    const Model model = model_of(w, a);
    const Places from = places(model, start, "start"), to = places(model, end, "end");
    const MotionSettings s = settings_of(margin, tolerance, resolution_of(mode, resolution),
                                         flag_of(first, "first_contact"), start_time, end_time);
    const Broadcast shape = broadcast({{"start", from.dims()}, {"end", to.dims()}});
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId id = mover_of(w, a, model);
    if (shape.dims.empty()) {
        const MotionOutcome o = w.check_motion(id, from[0], to[0], s);
        return nb::make_tuple(!o.contact.found, o.contact.found ? o.contact.free_until : 1.0,
                              o.contact.found ? o.contact.shown : HUGE_VAL, o.other, o.part, o.checks);
    }
    Outcomes out(shape.dims);
    parallel_for(shape.size, n, [&](int64_t lo, int64_t hi) {
        for (int64_t i = lo; i < hi; ++i)
            out.put(i, w.check_motion(id, from[shape.offset(0, i)], to[shape.offset(1, i)], s));
    });
    return out.tuple();
}

nb::object motions_collide(const World& w, nb::handle a, nb::handle start_a, nb::handle end_a, nb::handle b,
                           nb::handle start_b, nb::handle end_b, nb::handle margin, nb::handle tolerance,
                           nb::handle threads) {
    const Asked first = asked(a, "a"), second = asked(b, "b");
    const Model model_a = model_of(w, first, "a"), model_b = model_of(w, second, "b");
    const Places from_a = places(model_a, start_a, "start_a"), to_a = places(model_a, end_a, "end_a");
    const Places from_b = places(model_b, start_b, "start_b"), to_b = places(model_b, end_b, "end_b");
    MotionSettings s = settings_of(margin, tolerance, 0, false, nb::none(), nb::none());
    const Broadcast shape = broadcast(
        {{"start_a", from_a.dims()}, {"end_a", to_a.dims()}, {"start_b", from_b.dims()}, {"end_b", to_b.dims()}});
    const int n = threads_of(threads);
    const auto lock = reading(w);
    const BodyId one = mover_of(w, first, model_a, "a"), other = mover_of(w, second, model_b, "b");
    if (one == other) fail("a, b: got the same robot twice, expected two robots");
    const auto ask = [&](int64_t i) {
        return w.motions_collide(one, from_a[shape.offset(0, i)], to_a[shape.offset(1, i)], other,
                                 from_b[shape.offset(2, i)], to_b[shape.offset(3, i)], s);
    };
    if (shape.dims.empty()) return nb::cast(ask(0));
    Output<bool> out = make_output<bool>(shape.dims);
    parallel_for(shape.size, n, [&](int64_t lo, int64_t hi) {
        for (int64_t i = lo; i < hi; ++i) out.data[i] = ask(i);
    });
    return nb::cast(out.array);
}

// Common model of several movers: all bodies, or robots with the same coordinates.
std::vector<Model> models_of(const World& w, const AskedBodies& all, const char* name) {
    const auto lock = reading(w);
    std::vector<Model> out;
    for (const Asked& a : all.items) {
        out.push_back(w.body(robot_of(w, a, name)).robot);
        const Model &first = out[0], &last = out.back();
        if (!first != !last || (first && (first->coordinates != last->coordinates || first->most != last->most)))
            fail(std::string(name) + ": got '" + a.text() + "' and '" + all.items[0].text() +
                 "' with different coordinates, expected only bodies, or robots with the same coordinates");
    }
    return out;
}

void refuse_twice(std::vector<BodyId> ids) {
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice != ids.end()) fail("robots: got body " + std::to_string(*twice) + " twice, expected distinct robots");
}

// Motions of several movers, computed without the interpreter's lock.
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

nb::tuple check_motions(const World& w, nb::handle robots, nb::handle start, nb::handle end, nb::handle margin,
                        nb::handle tolerance, nb::handle start_time, nb::handle end_time) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Model> models = models_of(w, all, "robots");
    const Model model = models.empty() ? nullptr : models[0];
    const Places from = places(model, start, "start"), to = places(model, end, "end");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, start_time, end_time);
    const auto lock = reading(w);
    const std::vector<BodyId> ids = all.ids(w, "robots");
    const Dims expected{static_cast<int64_t>(ids.size())};
    const Broadcast shape = broadcast({{"robots", expected}, {"start", from.dims()}, {"end", to.dims()}});
    if (all.one || shape.dims != expected)
        fail(std::string("robots, start, end: got other shapes, expected (n,), ") +
             (model ? "(n, nq), (n, nq)" : "(n, 4, 4), (n, 4, 4)"));
    refuse_twice(ids);
    std::vector<Place> starts, ends;
    for (size_t i = 0; i < ids.size(); ++i) {
        mover_of(w, all.items[i], models[i], "robots");
        starts.push_back(from[shape.offset(1, static_cast<int64_t>(i))]);
        ends.push_back(to[shape.offset(2, static_cast<int64_t>(i))]);
    }
    return outcomes_of([&] { return w.check_motions(ids, starts, ends, s); });
}

nb::tuple advance(World& w, nb::handle robots, nb::handle end, nb::handle margin, nb::handle tolerance,
                  nb::handle start_time, nb::handle end_time) {
    const AskedBodies all = asked_bodies(robots, "robots");
    const std::vector<Model> models = models_of(w, all, "robots");
    const Places ends = places(models.empty() ? nullptr : models[0], end, "end");
    const MotionSettings s = settings_of(margin, tolerance, 0, true, start_time, end_time);
    const auto lock = writing(w);
    std::vector<BodyId> ids;
    for (size_t i = 0; i < all.items.size(); ++i) ids.push_back(mover_of(w, all.items[i], models[i], "robots"));
    refuse_twice(ids);
    if (all.one || ends.dims() != Dims{static_cast<int64_t>(ids.size())})
        fail(std::string("robots, end: got other shapes, expected (n,) and (n") + ends.row());
    const std::vector<Place> there = ends.all();
    return outcomes_of([&] { return w.advance(ids, there, s); });
}

}  // namespace

void bind_world_motions(nb::class_<World>& c) {
    c.def("check_motion", &check_motion, "robot"_a.none(), "start"_a.none(), "end"_a.none(), nb::kw_only(),
          "margin"_a.none(), "tolerance"_a.none(), "mode"_a.none(), "resolution"_a.none(), "first_contact"_a.none(),
          "start_time"_a.none(), "end_time"_a.none(), "threads"_a.none())
        .def("motions_collide", &motions_collide, "a"_a.none(), "start_a"_a.none(), "end_a"_a.none(), nb::kw_only(),
             "b"_a.none(), "start_b"_a.none(), "end_b"_a.none(), "margin"_a.none(), "tolerance"_a.none(),
             "threads"_a.none())
        .def("check_motions", &check_motions, "robots"_a.none(), "start"_a.none(), "end"_a.none(), nb::kw_only(),
             "margin"_a.none(), "tolerance"_a.none(), "start_time"_a.none(), "end_time"_a.none())
        .def("advance", &advance, "robots"_a.none(), "end"_a.none(), nb::kw_only(), "margin"_a.none(),
             "tolerance"_a.none(), "start_time"_a.none(), "end_time"_a.none());
}

}  // namespace fgenv
