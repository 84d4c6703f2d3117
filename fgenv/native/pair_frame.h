// One shape's frame seen from the other's, in floats, with the slack that makes every float test
// conservative; and the test of one box against a node's eight.
//
// Slack: coordinates up to M carry an error of a few units of 2^-24 M from rounding the vertices, the
// rotation and their product; a rotation off orthonormal by `skew` adds skew * M. Both are covered
// several times over: what the slack lets through costs a test, never a verdict.
#pragma once

#include "lanes.h"
#include "shape.h"

namespace fgenv {

struct PairFrame {
    float r[3][3], abs_r[3][3], t[3];
    float slack;  // metres, on a coordinate
};

struct BoxF {
    float c[3], h[3];
};

struct PairFrames {
    PairFrame b_in_a, a_in_b;
};

static inline double skew(const Rigid& m) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) {
            const double d = m.r[0][i] * m.r[0][j] + m.r[1][i] * m.r[1][j] + m.r[2][i] * m.r[2][j];
            worst = greater(worst, std::fabs(d - (i == j)));
        }
    return worst;
}

static inline double largest_coordinate(const Box& box) {
    return greater(greater(greater(-box.lo.x, box.hi.x), greater(-box.lo.y, box.hi.y)),
                     greater(-box.lo.z, box.hi.z));
}

static inline void to_float(const Rigid& m, float slack, PairFrame& out) {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[i][j] = static_cast<float>(m.r[i][j]);
            out.abs_r[i][j] = std::fabs(out.r[i][j]);
        }
        out.t[i] = static_cast<float>(m.t[i]);
    }
    out.slack = slack;
}

static inline PairFrames pair_frames(const Shape& a, const Shape& b, const Rigid& pose) {
    const double reach = std::fabs(pose.t[0]) + std::fabs(pose.t[1]) + std::fabs(pose.t[2]) +
                         1.8 * (std::fabs(largest_coordinate(a.mesh.bounds)) +
                                std::fabs(largest_coordinate(b.mesh.bounds)));
    const float slack = static_cast<float>((16 * 0x1p-24 + 4 * skew(pose)) * reach);
    PairFrames frames;
    to_float(pose, slack, frames.b_in_a);
    to_float(inverse(pose), slack, frames.a_in_b);
    return frames;
}

static inline BoxF box_of(const Tree& tree, Ref ref) {
    const Node& n = tree.nodes[ref / lanes];
    const int k = ref % lanes;
    return {{n.centre[0][k], n.centre[1][k], n.centre[2][k]}, {n.half[0][k], n.half[1][k], n.half[2][k]}};
}

static inline int32_t child_of(const Tree& tree, Ref ref) {
    return tree.nodes[ref / lanes].child[ref % lanes];
}

static inline BoxF placed(const BoxF& box, const PairFrame& f) {
    BoxF out;
    for (int i = 0; i < 3; ++i) {
        out.c[i] = f.r[i][0] * box.c[0] + f.r[i][1] * box.c[1] + f.r[i][2] * box.c[2] + f.t[i];
        out.h[i] = f.abs_r[i][0] * box.h[0] + f.abs_r[i][1] * box.h[1] + f.abs_r[i][2] * box.h[2] +
                   f.slack;
    }
    return out;
}

}  // namespace fgenv
