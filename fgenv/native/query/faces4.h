// Faces four at a time, in double. Segments as in C. Ericson, "Real-Time Collision Detection", 2005,
// section 5.1.9; a face's interior is only asked for vertices, since sides against sides cover the rest.
#pragma once

#include "math/geometry.h"
#include "math/lanes.h"

namespace fgenv {

constexpr int width = 4;  // doubles side by side

typedef D4 V4[3];  // four points or vectors

FGENV_INLINE D4 dot(const V4 a, const V4 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
FGENV_INLINE void subtract(const V4 a, const V4 b, V4 out) {
    for (int i = 0; i < 3; ++i) out[i] = a[i] - b[i];
}
FGENV_INLINE void cross(const V4 a, const V4 b, V4 out) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}
FGENV_INLINE D4 clamped(D4 x) { return min(max(x, splat(0.0)), splat(1.0)); }
// 1 / x, and 0 where x is 0 (a side of length 0 after placing, parallel sides).
FGENV_INLINE D4 reciprocal(D4 x) { return x > splat(0.0) ? splat(1.0) / x : splat(0.0); }

// Parameters of the nearest points of p + s u and q + t w, 0 <= s, t <= 1; the squared distance.
FGENV_INLINE D4 segments(const V4 p, const V4 u, D4 uu, D4 inv_uu, const V4 q, const V4 w, D4 ww, D4 inv_ww, D4& s,
                         D4& t) {
    V4 r;
    subtract(p, q, r);
    const D4 ur = dot(u, r), wr = dot(w, r), uw = dot(u, w);
    s = clamped((uw * wr - ur * ww) * reciprocal(uu * ww - uw * uw));
    t = clamped((uw * s + wr) * inv_ww);
    s = clamped((uw * t - ur) * inv_uu);
    for (int i = 0; i < 3; ++i) r[i] += s * u[i] - t * w[i];
    return dot(r, r);
}

struct Faces {
    V4 v[3], side[3];             // side k from vertex k to k + 1
    D4 length[3], inv_length[3];  // squared
    V4 n;
    D4 inv_n;  // of the squared normal
};

FGENV_INLINE void derive(Faces& f) {
    for (int k = 0; k < 3; ++k) {
        subtract(f.v[(k + 1) % 3], f.v[k], f.side[k]);
        f.length[k] = dot(f.side[k], f.side[k]);
        f.inv_length[k] = reciprocal(f.length[k]);
    }
    cross(f.side[0], f.side[1], f.n);
    f.inv_n = reciprocal(dot(f.n, f.n));
}

// Squared distance of point p to the interior of the face, huge where it projects outside.
FGENV_INLINE D4 above_face(const V4 p, const Faces& f) {
    L4 within = L4{} == 0;
    V4 r, outward;
    for (int k = 0; k < 3; ++k) {
        subtract(p, f.v[k], r);
        cross(f.side[k], f.n, outward);
        within &= dot(r, outward) <= splat(0.0);
    }
    const D4 height = dot(r, f.n);  // over the last vertex
    const D4 squared = height * height * f.inv_n;
    return (within & (f.inv_n > splat(0.0))) ? squared : splat(HUGE_VAL);
}

// Four points, to be written one by one and read side by side.
struct Points {
    alignas(32) double at[3][width];
};

FGENV_INLINE void put(Points& out, int lane, Vec3 p) {
    out.at[0][lane] = p.x;
    out.at[1][lane] = p.y;
    out.at[2][lane] = p.z;
}

FGENV_INLINE Vec3 point(const Points& p, int lane) { return {p.at[0][lane], p.at[1][lane], p.at[2][lane]}; }

FGENV_INLINE void read(const Points& p, V4 out) {
    for (int i = 0; i < 3; ++i) std::memcpy(&out[i], p.at[i], sizeof out[i]);
}

}  // namespace fgenv
