// One shape's frame seen from the other's, in floats, with the slack that makes every float test
// conservative; and the test of one box against a node's eight.
//
// Slack: with coordinates up to M, a separating axis test sums errors of at most 47 units of 2^-24 M from
// rounding centers, axes and extents (71 for a product of axes, which gets twice the slack); a rotation
// off orthonormal by `skew` adds at most 4 skew M. What the slack lets through costs a test, never a
// verdict.
#pragma once

#include "math/lanes.h"
#include "shape/shape.h"

namespace fgenv {

struct PairFrame {
    F4 columns[3], shift;  // of the rotation; the translation
    float r[3][3], t[3];
    float slack;  // meters, on a coordinate
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

static inline PairFrame pair_frame(const float r[3][3], const float t[3], float slack) {
    PairFrame out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out.r[i][j] = r[i][j];
        out.t[i] = t[i];
        out.columns[i] = F4{r[0][i], r[1][i], r[2][i], 0};
    }
    out.shift = F4{t[0], t[1], t[2], 0};
    out.slack = slack;
    return out;
}

static inline PairFrames pair_frames(const Shape& a, const Shape& b, const Rigid& pose) {
    const double reach = std::fabs(pose.t[0]) + std::fabs(pose.t[1]) + std::fabs(pose.t[2]) + 1.8 * (a.reach + b.reach);
    const float slack = static_cast<float>((64 * 0x1p-24 + 4 * skew(pose)) * reach);
    float r[3][3], transposed[3][3], t[3], back[3];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) r[i][j] = transposed[j][i] = static_cast<float>(pose.r[i][j]);
        t[i] = static_cast<float>(pose.t[i]);
        // The transpose serves as the inverse: the slack covers the difference.
        back[i] = static_cast<float>(-(pose.r[0][i] * pose.t[0] + pose.r[1][i] * pose.t[1] + pose.r[2][i] * pose.t[2]));
    }
    return {pair_frame(r, t, slack), pair_frame(transposed, back, slack)};
}

static inline BoxF box_of(const Tree& tree, Ref ref) {
    const Node& n = tree.nodes[ref / lanes];
    const int k = ref % lanes;
    return {{n.center[0][k], n.center[1][k], n.center[2][k]}, {n.half[0][k], n.half[1][k], n.half[2][k]}};
}

static inline BoxF posed(const BoxF& box, const PairFrame& f) {
    BoxF out;
    for (int i = 0; i < 3; ++i) {
        out.c[i] = f.r[i][0] * box.c[0] + f.r[i][1] * box.c[1] + f.r[i][2] * box.c[2] + f.t[i];
        out.h[i] = std::fabs(f.r[i][0]) * box.h[0] + std::fabs(f.r[i][1]) * box.h[1] + std::fabs(f.r[i][2]) * box.h[2] +
                   f.slack;
    }
    return out;
}

}  // namespace fgenv
