#include "bind/bind.h"
#include "query/kernels.h"

NB_MODULE(_core, m) {
    m.doc() = "fgenv's native core. Use fgenv.collision, which documents its functions.";
    // Shapes in global variables at the end of a script are not leaks.
    nanobind::set_leak_warnings(false);
    fgenv::kernels();  // reports an invalid FGENV_ISA at import
    m.def("isa", &fgenv::kernels_name, "Name of the instruction set whose kernels are in use.");
    fgenv::bind_shape(m);
    fgenv::bind_queries(m);
    fgenv::bind_world(m);
    fgenv::bind_robot(m);
    fgenv::bind_drive(m);
    fgenv::bind_simulator(m);
    fgenv::bind_checker(m);
    fgenv::bind_picture(m);
    fgenv::bind_network(m);
    fgenv::bind_grid(m);
    fgenv::bind_orca(m);
}
