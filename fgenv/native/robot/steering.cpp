#include "robot/steering.h"

#include <algorithm>

#include "math/constants.h"
#include "robot/car_path.h"

namespace fgenv {
namespace {

constexpr double min_distance = 1e-9;  // meters: at less, the motion is a turn in place
constexpr double max_chord = 0.1;      // radians

struct PlanarPose {
    double x, y, yaw;
};

void add_row(const Robot& robot, const double* q0, const double* q1, double t, const PlanarPose& at,
             std::vector<double>& rows) {
    const size_t begin = rows.size();
    rows.resize(begin + robot.nq());
    double* row = rows.data() + begin;
    interpolate(robot, q0, q1, t, row);
    row[0] = at.x;
    row[1] = at.y;
    row[2] = between(Coordinate::angle, at.yaw, at.yaw, 0);
}

void turn_drive_turn(const Robot& robot, bool reverse, const double* q0, const double* q1, std::vector<double>& rows) {
    const double dx = q1[0] - q0[0], dy = q1[1] - q0[1];
    if (dx * dx + dy * dy < min_distance * min_distance) return;
    const double ahead = arc_tangent(dy, dx);
    const auto total_turn = [&](double heading) {
        return std::fabs(change(Coordinate::angle, q0[2], heading)) +
               std::fabs(change(Coordinate::angle, heading, q1[2]));
    };
    const double heading = reverse && total_turn(ahead + pi) < total_turn(ahead) ? ahead + pi : ahead;
    add_row(robot, q0, q1, 1.0 / 3, {q0[0], q0[1], heading}, rows);
    add_row(robot, q0, q1, 2.0 / 3, {q1[0], q1[1], heading}, rows);
}

// The pose at a length along a segment; lengths in radii.
PlanarPose along(const PlanarPose& from, int turn, double length) {
    double s, c;
    sin_cos(from.yaw, s, c);
    if (turn == 0) return {from.x + length * c, from.y + length * s, from.yaw};
    const double yaw = from.yaw + turn * length;
    double s1, c1;
    sin_cos(yaw, s1, c1);
    return {from.x + turn * (s1 - s), from.y - turn * (c1 - c), yaw};
}

void car_legs(const Robot& robot, const Steering& steering, const double* q0, const double* q1,
              std::vector<double>& rows) {
    double s, c;
    sin_cos(q0[2], s, c);
    const double r = steering.radius, dx = (q1[0] - q0[0]) / r, dy = (q1[1] - q0[1]) / r;
    const double x = c * dx + s * dy, y = c * dy - s * dx, yaw = q1[2] - q0[2];
    const CarPath segments = steering.method == SteeringMethod::dubins ? dubins(x, y, yaw) : reeds_shepp(x, y, yaw);
    double total = 0, done = 0;
    for (const PathSegment& p : segments) total += std::fabs(p.length);
    PlanarPose at{0, 0, q0[2]};
    for (size_t i = 0; i < segments.size(); ++i) {
        const PathSegment& p = segments[i];
        const int n = p.turn ? std::max(1, static_cast<int>(std::ceil(std::fabs(p.length) / max_chord))) : 1;
        for (int k = 1; k <= n; ++k) {
            if (i + 1 == segments.size() && k == n) return;  // q1
            const PlanarPose next = along(at, p.turn, p.length * k / n);
            const double t = (done + std::fabs(p.length) * k / n) / total;
            add_row(robot, q0, q1, t, {q0[0] + r * next.x, q0[1] + r * next.y, next.yaw}, rows);
        }
        at = along(at, p.turn, p.length);
        done += std::fabs(p.length);
    }
}

}  // namespace

void legs(const Robot& robot, const Steering& steering, const double* q0, const double* q1, std::vector<double>& rows) {
    rows.assign(q0, q0 + robot.nq());
    switch (steering.method) {
        case SteeringMethod::straight: break;
        case SteeringMethod::turn_drive_turn: turn_drive_turn(robot, steering.reverse, q0, q1, rows); break;
        case SteeringMethod::dubins:
        case SteeringMethod::reeds_shepp: car_legs(robot, steering, q0, q1, rows);
    }
    rows.insert(rows.end(), q1, q1 + robot.nq());
}

}  // namespace fgenv
