// Robots, footprints and settings of a simulator from Python values, which the Python face has checked.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "bind/bind_drive.h"
#include "bind/bind_simulator.h"

namespace fgenv {
namespace {

using namespace nb::literals;

std::vector<std::vector<double>> rows_of(nb::handle value, const char* name, int32_t width) {
    const Array<double> a = doubles(value, name);
    if (a.dims.size() != 2 || a.dims[1] != width)
        fail(std::string(name) + ": got shape " + to_string(a.dims) + ", expected (n, " + std::to_string(width) + ")");
    std::vector<std::vector<double>> out;
    for (int64_t i = 0; i < a.dims[0]; ++i) out.emplace_back(a.data() + i * width, a.data() + (i + 1) * width);
    return out;
}

std::vector<double> vector_of(nb::handle value, const char* name, int64_t n) {
    const Array<double> a = doubles(value, name);
    if (a.dims != Dims{n})
        fail(std::string(name) + ": got shape " + to_string(a.dims) + ", expected (" + std::to_string(n) + ",)");
    return {a.data(), a.data() + n};
}

Lidar lidar_of(double range, nb::handle position, nb::handle directions) {
    const std::vector<double> at = vector_of(position, "position", 3);
    Lidar lidar{range, {at[0], at[1], at[2]}, {}};
    for (const std::vector<double>& row : rows_of(directions, "directions", 3))
        lidar.directions.push_back({row[0], row[1], row[2]});
    return lidar;
}

RobotSpec make_spec(const World& like, BodyId id, const Drive& drive, nb::handle starts, nb::handle goals,
                    std::pair<double, double> tolerance, double radius, double range, nb::handle position,
                    nb::handle directions) {
    const Body& body = like.body(id);
    if (!body.robot) fail("id: got body '" + body.name + "', expected a robot");
    const int32_t nq = body.robot->nq();
    RobotSpec spec;
    spec.id = id;
    check_fits(*body.robot, drive);
    spec.drive = drive;
    spec.starts = rows_of(starts, "starts", nq);
    spec.goals = rows_of(goals, "goals", nq);
    if (spec.starts.empty() || spec.starts.size() != spec.goals.size())
        fail("starts, goals: got " + std::to_string(spec.starts.size()) + " and " + std::to_string(spec.goals.size()) +
             " rows, expected one per case each");
    spec.position_tolerance = tolerance.first;
    spec.angle_tolerance = tolerance.second;
    spec.radius = radius;
    spec.lidar = lidar_of(range, position, directions);
    return spec;
}

Footprint make_footprint(nb::handle disc_centers, double disc_radius, double extra, double width, bool turns,
                         nb::handle workspace, int32_t model) {
    const Array<double> centers = doubles(disc_centers, "disc_centers");
    const std::vector<std::vector<double>> box = rows_of(workspace, "workspace", 2);
    if (centers.view.size() == 0 || box.size() != 2) fail("disc_centers, workspace: expected (n,) and (2, 2)");
    return {{centers.data(), centers.data() + centers.view.size()},
            disc_radius,
            extra,
            width,
            turns,
            {box[0][0], box[0][1]},
            {box[1][0], box[1][1]},
            model};
}

template <class T>
void set(const nb::dict& values, const char* key, T& out) {
    out = nb::cast<T>(values[key]);
}

void set_observation(const nb::dict& values, ObservationSettings& s) {
    set(values, "goal", s.goal);
    set(values, "velocity", s.velocity);
    set(values, "configuration", s.configuration);
    set(values, "path_hint", s.path_hint);
    set(values, "lidar", s.lidar);
    set(values, "neighbors", s.neighbors);
    set(values, "intent", s.intent);
    set(values, "priority", s.priority);
    set(values, "neighbor_range", s.neighbor_range);
    set(values, "look_ahead", s.look_ahead);
}

void set_reward(const nb::dict& values, RewardWeights& w) {
    set(values, "progress", w.progress);
    set(values, "arrival", w.arrival);
    set(values, "collision", w.collision);
    set(values, "obstacle", w.obstacle);
    set(values, "time", w.time);
    set(values, "effort", w.effort);
    set(values, "closeness", w.closeness);
}

}  // namespace

SimulatorSettings simulator_settings(const nb::dict& values) {
    SimulatorSettings s;
    const std::string response = nb::cast<std::string>(values["response"]);
    s.response = response == "pass"        ? CollisionResponse::pass
                 : response == "terminate" ? CollisionResponse::terminate
                                           : CollisionResponse::stop;
    set(values, "dt", s.dt);
    set(values, "horizon", s.horizon);
    set(values, "vanish", s.vanish);
    set(values, "waypoint_actions", s.waypoint_actions);
    set(values, "waypoint_seconds", s.waypoint_seconds);
    set(values, "random_starts", s.random_starts);
    set(values, "case_by_seed", s.case_by_seed);
    set(values, "measure_clearance", s.measure_clearance);
    set(values, "closeness_range", s.closeness_range);
    set(values, "tolerance", s.tolerance);
    set_observation(values, s.observation);
    set_reward(values, s.reward);
    return s;
}

void bind_simulator_specs(nb::module_& m) {
    nb::class_<RobotSpec>(m, "RobotSpec")
        .def(
            "__init__",
            [](RobotSpec* self, const World& like, BodyId id, const Drive& drive, nb::handle starts, nb::handle goals,
               std::pair<double, double> tolerance, double radius, double range, nb::handle position,
               nb::handle directions) {
                new (self) RobotSpec(
                    make_spec(like, id, drive, starts, goals, tolerance, radius, range, position, directions));
            },
            "world"_a, "id"_a, "drive"_a, nb::kw_only(), "starts"_a, "goals"_a, "tolerance"_a, "radius"_a, "range"_a,
            "position"_a, "directions"_a);
    nb::class_<Footprint>(m, "Footprint")
        .def(
            "__init__",
            [](Footprint* self, nb::handle disc_centers, double disc_radius, double extra, double width, bool turns,
               nb::handle workspace, int32_t model) {
                new (self) Footprint(make_footprint(disc_centers, disc_radius, extra, width, turns, workspace, model));
            },
            nb::kw_only(), "disc_centers"_a, "disc_radius"_a, "extra"_a, "width"_a, "turns"_a, "workspace"_a,
            "model"_a);
}

}  // namespace fgenv
