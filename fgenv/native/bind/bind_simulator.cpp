// Python class of the batched simulator: arrays over (worlds, robots, ...) in and out.
#include "bind/bind_simulator.h"

#include <nanobind/stl/vector.h>

#include "bind/bind.h"
#include "bind/bind_drive.h"
#include "bind/parallel.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr int64_t worlds_per_chunk = 4;  // of a thread: enough work to outweigh the synchronization

// World numbers; None: all.
std::vector<int32_t> world_numbers(const Simulator& sim, nb::handle value) {
    std::vector<int32_t> out;
    if (value.is_none()) {
        for (int32_t e = 0; e < sim.n_worlds(); ++e) out.push_back(e);
        return out;
    }
    const Array<int64_t> a = indices(value, "worlds");
    std::vector<bool> listed(sim.n_worlds());
    for (size_t k = 0; k < a.view.size(); ++k) {
        const int64_t e = a.data()[k];
        if (e < 0 || e >= sim.n_worlds())
            fail("worlds: got " + std::to_string(e) + ", expected 0 to " + std::to_string(sim.n_worlds() - 1));
        if (listed[e]) fail("worlds: got " + std::to_string(e) + " twice, expected distinct numbers");
        listed[e] = true;
        out.push_back(static_cast<int32_t>(e));
    }
    return out;
}

void for_worlds(size_t n, nb::handle threads, const std::function<void(int32_t)>& body) {
    parallel_for(
        static_cast<int64_t>(n), threads_of(threads),
        [&](int64_t first, int64_t last) {
            for (int64_t k = first; k < last; ++k) body(static_cast<int32_t>(k));
        },
        worlds_per_chunk);
}

Array<double> actions_of(const Simulator& sim, nb::handle value, const char* name) {
    const Array<double> a = doubles(value, name);
    const Dims expected{sim.n_worlds(), sim.n_robots(), sim.action_size()};
    if (a.dims != expected)
        fail(std::string(name) + ": got shape " + to_string(a.dims) + ", expected " + to_string(expected) +
             ", (worlds, robots, action)");
    for (size_t i = 0; i < a.view.size(); ++i)
        if (!std::isfinite(a.data()[i]))
            fail(name + index_text(a.dims, static_cast<int64_t>(i)) + ": got " + number(a.data()[i]) +
                 ", expected a number in [-1, 1]");
    return a;
}

int64_t action_stride(const Simulator& sim) { return int64_t(sim.n_robots()) * sim.action_size(); }
int64_t row_stride(const Simulator& sim) { return int64_t(sim.n_robots()) * sim.observer().size(); }

Output<float> make_rows(const Simulator& sim, size_t worlds) {
    return make_output<float>({static_cast<int64_t>(worlds), sim.n_robots()}, {sim.observer().size()});
}

nb::object reset(Simulator& sim, nb::handle worlds, nb::handle seeds, nb::handle threads) {
    const std::vector<int32_t> which = world_numbers(sim, worlds);
    std::vector<uint64_t> seed;
    if (!seeds.is_none()) {
        const Array<int64_t> a = indices(seeds, "seeds");
        if (a.dims != Dims{static_cast<int64_t>(which.size())})
            fail("seeds: got shape " + to_string(a.dims) + ", expected one per world");
        seed.assign(a.data(), a.data() + which.size());
    }
    Output<float> out = make_rows(sim, which.size());
    for_worlds(which.size(), threads, [&](int32_t k) {
        sim.reset(which[k], seed.empty() ? nullptr : &seed[k]);
        sim.observe(which[k], out.data + k * row_stride(sim));
    });
    return nb::cast(out.array);
}

nb::object observe(const Simulator& sim, nb::handle threads) {
    Output<float> out = make_rows(sim, sim.n_worlds());
    for_worlds(sim.n_worlds(), threads, [&](int32_t e) { sim.observe(e, out.data + e * row_stride(sim)); });
    return nb::cast(out.array);
}

nb::tuple step(Simulator& sim, nb::handle actions, nb::handle threads) {
    const Array<double> a = actions_of(sim, actions, "actions");
    Output<float> rows = make_rows(sim, sim.n_worlds());
    Output<double> reward = make_output<double>(per_robot(sim));
    Output<bool> arrived = make_output<bool>(per_robot(sim));
    Output<bool> terminated = make_output<bool>({sim.n_worlds()}), truncated = make_output<bool>({sim.n_worlds()});
    const int32_t n = sim.n_robots();
    for_worlds(sim.n_worlds(), threads, [&](int32_t e) {
        sim.step(e, a.data() + e * action_stride(sim));
        sim.observe(e, rows.data + e * row_stride(sim));
        const Episode& episode = sim.episode(e);
        for (int32_t i = 0; i < n; ++i) {
            reward.data[e * n + i] = episode.robots[i].reward;
            arrived.data[e * n + i] = episode.robots[i].status != Status::moving;
        }
        terminated.data[e] = episode.terminated;
        truncated.data[e] = episode.truncated;
    });
    return nb::make_tuple(rows.array, reward.array, arrived.array, terminated.array, truncated.array);
}

nb::object would_collide(const Simulator& sim, nb::handle actions, nb::handle threads) {
    const Array<double> a = actions_of(sim, actions, "actions");
    Output<bool> out = make_output<bool>(per_robot(sim));
    for_worlds(sim.n_worlds(), threads, [&](int32_t e) {
        const std::vector<bool> hit = sim.would_collide(e, a.data() + e * action_stride(sim));
        std::copy(hit.begin(), hit.end(), out.data + int64_t(e) * sim.n_robots());
    });
    return nb::cast(out.array);
}

nb::object safe_actions(const Simulator& sim, nb::handle actions, nb::handle rest, nb::handle threads) {
    const Array<double> a = actions_of(sim, actions, "actions"), r = actions_of(sim, rest, "rest");
    Output<double> out = make_output<double>(per_robot(sim), {sim.action_size()});
    std::copy(a.data(), a.data() + a.view.size(), out.data);
    for_worlds(sim.n_worlds(), threads, [&](int32_t e) {
        sim.make_safe(e, r.data() + e * action_stride(sim), out.data + e * action_stride(sim));
    });
    return nb::cast(out.array);
}

std::vector<double> configuration_of(const Simulator& sim, int32_t i, nb::handle value, const char* name) {
    const Configurations c = configurations(*sim.spec(i).robot, value, name);
    if (!c.dims.empty())
        fail(std::string(name) + ": got " + to_string(c.dims) + " configurations, expected one, shape (nq,)");
    return {c.row(0), c.row(0) + c.nq};
}

void place(Simulator& sim, int32_t e, int32_t i, nb::handle start, nb::handle goal) {
    check_robot(sim, e, i);
    sim.place(e, i, configuration_of(sim, i, start, "start"), configuration_of(sim, i, goal, "goal"));
}

void set_path(Simulator& sim, int32_t e, int32_t i, nb::handle path) {
    check_robot(sim, e, i);
    const Configurations c = configurations(*sim.spec(i).robot, path, "path");
    if (c.dims.size() != 1 || c.dims[0] == 0)
        fail("path: got " + to_string(c.dims) + " waypoints, expected (K, nq) with K at least 1");
    Waypoints waypoints;
    for (int64_t k = 0; k < c.dims[0]; ++k) waypoints.emplace_back(c.row(k), c.row(k) + c.nq);
    sim.set_path(e, i, std::move(waypoints));
}

// Targets (worlds, robots, most coordinates) to actions of the drives.
nb::object actions_toward(const Simulator& sim, nb::handle targets) {
    const Array<double> t = doubles(targets, "targets");
    const int64_t nq = most_coordinates(sim), n = sim.n_robots(), width = most_actions(sim);
    const Dims expected{sim.n_worlds(), n, nq};
    if (t.dims != expected) fail("targets: got shape " + to_string(t.dims) + ", expected " + to_string(expected));
    for (size_t i = 0; i < t.view.size(); ++i)
        if (!(std::fabs(t.data()[i]) <= 1e5))
            fail("targets" + index_text(t.dims, static_cast<int64_t>(i)) + ": got " + number(t.data()[i]) +
                 ", expected a number in [-1e5, 1e5]");
    Output<double> out = make_output<double>(per_robot(sim), {width});
    for (int32_t e = 0; e < sim.n_worlds(); ++e)
        for (int32_t i = 0; i < n; ++i) sim.toward(e, i, t.data() + (e * n + i) * nq, out.data + (e * n + i) * width);
    return nb::cast(out.array);
}

nb::bytes state_of(Simulator& sim) {
    Writer out;
    for (int32_t e = 0; e < sim.n_worlds(); ++e) sim.save(e, out);
    return nb::bytes(out.bytes().data(), out.bytes().size());
}

void set_state(Simulator& sim, const nb::bytes& state) {
    Reader in(std::string(state.c_str(), state.size()));
    for (int32_t e = 0; e < sim.n_worlds(); ++e) sim.load(e, in);
    if (!in.done()) damaged_state();
}

std::vector<int32_t> action_sizes(const Simulator& sim) {
    std::vector<int32_t> out;
    for (int32_t i = 0; i < sim.n_robots(); ++i) out.push_back(sim.action_size(i));
    return out;
}

nb::list slices(const Simulator& sim, int32_t robot) {
    check_robot(sim, 0, robot);
    nb::list out;
    for (const Slice& slice : sim.observer().slices(robot))
        out.append(nb::make_tuple(slice.name, slice.begin, slice.size));
    return out;
}

CaseBodies case_bodies(const std::vector<BodyId>& ids, nb::handle value) {
    CaseBodies out{ids, {}};
    if (ids.empty()) return out;
    const Poses p = poses(value, "poses");
    for (size_t k = 0; k < p.size(); ++k) {
        if (k % ids.size() == 0) out.poses.emplace_back();
        out.poses.back().push_back(p[k]);
    }
    return out;
}

}  // namespace

void check_robot(const Simulator& sim, int32_t world, int32_t robot) {
    if (world < 0 || world >= sim.n_worlds())
        fail("world: got " + std::to_string(world) + ", expected 0 to " + std::to_string(sim.n_worlds() - 1));
    if (robot < 0 || robot >= sim.n_robots())
        fail("robot: got " + std::to_string(robot) + ", expected 0 to " + std::to_string(sim.n_robots() - 1));
}

void bind_simulator(nb::module_& m) {
    bind_simulator_specs(m);
    nb::class_<Simulator> c(m, "Simulator");
    c.def(
         "__init__",
         [](Simulator* self, const World& like, const std::vector<RobotSpec>& robots, const nb::dict& settings,
            int32_t worlds, const std::vector<BodyId>& bodies, nb::handle poses,
            const std::vector<Footprint>& footprints) {
             if (robots.empty() || worlds < 1) fail("robots, worlds: got none, expected at least one of each");
             new (self)
                 Simulator(like, robots, simulator_settings(settings), worlds, case_bodies(bodies, poses), footprints);
         },
         "world"_a, "robots"_a, nb::kw_only(), "settings"_a, "worlds"_a, "bodies"_a, "poses"_a.none(), "footprints"_a)
        .def("action_sizes", &action_sizes)
        .def("slices", &slices, "robot"_a)
        .def("reset", &reset, "worlds"_a.none(), "seeds"_a.none(), "threads"_a.none())
        .def("observe", &observe, "threads"_a.none())
        .def("step", &step, "actions"_a.none(), "threads"_a.none())
        .def("would_collide", &would_collide, "actions"_a.none(), "threads"_a.none())
        .def("safe_actions", &safe_actions, "actions"_a.none(), "rest"_a.none(), "threads"_a.none())
        .def("place", &place, "world"_a, "robot"_a, nb::kw_only(), "start"_a.none(), "goal"_a.none())
        .def("set_path", &set_path, "world"_a, "robot"_a, "path"_a.none())
        .def("toward", &actions_toward, "targets"_a.none())
        .def("state", &state_of)
        .def("set_state", &set_state, "state"_a);
    bind_simulator_state(c);
}

}  // namespace fgenv
