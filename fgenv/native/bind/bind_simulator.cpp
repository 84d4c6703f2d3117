// Python class of the batched simulator: arrays over (worlds, robots, ...) in and out.
#include "bind/bind_world.h"

#include <nanobind/stl/pair.h>

#include "bind/bind.h"
#include "bind/bind_drive.h"
#include "bind/parallel.h"
#include "simulator/simulator.h"

namespace fgenv {
namespace {

using namespace nb::literals;

// Chunks of worlds that a thread takes at once: enough work to pay for taking them.
constexpr int64_t chunk = 4;

std::vector<std::vector<double>> rows_of(nb::handle value, const char* name, int32_t width) {
    const Array<double> a = doubles(value, name);
    if (a.dims.size() != 2 || a.dims[1] != width)
        fail(std::string(name) + ": shape " + to_string(a.dims) + ", expected (n, " + std::to_string(width) + ")");
    std::vector<std::vector<double>> out;
    for (int64_t i = 0; i < a.dims[0]; ++i) out.emplace_back(a.data() + i * width, a.data() + (i + 1) * width);
    return out;
}

// What the Python face says of a robot; it has checked it.
Agent make_agent(const World& like, BodyId id, const Drive& drive, nb::handle starts, nb::handle goals,
                 std::pair<double, double> tolerance, double radius, double range, nb::handle position,
                 nb::handle directions) {
    Agent agent;
    agent.id = id;
    const Body& body = like.body(id);
    if (!body.robot) fail("robots: '" + body.name + "' is a body, expected a robot");
    const int32_t nq = body.robot->nq();
    check_fits(*body.robot, drive);
    agent.drive = drive;
    const auto vector = [&](nb::handle value, const char* name, int64_t n) {
        const Array<double> a = doubles(value, name);
        if (a.dims != Dims{n})
            fail(std::string(name) + ": shape " + to_string(a.dims) + ", expected (" + std::to_string(n) + ",)");
        return std::vector<double>(a.data(), a.data() + n);
    };
    agent.starts = rows_of(starts, "starts", nq);
    agent.goals = rows_of(goals, "goals", nq);
    if (agent.starts.empty() || agent.starts.size() != agent.goals.size())
        fail("starts, goals: expected one a case each");
    agent.position_tolerance = tolerance.first;
    agent.angle_tolerance = tolerance.second;
    agent.radius = radius;
    agent.lidar.range = range;
    const std::vector<double> at = vector(position, "position", 3);
    agent.lidar.position = {at[0], at[1], at[2]};
    for (const std::vector<double>& row : rows_of(directions, "directions", 3))
        agent.lidar.directions.push_back({row[0], row[1], row[2]});
    return agent;
}

SimulatorSettings settings_of(const nb::dict& d) {
    SimulatorSettings s;
    const auto get = [&](const char* key, auto& value) { value = nb::cast<std::decay_t<decltype(value)>>(d[key]); };
    get("dt", s.dt);
    get("horizon", s.horizon);
    const std::string response = nb::cast<std::string>(d["response"]);
    s.response = response == "pass" ? Response::pass : response == "terminate" ? Response::terminate : Response::stop;
    get("vanish", s.vanish);
    get("way_points", s.way_points);
    get("way_point_seconds", s.way_point_seconds);
    get("random", s.random);
    get("in_order", s.in_order);
    get("clearance", s.clearance);
    get("near", s.near);
    get("tolerance", s.tolerance);
    get("goal", s.senses.goal);
    get("velocity", s.senses.velocity);
    get("configuration", s.senses.configuration);
    get("path_hint", s.senses.path_hint);
    get("lidar", s.senses.lidar);
    get("neighbors", s.senses.neighbors);
    get("intent", s.senses.intent);
    get("priority", s.senses.priority);
    get("neighbor_range", s.senses.neighbor_range);
    get("look_ahead", s.senses.look_ahead);
    get("progress", s.weights.progress);
    get("arrival", s.weights.arrival);
    get("collision", s.weights.collision);
    get("obstacle", s.weights.obstacle);
    get("time", s.weights.time);
    get("effort", s.weights.effort);
    get("closeness", s.weights.closeness);
    return s;
}

// Worlds by number, or all.
std::vector<int32_t> worlds_of(const Simulator& sim, nb::handle value) {
    std::vector<int32_t> out;
    if (value.is_none()) {
        for (int32_t e = 0; e < sim.n_worlds(); ++e) out.push_back(e);
        return out;
    }
    const Array<int64_t> a = indices(value, "worlds");
    for (size_t k = 0; k < a.view.size(); ++k) {
        const int64_t e = a.data()[k];
        if (e < 0 || e >= sim.n_worlds())
            fail("worlds: " + std::to_string(e) + ", expected 0 to " + std::to_string(sim.n_worlds() - 1));
        if (std::find(out.begin(), out.end(), e) != out.end()) fail("worlds: " + std::to_string(e) + " is there twice");
        out.push_back(static_cast<int32_t>(e));
    }
    return out;
}

void for_worlds(int64_t n, int threads, const std::function<void(int32_t)>& body) {
    parallel_for(
        n, threads,
        [&](int64_t first, int64_t last) {
            for (int64_t k = first; k < last; ++k) body(static_cast<int32_t>(k));
        },
        chunk);
}

Dims per_robot(const Simulator& sim) { return {sim.n_worlds(), sim.n_agents()}; }

nb::object reset(Simulator& sim, nb::handle worlds, nb::handle seeds, nb::handle threads) {
    const std::vector<int32_t> which = worlds_of(sim, worlds);
    std::vector<uint64_t> seed;
    if (!seeds.is_none()) {
        const Array<int64_t> a = indices(seeds, "seeds");
        if (a.dims != Dims{static_cast<int64_t>(which.size())})
            fail("seeds: shape " + to_string(a.dims) + ", expected one a world");
        seed.assign(a.data(), a.data() + which.size());
    }
    for_worlds(static_cast<int64_t>(which.size()), threads_of(threads),
               [&](int32_t k) { sim.reset(which[k], seed.empty() ? nullptr : &seed[k]); });
    return nb::none();
}

nb::object observe(const Simulator& sim, nb::handle worlds, nb::handle threads) {
    const std::vector<int32_t> which = worlds_of(sim, worlds);
    Output<float> out =
        make_output<float>({static_cast<int64_t>(which.size()), sim.n_agents()}, {sim.observation_size()});
    const int64_t stride = int64_t(sim.n_agents()) * sim.observation_size();
    for_worlds(static_cast<int64_t>(which.size()), threads_of(threads),
               [&](int32_t k) { sim.observe(which[k], out.data + k * stride); });
    return nb::cast(out.array);
}

nb::tuple step(Simulator& sim, nb::handle actions, nb::handle threads) {
    const Array<double> a = doubles(actions, "actions");
    const Dims expected{sim.n_worlds(), sim.n_agents(), sim.action_size()};
    if (a.dims != expected)
        fail("actions: shape " + to_string(a.dims) + ", expected " + to_string(expected) +
             ", (worlds, robots, action)");
    for (size_t i = 0; i < a.view.size(); ++i)
        if (!std::isfinite(a.data()[i]))
            fail("actions" + index_text(a.dims, static_cast<int64_t>(i)) + " is " + number(a.data()[i]) +
                 ", expected a number in [-1, 1]");
    Output<float> rows = make_output<float>(per_robot(sim), {sim.observation_size()});
    Output<double> reward = make_output<double>(per_robot(sim));
    Output<bool> there = make_output<bool>(per_robot(sim));
    Output<bool> terminated = make_output<bool>({sim.n_worlds()}), truncated = make_output<bool>({sim.n_worlds()});
    const int32_t n = sim.n_agents();
    for_worlds(sim.n_worlds(), threads_of(threads), [&](int32_t e) {
        sim.step(e, a.data() + int64_t(e) * n * sim.action_size());
        sim.observe(e, rows.data + int64_t(e) * n * sim.observation_size());
        const Episode& episode = sim.episode(e);
        for (int32_t i = 0; i < n; ++i) {
            reward.data[e * n + i] = episode.runners[i].reward;
            there.data[e * n + i] = episode.runners[i].status != Status::moving;
        }
        terminated.data[e] = episode.terminated;
        truncated.data[e] = episode.truncated;
    });
    return nb::make_tuple(rows.array, reward.array, there.array, terminated.array, truncated.array);
}

// One value a robot, from its runner.
template <class T, class F>
nb::object column(const Simulator& sim, F of) {
    Output<T> out = make_output<T>(per_robot(sim));
    for (int32_t e = 0; e < sim.n_worlds(); ++e)
        for (int32_t i = 0; i < sim.n_agents(); ++i)
            out.data[e * sim.n_agents() + i] = static_cast<T>(of(sim.episode(e).runners[i]));
    return nb::cast(out.array);
}

template <class F>
nb::object rows(const Simulator& sim, int64_t width, F of) {
    Output<double> out = make_output<double>(per_robot(sim), {width});
    for (int32_t e = 0; e < sim.n_worlds(); ++e)
        for (int32_t i = 0; i < sim.n_agents(); ++i) {
            const auto& from = of(sim.episode(e).runners[i]);
            std::copy(from.begin(), from.end(), out.data + (int64_t(e) * sim.n_agents() + i) * width);
        }
    return nb::cast(out.array);
}

int64_t most_coordinates(const Simulator& sim) {
    int32_t most = 0;
    for (int32_t i = 0; i < sim.n_agents(); ++i) most = std::max(most, sim.agent(i).robot->nq());
    return most;
}

int64_t most_actions(const Simulator& sim) {
    int32_t most = 0;
    for (int32_t i = 0; i < sim.n_agents(); ++i) most = std::max(most, sim.agent(i).drive.n_actions());
    return most;
}

template <class F>
nb::object per_world(const Simulator& sim, F of) {
    Output<int64_t> out = make_output<int64_t>({sim.n_worlds()});
    for (int32_t e = 0; e < sim.n_worlds(); ++e) out.data[e] = of(sim.episode(e));
    return nb::cast(out.array);
}

struct Chosen {
    int32_t e, i;
};

Chosen chosen(const Simulator& sim, int32_t e, int32_t i) {
    if (e < 0 || e >= sim.n_worlds())
        fail("world: " + std::to_string(e) + ", expected 0 to " + std::to_string(sim.n_worlds() - 1));
    if (i < 0 || i >= sim.n_agents())
        fail("robot: " + std::to_string(i) + ", expected 0 to " + std::to_string(sim.n_agents() - 1));
    return {e, i};
}

std::vector<double> configuration_of(const Simulator& sim, int32_t i, nb::handle value, const char* name) {
    const Configurations c = configurations(*sim.agent(i).robot, value, name);
    if (!c.dims.empty())
        fail(std::string(name) + ": " + to_string(c.dims) + " configurations, expected one, shape (nq,)");
    return {c.row(0), c.row(0) + c.nq};
}

void place(Simulator& sim, int32_t e, int32_t i, nb::handle start, nb::handle goal) {
    const Chosen at = chosen(sim, e, i);
    sim.place(at.e, at.i, configuration_of(sim, i, start, "start"), configuration_of(sim, i, goal, "goal"));
}

void set_path(Simulator& sim, int32_t e, int32_t i, nb::handle path) {
    const Chosen at = chosen(sim, e, i);
    const Configurations c = configurations(*sim.agent(i).robot, path, "path");
    if (c.dims.size() != 1 || c.dims[0] == 0)
        fail("path: " + to_string(c.dims) + " way points, expected (K, nq) with K at least 1");
    Way way;
    for (int64_t k = 0; k < c.dims[0]; ++k) way.emplace_back(c.row(k), c.row(k) + c.nq);
    sim.set_path(at.e, at.i, std::move(way));
}

// Targets (worlds, robots, most coordinates) to actions.
nb::object actions_toward(const Simulator& sim, nb::handle targets) {
    const Array<double> t = doubles(targets, "targets");
    const int64_t nq = most_coordinates(sim), n = sim.n_agents(), width = most_actions(sim);
    const Dims expected{sim.n_worlds(), n, nq};
    if (t.dims != expected) fail("targets: shape " + to_string(t.dims) + ", expected " + to_string(expected));
    for (size_t i = 0; i < t.view.size(); ++i)
        if (!(std::fabs(t.data()[i]) <= 1e5))
            fail("targets" + index_text(t.dims, static_cast<int64_t>(i)) + " is " + number(t.data()[i]));
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
    if (!in.done()) fail("state: damaged, or of another simulator");
}

}  // namespace

void bind_simulator(nb::module_& m) {
    nb::class_<Agent>(m, "Agent")
        .def(
            "__init__",
            [](Agent* self, const World& like, BodyId id, const Drive& drive, nb::handle starts, nb::handle goals,
               std::pair<double, double> tolerance, double radius, double range, nb::handle position,
               nb::handle directions) {
                new (self)
                    Agent(make_agent(like, id, drive, starts, goals, tolerance, radius, range, position, directions));
            },
            "world"_a, "id"_a, "drive"_a, nb::kw_only(), "starts"_a, "goals"_a, "tolerance"_a, "radius"_a, "range"_a,
            "position"_a, "directions"_a);
    nb::class_<Simulator>(m, "Simulator")
        .def(
            "__init__",
            [](Simulator* self, const World& like, const std::vector<Agent>& agents, const nb::dict& settings,
               int32_t worlds, const std::vector<BodyId>& bodies, nb::handle poses_) {
                std::vector<std::vector<Rigid>> cases;
                if (!bodies.empty()) {
                    const Poses p = poses(poses_, "poses");
                    for (size_t k = 0; k < p.size() / bodies.size(); ++k) {
                        cases.emplace_back();
                        for (size_t b = 0; b < bodies.size(); ++b) cases.back().push_back(p[k * bodies.size() + b]);
                    }
                }
                if (agents.empty() || worlds < 1) fail("robots, worlds: expected one at least");
                new (self) Simulator(like, agents, settings_of(settings), worlds, bodies, std::move(cases));
            },
            "world"_a, "agents"_a, "settings"_a, nb::kw_only(), "worlds"_a, "bodies"_a, "poses"_a.none())
        .def("action_sizes",
             [](const Simulator& s) {
                 std::vector<int32_t> out;
                 for (int32_t i = 0; i < s.n_agents(); ++i) out.push_back(s.action_size(i));
                 return out;
             })
        .def(
            "slices",
            [](const Simulator& s, int32_t i) {
                nb::list out;
                for (const Slice& slice : s.slices(chosen(s, 0, i).i))
                    out.append(nb::make_tuple(slice.name, slice.begin, slice.size));
                return out;
            },
            "robot"_a)
        .def("observation_size", [](const Simulator& s) { return s.observation_size(); })
        .def("reset", &reset, "worlds"_a.none(), "seeds"_a.none(), "threads"_a.none())
        .def("observe", &observe, "worlds"_a.none(), "threads"_a.none())
        .def("step", &step, "actions"_a.none(), "threads"_a.none())
        .def("place", &place, "world"_a, "robot"_a, nb::kw_only(), "start"_a.none(), "goal"_a.none())
        .def("set_path", &set_path, "world"_a, "robot"_a, "path"_a.none())
        .def("toward", &actions_toward, "targets"_a.none())
        .def("state", &state_of)
        .def("set_state", &set_state, "state"_a)
        .def("configurations",
             [](const Simulator& s) {
                 return rows(s, most_coordinates(s), [](const Runner& r) -> auto& { return r.q; });
             })
        .def("goals",
             [](const Simulator& s) {
                 return rows(s, most_coordinates(s), [](const Runner& r) -> auto& { return r.goal; });
             })
        .def("velocities",
             [](const Simulator& s) {
                 return rows(s, most_actions(s), [](const Runner& r) -> auto& { return r.action; });
             })
        .def("hit_points",
             [](const Simulator& s) {
                 Output<double> out = make_output<double>(per_robot(s), {3});
                 double* row = out.data;
                 for (int32_t e = 0; e < s.n_worlds(); ++e)
                     for (int32_t i = 0; i < s.n_agents(); ++i) {
                         const Vec3 p = s.hit_point(e, i);
                         for (double x : {p.x, p.y, p.z}) *row++ = x;
                     }
                 return nb::cast(out.array);
             })
        .def("status", [](const Simulator& s) { return column<uint8_t>(s, [](const Runner& r) { return r.status; }); })
        .def("hits", [](const Simulator& s) { return column<int32_t>(s, [](const Runner& r) { return r.hit; }); })
        .def("hit_robots",
             [](const Simulator& s) {
                 return column<int32_t>(s, [&](const Runner& r) { return r.hit < 0 ? -1 : s.robot_of(r.hit); });
             })
        .def("hit_times",
             [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.hit_time; }); })
        .def("checks", [](const Simulator& s) { return column<int64_t>(s, [](const Runner& r) { return r.checks; }); })
        .def("masked", [](const Simulator& s) { return column<int32_t>(s, [](const Runner& r) { return r.masked; }); })
        .def("remaining",
             [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.remaining; }); })
        .def("clearances",
             [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.clearance; }); })
        .def("least_clearances",
             [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.least_clearance; }); })
        .def("collisions",
             [](const Simulator& s) { return column<int64_t>(s, [](const Runner& r) { return r.collisions; }); })
        .def("arrivals",
             [](const Simulator& s) { return column<int64_t>(s, [](const Runner& r) { return r.arrived; }); })
        .def("traveled",
             [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.traveled; }); })
        .def("rewards", [](const Simulator& s) { return column<double>(s, [](const Runner& r) { return r.reward; }); })
        .def("steps", [](const Simulator& s) { return per_world(s, [](const Episode& e) { return e.steps; }); })
        .def("numbers", [](const Simulator& s) { return per_world(s, [](const Episode& e) { return e.number; }); })
        .def("seeds",
             [](const Simulator& s) {
                 return per_world(s, [](const Episode& e) { return static_cast<int64_t>(e.seed); });
             })
        .def("cases", [](const Simulator& s) { return per_world(s, [](const Episode& e) { return e.of_case; }); });
}

}  // namespace fgenv
