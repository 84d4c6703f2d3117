#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

const RegisterDrive*& first() {
    static const RegisterDrive* registered = nullptr;
    return registered;
}

}  // namespace

RegisterDrive::RegisterDrive(const DriveKernel& registered) : kernel(registered), next(first()) { first() = this; }

const DriveKernel* find_drive_kernel(const std::string& name) {
    for (const RegisterDrive* r = first(); r; r = r->next)
        if (name == r->kernel.name) return &r->kernel;
    return nullptr;
}

std::string drive_kernel_names() {
    std::string names;
    for (const RegisterDrive* r = first(); r; r = r->next)
        names += (names.empty() ? "" : ", ") + std::string(r->kernel.name);
    return names;
}

int32_t Drive::n_base_actions() const { return kernel ? kernel->n_actions : 0; }

double clamped(double x, double low, double high) { return lesser(greater(x, low), high); }

void limit_each(const ActionLimit* limits, int32_t n, const double* desired, const double* before, double dt,
                double* action) {
    for (int32_t i = 0; i < n; ++i) {
        const double change = limits[i].rate * dt;
        action[i] = clamped(desired[i], before[i] - change, before[i] + change);
    }
}

void limit_base(const Drive& drive, const double* desired, const double* before, double dt, double* action) {
    limit_each(drive.limits.data(), drive.kernel->n_actions, desired, before, dt, action);
}

double stopping_speed(double distance, double rate, double dt) {
    const double d = std::fabs(distance), a = rate * dt;
    double v = d / dt;
    if (a < v) v = lesser(v, 0.5 * a * (std::sqrt(1 + 8 * d / (a * dt)) - 1));
    return distance < 0 ? -v : v;
}

void stopping_velocity(const ActionLimit* limits, const double* by, int n, double dt, double* v) {
    double squared = 0, excess = 1;
    for (int i = 0; i < n; ++i) squared += by[i] * by[i];
    const double d = std::sqrt(squared), speed = stopping_speed(d, limits[0].rate, dt);
    for (int i = 0; i < n; ++i) {
        v[i] = d > 0 ? by[i] / d * speed : 0;
        excess = greater(excess, std::fabs(v[i]) / limits[i].high);
    }
    for (int i = 0; i < n; ++i) v[i] /= excess;
}

}  // namespace fgenv
