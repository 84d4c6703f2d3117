#include "robot/robot.h"

#include "math/constants.h"

namespace fgenv {
namespace {

// In [-pi, pi]; an angle in that range is unchanged.
double wrapped(double angle) {
    if (std::fabs(angle) <= pi) return angle;
    const double out = angle - 2 * pi * std::floor((angle + pi) / (2 * pi));
    return lesser(greater(out, -pi), pi);
}

Rigid turned_about(const Rigid& at, Vec3 k, double angle) {
    double s, c;
    sin_cos(angle, s, c);
    const double v = 1 - c;
    const double r[3][3] = {{c + v * k.x * k.x, v * k.x * k.y - s * k.z, v * k.x * k.z + s * k.y},
                            {v * k.y * k.x + s * k.z, c + v * k.y * k.y, v * k.y * k.z - s * k.x},
                            {v * k.z * k.x - s * k.y, v * k.z * k.y + s * k.x, c + v * k.z * k.z}};
    Rigid out = at;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out.r[i][j] = at.r[i][0] * r[0][j] + at.r[i][1] * r[1][j] + at.r[i][2] * r[2][j];
    return out;
}

Rigid shifted(const Rigid& at, Vec3 by) {
    Rigid out = at;
    const Vec3 t = apply(at, by);
    out.t[0] = t.x, out.t[1] = t.y, out.t[2] = t.z;
    return out;
}

}  // namespace

double change(Coordinate kind, double from, double to) {
    return kind == Coordinate::angle ? wrapped(to - from) : to - from;
}

double between(Coordinate kind, double from, double to, double t) {
    if (kind == Coordinate::angle) return wrapped(t < 1 ? from + change(kind, from, to) * t : to);
    return t < 1 ? from + (to - from) * t : to;
}

Rigid carried(const Joint& joint, const Rigid& at, const double* x) {
    switch (joint.kind) {
        case JointKind::fixed: return at;
        case JointKind::revolute:
        case JointKind::continuous: return turned_about(at, joint.axis, joint.multiplier * x[0] + joint.offset);
        case JointKind::prismatic: return shifted(at, (joint.multiplier * x[0] + joint.offset) * joint.axis);
        case JointKind::planar: return turned_about(shifted(at, {x[0], x[1], 0}), {0, 0, 1}, x[2]);
        case JointKind::free: {
            Rigid moved = identity();
            to_matrix({x[3], x[4], x[5], x[6]}, moved.r);
            moved.t[0] = x[0], moved.t[1] = x[1], moved.t[2] = x[2];
            return compose(at, moved);
        }
    }
    return at;
}

int32_t common_link(const Robot& robot, int32_t a, int32_t b) {
    while (a != b) (a > b ? a : b) = robot.joints[a > b ? a : b].parent;  // parents come before
    return a;
}

std::vector<double> held_up_to(const Robot& robot, int32_t link, const std::vector<double>& q0,
                               std::vector<double> q1) {
    std::vector<bool> carries(robot.n_links(), false), held(q1.size(), true);
    for (int32_t i = link; i >= 0; i = robot.joints[i].parent) carries[i] = true;
    for (int32_t i = 0; i < robot.n_links(); ++i)
        for (int32_t k = 0; k < size(robot.joints[i].kind) && !carries[i]; ++k) held[robot.joints[i].first + k] = false;
    for (size_t k = 0; k < q1.size(); ++k)
        if (held[k]) q1[k] = q0[k];
    return q1;
}

void forward(const Robot& robot, const double* q, Rigid* links) {
    for (int32_t i = 0; i < robot.n_links(); ++i) {
        const Joint& joint = robot.joints[i];
        const Rigid at = joint.parent < 0 ? joint.origin : compose(links[joint.parent], joint.origin);
        links[i] = carried(joint, at, q + joint.first);
    }
}

void interpolate(const Robot& robot, const double* q0, const double* q1, double t, double* out) {
    for (int32_t i = 0; i < robot.nq(); ++i) {
        if (robot.coordinates[i] != Coordinate::rotation) {
            out[i] = between(robot.coordinates[i], q0[i], q1[i], t);
            continue;
        }
        const Quaternion q =
            Slerp({q0[i], q0[i + 1], q0[i + 2], q0[i + 3]}, {q1[i], q1[i + 1], q1[i + 2], q1[i + 3]}).at(t);
        out[i] = q.x, out[i + 1] = q.y, out[i + 2] = q.z, out[i + 3] = q.w;
        i += 3;
    }
}

double displacement_bound(const Robot& robot, const double* weights, const double* q0, const double* q1) {
    const JointKind base = robot.joints[0].kind;
    const int32_t place = base == JointKind::planar ? 2 : base == JointKind::free ? 3 : 0;
    double squared = 0, sum = 0;
    for (int32_t i = 0; i < robot.nq(); ++i) {
        const double by = change(robot.coordinates[i], q0[i], q1[i]);
        const double moved = by == 0 ? 0 : weights[i] * by;  // a weight may be infinite
        if (i < place)
            squared += moved * moved;
        else if (robot.coordinates[i] != Coordinate::rotation)
            sum += std::fabs(moved);
        else if (i == place)
            sum +=
                weights[i] *
                norm(Slerp({q0[i], q0[i + 1], q0[i + 2], q0[i + 3]}, {q1[i], q1[i + 1], q1[i + 2], q1[i + 3]}).turn());
    }
    return std::sqrt(squared) + sum;
}

}  // namespace fgenv
