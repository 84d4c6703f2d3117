#include "robot/drive.h"

#include <algorithm>

namespace fgenv {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double there = 0.02;      // meters: so near to its position a base only turns
constexpr double off_course = 0.6;  // radians: farther off, a differential drive turns on the spot

double clamped(double x, double low, double high) { return lesser(greater(x, low), high); }

// Where a frame gets that goes at (vx, vy) in its own axes and turns by `turn` meanwhile, seen from where it
// began: the chord of the arc, half the turn away from its beginning.
void along_arc(double vx, double vy, double turn, double dt, double& x, double& y) {
    double s, c;
    sin_cos(0.5 * turn, s, c);
    const double half = 0.5 * turn, chord = std::fabs(half) < 1e-4 ? 1 - half * half / 6 : s / half;
    x = dt * chord * (c * vx - s * vy);
    y = dt * chord * (s * vx + c * vy);
}

struct Twist {
    double vx, vy, vz, turn_rate;  // in the body's frame
};

Twist twist_of(const Drive& drive, const double* a) {
    switch (drive.base) {
        case DriveKind::none: return {0, 0, 0, 0};
        case DriveKind::holonomic: return {a[0], a[1], 0, a[2]};
        case DriveKind::differential: return {a[0], 0, 0, a[1]};
        case DriveKind::drone: return {a[0], a[1], a[2], a[3]};
        case DriveKind::car: {
            double s, c;
            sin_cos(a[1], s, c);
            return {a[0], 0, 0, a[0] * s / (c * drive.wheelbase)};
        }
    }
    return {0, 0, 0, 0};
}

// x, y, yaw.
void drive_planar(const Twist& u, const double* q, double dt, double* out) {
    double x, y, s, c;
    along_arc(u.vx, u.vy, u.turn_rate * dt, dt, x, y);
    sin_cos(q[2], s, c);
    out[0] = q[0] + c * x - s * y;
    out[1] = q[1] + s * x + c * y;
    out[2] = between(Coordinate::angle, q[2], q[2] + u.turn_rate * dt, 1);
}

// x, y, z and a quaternion; turns about the body's own vertical.
void drive_free(const Twist& u, const double* q, double dt, double* out) {
    double x, y, s, c;
    along_arc(u.vx, u.vy, u.turn_rate * dt, dt, x, y);
    double r[3][3];
    to_matrix({q[3], q[4], q[5], q[6]}, r);
    for (int i = 0; i < 3; ++i) out[i] = q[i] + r[i][0] * x + r[i][1] * y + r[i][2] * (u.vz * dt);
    sin_cos(0.5 * u.turn_rate * dt, s, c);
    const Quaternion turned =
        normalized({q[3] * c + q[4] * s, q[4] * c - q[3] * s, q[5] * c + q[6] * s, q[6] * c - q[5] * s});
    out[3] = turned.x, out[4] = turned.y, out[5] = turned.z, out[6] = turned.w;
}

// The fastest that still stops after `distance` (either way) when slowed by `rate` at each step of dt.
double approach(double distance, double rate, double dt) {
    const double d = std::fabs(distance), a = rate * dt;
    double v = d / dt;
    if (a < v) v = lesser(v, 0.5 * a * (std::sqrt(1 + 8 * d / (a * dt)) - 1));
    return distance < 0 ? -v : v;
}

// The same along two axes or three at once, straight.
void approach_straight(const ActionLimit* limits, const double* by, int n, double dt, double* v) {
    double squared = 0, most = 1;
    for (int i = 0; i < n; ++i) squared += by[i] * by[i];
    const double d = std::sqrt(squared), speed = approach(d, limits[0].rate, dt);
    for (int i = 0; i < n; ++i) {
        v[i] = d > 0 ? by[i] / d * speed : 0;
        most = greater(most, std::fabs(v[i]) / limits[i].high);
    }
    for (int i = 0; i < n; ++i) v[i] /= most;
}

// Pure pursuit (R. Coulter, 1992) of a point before the target, on the line that the car is to end on: it
// closes in as the car does.
void toward_by_car(const Drive& drive, const Offset& o, double dt, double* v) {
    const double d = std::sqrt(o.by[0] * o.by[0] + o.by[1] * o.by[1]);
    double s, c;
    sin_cos(o.turn, s, c);
    const double x = o.by[0] - 0.5 * d * c, y = o.by[1] - 0.5 * d * s, squared = x * x + y * y;
    v[0] = d > there ? approach(d, drive.limits[0].rate, dt) : 0;
    v[1] = squared > 0 ? arc_tangent(2 * y * drive.wheelbase / squared, 1) : 0;
    if (x < 0) v[1] = y < 0 ? drive.limits[1].low : drive.limits[1].high;  // behind: around
}

void toward_by_wheels(const Drive& drive, const Offset& o, double dt, double* v) {
    const double d = std::sqrt(o.by[0] * o.by[0] + o.by[1] * o.by[1]);
    const double course = d > there ? arc_tangent(o.by[1], o.by[0]) : o.turn;
    v[0] = d > there && std::fabs(course) < off_course ? approach(o.by[0], drive.limits[0].rate, dt) : 0;
    v[1] = approach(course, drive.limits[1].rate, dt);
}

}  // namespace

void limited(const Drive& drive, const double* asked, const double* before, double dt, double* action) {
    for (int32_t i = 0; i < drive.n_actions(); ++i) {
        const ActionLimit& limit = drive.limits[i];
        const double middle = 0.5 * (limit.low + limit.high), half = 0.5 * (limit.high - limit.low);
        const double expected = middle + half * clamped(asked[i], -1, 1);
        action[i] = clamped(expected, before[i] - limit.rate * dt, before[i] + limit.rate * dt);
    }
}

void drive_on(const Robot& robot, const Drive& drive, const double* action, const double* q, double dt, double* out) {
    const JointKind base = robot.joints[0].kind;
    const int32_t n = size(base), nq = robot.nq();
    const Twist u = twist_of(drive, action);
    std::copy(q, q + n, out);
    if (drive.base != DriveKind::none)
        base == JointKind::planar ? drive_planar(u, q, dt, out) : drive_free(u, q, dt, out);
    const bool joints = drive.n_actions() > base_actions(drive.base);
    for (int32_t i = n; i < nq; ++i) {
        const double moved = joints ? q[i] + dt * action[base_actions(drive.base) + i - n] : q[i];
        out[i] = robot.coordinates[i] == Coordinate::angle ? between(Coordinate::angle, q[i], moved, 1) : moved;
    }
    for (int32_t i = 0; i < nq; ++i)
        if (robot.coordinates[i] == Coordinate::linear) out[i] = clamped(out[i], drive.lower[i], drive.upper[i]);
}

Offset offset_to(const Robot& robot, const double* q, const double* target) {
    const double d[3] = {target[0] - q[0], target[1] - q[1], target[2] - q[2]};
    if (robot.joints[0].kind == JointKind::planar) {
        double s, c;
        sin_cos(q[2], s, c);
        return {{c * d[0] + s * d[1], c * d[1] - s * d[0], 0}, change(Coordinate::angle, q[2], target[2])};
    }
    double r[3][3];
    to_matrix({q[3], q[4], q[5], q[6]}, r);
    Offset out;
    for (int i = 0; i < 3; ++i) out.by[i] = r[0][i] * d[0] + r[1][i] * d[1] + r[2][i] * d[2];
    const Quaternion turn =
        relative(Quaternion{q[3], q[4], q[5], q[6]}, Quaternion{target[3], target[4], target[5], target[6]});
    out.turn = change(Coordinate::angle, 0, 2 * arc_tangent(turn.z, turn.w));
    return out;
}

Vec3 velocity_of(const Drive& drive, const double* action) {
    const Twist u = twist_of(drive, action);
    return {u.vx, u.vy, u.vz};
}

void toward(const Robot& robot, const Drive& drive, const double* q, const double* target, double dt, double* asked) {
    const int32_t n = base_actions(drive.base), base = size(robot.joints[0].kind);
    const ActionLimit* limits = drive.limits.data();
    if (n) {
        const Offset o = offset_to(robot, q, target);
        switch (drive.base) {
            case DriveKind::none: break;
            case DriveKind::car: toward_by_car(drive, o, dt, asked); break;
            case DriveKind::differential: toward_by_wheels(drive, o, dt, asked); break;
            case DriveKind::holonomic:
            case DriveKind::drone:
                approach_straight(limits, o.by, n - 1, dt, asked);
                asked[n - 1] = approach(o.turn, limits[n - 1].rate, dt);
        }
    }
    for (int32_t i = n; i < drive.n_actions(); ++i) {
        const int32_t k = base + i - n;
        asked[i] = approach(change(robot.coordinates[k], q[k], target[k]), limits[i].rate, dt);
    }
    for (int32_t i = 0; i < drive.n_actions(); ++i) {
        const double middle = 0.5 * (limits[i].low + limits[i].high), half = 0.5 * (limits[i].high - limits[i].low);
        asked[i] = clamped((asked[i] - middle) / half, -1, 1);
    }
}

int32_t way_point_size(const Robot& robot, const Drive& drive) {
    const int32_t joints = drive.n_actions() - base_actions(drive.base);
    if (drive.base == DriveKind::none) return joints;
    return joints + (robot.joints[0].kind == JointKind::planar ? 3 : 4);
}

void way_point(const Robot& robot, const Drive& drive, const double* q, const double* asked, double seconds,
               double* out) {
    const JointKind kind = robot.joints[0].kind;
    const int32_t base = size(kind), n = base_actions(drive.base);
    std::copy(q, q + robot.nq(), out);
    if (n) {
        const bool planar = kind == JointKind::planar;
        const double reach = drive.limits[0].high * seconds, climb = planar ? 0 : drive.limits[2].high * seconds;
        const double x = reach * clamped(asked[0], -1, 1), y = reach * clamped(asked[1], -1, 1);
        const double turn = pi * clamped(asked[planar ? 2 : 3], -1, 1);
        // Straight there, then turned: a twist for one second each.
        if (planar) {
            drive_planar({x, y, 0, 0}, q, 1, out);
            out[2] = between(Coordinate::angle, q[2], q[2] + turn, 1);
        } else {
            double moved[7];
            drive_free({x, y, climb * clamped(asked[2], -1, 1), 0}, q, 1, moved);
            drive_free({0, 0, 0, turn}, moved, 1, out);
        }
        asked += planar ? 3 : 4;
    }
    for (int32_t i = n; i < drive.n_actions(); ++i) {
        const int32_t k = base + i - n;
        out[k] = between(robot.coordinates[k], q[k],
                         q[k] + drive.limits[i].high * seconds * clamped(asked[i - n], -1, 1), 1);
    }
    for (int32_t i = 0; i < robot.nq(); ++i)
        if (robot.coordinates[i] == Coordinate::linear) out[i] = clamped(out[i], drive.lower[i], drive.upper[i]);
}

}  // namespace fgenv
