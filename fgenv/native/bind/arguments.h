// Checks of arguments that several bindings share.
#pragma once

#include "bind/arrays.h"

namespace fgenv {

// "name: got VALUE, expected EXPECTED"
static inline std::string received(const char* name, nb::handle value, const char* expected) {
    std::string text = nb::repr(value).c_str();
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    return std::string(name) + ": got " + text + ", expected " + expected;
}

static inline int threads_of(nb::handle value) {
    if (value.is_none()) return 0;
    int n = 0;
    if (!nb::try_cast(value, n) || n < 1 || n > 4096)
        throw nb::value_error(received("threads", value, "an integer from 1 to 4096, or None for all cores").c_str());
    return n;
}

// Raises TypeError unless the value is a number.
static inline double real_of(nb::handle value, const char* name) {
    double out = 0;
    if (PyBool_Check(value.ptr()) || !nb::try_cast(value, out))
        throw nb::type_error(received(name, value, "a number").c_str());
    return out;
}

// Raises TypeError unless the value is True or False.
static inline bool flag_of(nb::handle value, const char* name) {
    bool out = false;
    if (!nb::try_cast(value, out)) throw nb::type_error(received(name, value, "True or False").c_str());
    return out;
}

// Raises ValueError unless the value is at least 0; infinity is an error unless it means no limit.
static inline double meters_of(nb::handle value, const char* name, bool unlimited = false) {
    const double meters = real_of(value, name);
    if (!(meters >= 0) || (std::isinf(meters) && !unlimited))
        throw nb::value_error(received(name, value, "at least 0 meters").c_str());
    return meters;
}

// Unit vector of three numbers that are not all 0. Scaled first: squares of very small or large numbers
// would underflow or overflow.
static inline Vec3 direction_of(const double* v) {
    const double most = greater(greater(std::fabs(v[0]), std::fabs(v[1])), std::fabs(v[2]));
    return unit({v[0] / most, v[1] / most, v[2] / most});
}

// A direction of a ray: scaled by a power of two, hence without rounding; and its length.
struct RayDirection {
    Vec3 d;
    double length;
};
static inline RayDirection ray_direction_of(const double* v) {
    const double most = greater(greater(std::fabs(v[0]), std::fabs(v[1])), std::fabs(v[2]));
    const int exponent = -std::ilogb(most);
    const Vec3 d{std::ldexp(v[0], exponent), std::ldexp(v[1], exponent), std::ldexp(v[2], exponent)};
    return {d, norm(d)};
}

// A bound of ray parameters for hits within `max_distance` meters, rounded up: a hit at just this
// distance would be lost by the rounding of the division. Its distance in meters decides.
static inline double reach_of(double max_distance, double length) { return max_distance / length * (1 + 0x1p-50); }

static inline Dims rows_of(const Array<double>& points) { return {points.dims.begin(), points.dims.end() - 1}; }

static inline Array<double> directions_of(nb::handle value, const char* name) {
    Array<double> d = points(value, name);
    for (size_t i = 0; i < d.view.size(); i += 3)
        if (d.data()[i] == 0 && d.data()[i + 1] == 0 && d.data()[i + 2] == 0)
            throw nb::value_error(
                (std::string(name) + "[" + std::to_string(i / 3) + "]: got length 0, expected a direction").c_str());
    return d;
}

}  // namespace fgenv
