// Interface of drive kernels: one file per kind of drive, which registers its kernel by name.
#pragma once

#include <string>
#include <vector>

#include "math/geometry.h"

namespace fgenv {

struct DriveKernel;

// Limits of one component of an action.
struct ActionLimit {
    double low, high;
    double rate;  // of its change per second, in both directions; may be infinite
};

// A drive of the base, then joints with one velocity each.
struct Drive {
    const DriveKernel* kernel = nullptr;  // null: the base does not move
    std::vector<double> parameters;       // of the kernel
    std::vector<ActionLimit> limits;      // the base's components, then the joints'
    std::vector<double> lower, upper;     // limits of configurations, (nq)

    int32_t n_actions() const { return static_cast<int32_t>(limits.size()); }
    int32_t n_base_actions() const;
};

// Velocity of the base in its own frame; the turn is about its z axis.
struct Twist {
    double vx, vy, vz, turn_rate;
};

// A target as seen from the base: its position, and the turn to its heading.
struct Offset {
    double by[3], turn;
};

constexpr int32_t max_base_actions = 8;

struct DriveKernel {
    const char* name;   // `native_kind` of the Python class
    int32_t n_actions;  // at most max_base_actions
    int32_t n_parameters;

    // Twist of the base for an action, in its own units.
    Twist (*twist)(const Drive&, const double* action);
    // Action, in its own units and not clipped, that approaches a target and stops there.
    void (*approach)(const Drive&, const Offset&, double dt, double* action);
    // The action in force: `desired` brought within the limits, given the action of the step before.
    void (*limit)(const Drive&, const double* desired, const double* before, double dt, double* action);
};

// Null: no kernel has the name.
const DriveKernel* find_drive_kernel(const std::string& name);
// Names of all kernels, separated by commas.
std::string drive_kernel_names();

// A static object of this type in a kernel's file adds the kernel.
struct RegisterDrive {
    explicit RegisterDrive(const DriveKernel& registered);

    DriveKernel kernel;
    const RegisterDrive* next;
};

// Shared by the kernels.

constexpr double arrival_distance = 0.02;  // meters: at this distance a base only turns

double clamped(double x, double low, double high);

// Clips the first n components one by one.
void limit_each(const ActionLimit* limits, int32_t n, const double* desired, const double* before, double dt,
                double* action);
void limit_base(const Drive& drive, const double* desired, const double* before, double dt, double* action);

// Highest speed that still stops after a signed distance when it falls by `rate` at each step of dt seconds.
double stopping_speed(double distance, double rate, double dt);
// The same along 2 or 3 axes at once, in a straight line.
void stopping_velocity(const ActionLimit* limits, const double* by, int n, double dt, double* v);

}  // namespace fgenv
