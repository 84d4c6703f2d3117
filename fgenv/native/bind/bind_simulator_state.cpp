// Arrays of a simulator's state: (worlds, robots, ...) or (worlds,), copies.
#include "bind/bind_simulator.h"

namespace fgenv {
namespace {

using namespace nb::literals;

// One value per robot.
template <class T, class F>
nb::object column(const Simulator& sim, F of) {
    Output<T> out = make_output<T>(per_robot(sim));
    T* value = out.data;
    for (int32_t e = 0; e < sim.n_worlds(); ++e)
        for (const RobotState& robot : sim.episode(e).robots) *value++ = static_cast<T>(of(robot));
    return nb::cast(out.array);
}

template <class T, class M>
void add_column(nb::class_<Simulator>& c, const char* name, M RobotState::* member) {
    c.def(name, [member](const Simulator& s) { return column<T>(s, [&](const RobotState& r) { return r.*member; }); });
}

// A vector per robot, zeros at the end of shorter ones.
template <class F>
void add_rows(nb::class_<Simulator>& c, const char* name, std::vector<double> RobotState::* member, F width_of) {
    c.def(name, [=](const Simulator& sim) {
        const int64_t width = width_of(sim);
        Output<double> out = make_output<double>(per_robot(sim), {width});
        double* row = out.data;
        for (int32_t e = 0; e < sim.n_worlds(); ++e)
            for (const RobotState& robot : sim.episode(e).robots) {
                const std::vector<double>& from = robot.*member;
                std::copy(from.begin(), from.end(), row);
                row += width;
            }
        return nb::cast(out.array);
    });
}

template <class M>
void add_per_world(nb::class_<Simulator>& c, const char* name, M Episode::* member) {
    c.def(name, [member](const Simulator& sim) {
        Output<int64_t> out = make_output<int64_t>({sim.n_worlds()});
        for (int32_t e = 0; e < sim.n_worlds(); ++e) out.data[e] = static_cast<int64_t>(sim.episode(e).*member);
        return nb::cast(out.array);
    });
}

nb::object hit_points(const Simulator& sim) {
    Output<double> out = make_output<double>(per_robot(sim), {3});
    double* row = out.data;
    for (int32_t e = 0; e < sim.n_worlds(); ++e)
        for (int32_t i = 0; i < sim.n_robots(); ++i) {
            const Vec3 p = sim.hit_point(e, i);
            for (double x : {p.x, p.y, p.z}) *row++ = x;
        }
    return nb::cast(out.array);
}

nb::object path(const Simulator& sim, int32_t e, int32_t i) {
    check_robot(sim, e, i);
    const Waypoints& waypoints = sim.episode(e).robots[i].path;
    Output<double> out = make_output<double>({static_cast<int64_t>(waypoints.size())}, {sim.spec(i).robot->nq()});
    double* row = out.data;
    for (const std::vector<double>& q : waypoints) row = std::copy(q.begin(), q.end(), row);
    return nb::cast(out.array);
}

}  // namespace

int64_t most_coordinates(const Simulator& sim) {
    int32_t most = 0;
    for (int32_t i = 0; i < sim.n_robots(); ++i) most = std::max(most, sim.spec(i).robot->nq());
    return most;
}

int64_t most_actions(const Simulator& sim) {
    int32_t most = 0;
    for (int32_t i = 0; i < sim.n_robots(); ++i) most = std::max(most, sim.spec(i).drive.n_actions());
    return most;
}

void bind_simulator_state(nb::class_<Simulator>& c) {
    add_rows(c, "configurations", &RobotState::q, most_coordinates);
    add_rows(c, "goals", &RobotState::goal, most_coordinates);
    add_rows(c, "velocities", &RobotState::action, most_actions);
    add_column<uint8_t>(c, "status", &RobotState::status);
    add_column<int32_t>(c, "hits", &RobotState::hit);
    add_column<double>(c, "hit_times", &RobotState::hit_time);
    add_column<int64_t>(c, "checks", &RobotState::checks);
    add_column<int32_t>(c, "masked", &RobotState::masked);
    add_column<double>(c, "remaining", &RobotState::remaining);
    add_column<double>(c, "clearances", &RobotState::clearance);
    add_column<double>(c, "least_clearances", &RobotState::least_clearance);
    add_column<int64_t>(c, "collisions", &RobotState::collisions);
    add_column<int64_t>(c, "arrivals", &RobotState::arrived);
    add_column<double>(c, "traveled", &RobotState::traveled);
    add_per_world(c, "steps", &Episode::steps);
    add_per_world(c, "numbers", &Episode::number);
    add_per_world(c, "seeds", &Episode::seed);
    add_per_world(c, "cases", &Episode::case_number);
    c.def("hit_robots",
          [](const Simulator& s) {
              return column<int32_t>(s, [&](const RobotState& r) { return r.hit < 0 ? -1 : s.robot_of(r.hit); });
          })
        .def("hit_points", &hit_points)
        .def("path", &path, "world"_a, "robot"_a);
}

}  // namespace fgenv
