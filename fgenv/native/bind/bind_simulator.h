// Parts of the Python class of the batched simulator.
#pragma once

#include "bind/bind_world.h"
#include "simulator/simulator.h"

namespace fgenv {

void bind_simulator_specs(nb::module_& m);
void bind_simulator_state(nb::class_<Simulator>& c);
SimulatorSettings simulator_settings(const nb::dict& values);

int64_t most_coordinates(const Simulator& sim);
int64_t most_actions(const Simulator& sim);
void check_robot(const Simulator& sim, int32_t world, int32_t robot);

inline Dims per_robot(const Simulator& sim) { return {sim.n_worlds(), sim.n_robots()}; }

}  // namespace fgenv
