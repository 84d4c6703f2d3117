#include "robot/drive.h"

#include <algorithm>

#include "math/constants.h"

namespace fgenv {
namespace {

// Displacement of a frame that moves at (vx, vy) in its own axes while it turns by `turn`, in the frame at the
// beginning: the chord of the arc, at half the turn.
void arc_chord(double vx, double vy, double turn, double dt, double& x, double& y) {
    double s, c;
    sin_cos(0.5 * turn, s, c);
    const double half = 0.5 * turn, chord = std::fabs(half) < 1e-4 ? 1 - half * half / 6 : s / half;
    x = dt * chord * (c * vx - s * vy);
    y = dt * chord * (s * vx + c * vy);
}

// x, y, yaw.
void move_planar(const Twist& u, const double* q, double dt, double* out) {
    double x, y, s, c;
    arc_chord(u.vx, u.vy, u.turn_rate * dt, dt, x, y);
    sin_cos(q[2], s, c);
    out[0] = q[0] + c * x - s * y;
    out[1] = q[1] + s * x + c * y;
    out[2] = between(Coordinate::angle, q[2], q[2] + u.turn_rate * dt, 1);
}

// x, y, z and a quaternion; turns about the z axis of the body.
void move_free(const Twist& u, const double* q, double dt, double* out) {
    double x, y, s, c;
    arc_chord(u.vx, u.vy, u.turn_rate * dt, dt, x, y);
    double r[3][3];
    to_matrix({q[3], q[4], q[5], q[6]}, r);
    for (int i = 0; i < 3; ++i) out[i] = q[i] + r[i][0] * x + r[i][1] * y + r[i][2] * (u.vz * dt);
    sin_cos(0.5 * u.turn_rate * dt, s, c);
    const Quaternion turned =
        normalized({q[3] * c + q[4] * s, q[4] * c - q[3] * s, q[5] * c + q[6] * s, q[6] * c - q[5] * s});
    out[3] = turned.x, out[4] = turned.y, out[5] = turned.z, out[6] = turned.w;
}

void clip_linear(const Robot& robot, const Drive& drive, double* q) {
    for (int32_t i = 0; i < robot.nq(); ++i)
        if (robot.coordinates[i] == Coordinate::linear) q[i] = clamped(q[i], drive.lower[i], drive.upper[i]);
}

double middle(const ActionLimit& limit) { return 0.5 * (limit.low + limit.high); }
double half_width(const ActionLimit& limit) { return 0.5 * (limit.high - limit.low); }

// The base's target of a waypoint command: straight there, then turned, with a twist for one second each.
void base_waypoint(const Robot& robot, const Drive& drive, const double* q, const double* command, double seconds,
                   double* out) {
    const bool planar = robot.joints[0].kind == JointKind::planar;
    const double reach = drive.limits[0].high * seconds, climb = planar ? 0 : drive.limits[2].high * seconds;
    const double x = reach * clamped(command[0], -1, 1), y = reach * clamped(command[1], -1, 1);
    const double turn = pi * clamped(command[planar ? 2 : 3], -1, 1);
    if (planar) {
        move_planar({x, y, 0, 0}, q, 1, out);
        out[2] = between(Coordinate::angle, q[2], q[2] + turn, 1);
    } else {
        double moved[7];
        move_free({x, y, climb * clamped(command[2], -1, 1), 0}, q, 1, moved);
        move_free({0, 0, 0, turn}, moved, 1, out);
    }
}

}  // namespace

void limit_action(const Drive& drive, const double* command, const double* before, double dt, double* action) {
    const int32_t n = drive.n_base_actions();
    const auto desired = [&](int32_t i) {
        return middle(drive.limits[i]) + half_width(drive.limits[i]) * clamped(command[i], -1, 1);
    };
    if (n) {
        double base[max_base_actions];
        for (int32_t i = 0; i < n; ++i) base[i] = desired(i);
        drive.kernel->limit(drive, base, before, dt, action);
    }
    for (int32_t i = n; i < drive.n_actions(); ++i) {
        const double joint = desired(i);
        limit_each(&drive.limits[i], 1, &joint, &before[i], dt, &action[i]);
    }
}

void drive_forward(const Robot& robot, const Drive& drive, const double* action, const double* q, double dt,
                   double* out) {
    const JointKind base = robot.joints[0].kind;
    const int32_t first = size(base), n = drive.n_base_actions();
    std::copy(q, q + first, out);
    if (drive.kernel) {
        const Twist u = drive.kernel->twist(drive, action);
        base == JointKind::planar ? move_planar(u, q, dt, out) : move_free(u, q, dt, out);
    }
    const bool joints = drive.n_actions() > n;
    for (int32_t i = first; i < robot.nq(); ++i) {
        const double moved = joints ? q[i] + dt * action[n + i - first] : q[i];
        out[i] = robot.coordinates[i] == Coordinate::angle ? between(Coordinate::angle, q[i], moved, 1) : moved;
    }
    clip_linear(robot, drive, out);
}

Offset base_offset(const Robot& robot, const double* q, const double* target) {
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

Vec3 base_velocity(const Drive& drive, const double* action) {
    if (!drive.kernel) return {0, 0, 0};
    const Twist u = drive.kernel->twist(drive, action);
    return {u.vx, u.vy, u.vz};
}

void approach_command(const Robot& robot, const Drive& drive, const double* q, const double* target, double dt,
                      double* command) {
    const int32_t n = drive.n_base_actions(), first = size(robot.joints[0].kind);
    if (n) drive.kernel->approach(drive, base_offset(robot, q, target), dt, command);
    for (int32_t i = n; i < drive.n_actions(); ++i) {
        const int32_t k = first + i - n;
        command[i] = stopping_speed(change(robot.coordinates[k], q[k], target[k]), drive.limits[i].rate, dt);
    }
    for (int32_t i = 0; i < drive.n_actions(); ++i)
        command[i] = clamped((command[i] - middle(drive.limits[i])) / half_width(drive.limits[i]), -1, 1);
}

int32_t waypoint_size(const Robot& robot, const Drive& drive) {
    const int32_t joints = drive.n_actions() - drive.n_base_actions();
    if (!drive.kernel) return joints;
    return joints + (robot.joints[0].kind == JointKind::planar ? 3 : 4);
}

void waypoint_target(const Robot& robot, const Drive& drive, const double* q, const double* command, double seconds,
                     double* out) {
    const int32_t n = drive.n_base_actions(), first = size(robot.joints[0].kind);
    std::copy(q, q + robot.nq(), out);
    if (n) {
        base_waypoint(robot, drive, q, command, seconds, out);
        command += waypoint_size(robot, drive) - (drive.n_actions() - n);
    }
    for (int32_t i = n; i < drive.n_actions(); ++i) {
        const int32_t k = first + i - n;
        const double moved = q[k] + drive.limits[i].high * seconds * clamped(command[i - n], -1, 1);
        out[k] = between(robot.coordinates[k], q[k], moved, 1);
    }
    clip_linear(robot, drive, out);
}

}  // namespace fgenv
