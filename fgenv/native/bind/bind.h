#pragma once

#include <nanobind/nanobind.h>

namespace fgenv {

void bind_shape(nanobind::module_& m);
void bind_queries(nanobind::module_& m);
void bind_world(nanobind::module_& m);
void bind_robot(nanobind::module_& m);
void bind_drive(nanobind::module_& m);
void bind_simulator(nanobind::module_& m);
void bind_checker(nanobind::module_& m);
void bind_picture(nanobind::module_& m);
void bind_network(nanobind::module_& m);
void bind_orca(nanobind::module_& m);
void bind_grid(nanobind::module_& m);

}  // namespace fgenv
