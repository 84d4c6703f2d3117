// The exact fallback of predicates.h: sums of products held as non-overlapping expansions.
#include "math/predicates.h"

namespace fgenv {
namespace {

// A number as the exact sum of `n` doubles, smallest first, no zeros.
template <int N>
struct Expansion {
    double v[N];
    int n = 0;
};

void two_sum(double a, double b, double& sum, double& tail) {
    sum = a + b;
    const double b_virtual = sum - a;
    tail = (a - (sum - b_virtual)) + (b - b_virtual);
}

void split(double a, double& high, double& low) {
    const double c = 134217729.0 * a;  // 2^27 + 1
    high = c - (c - a);
    low = a - high;
}

void two_product(double a, double b, double& product, double& tail) {
    product = a * b;
    double ah, al, bh, bl;
    split(a, ah, al);
    split(b, bh, bl);
    tail = al * bl - (((product - ah * bh) - al * bh) - ah * bl);
}

template <int N>
void add(Expansion<N>& e, double b) {
    int n = 0;
    double q = b;
    for (int i = 0; i < e.n; ++i) {
        double sum, tail;
        two_sum(q, e.v[i], sum, tail);
        if (tail != 0) e.v[n++] = tail;
        q = sum;
    }
    if (q != 0) e.v[n++] = q;
    e.n = n;
}

template <int N>
void add_product(Expansion<N>& e, double a, double b) {
    double product, tail;
    two_product(a, b, product, tail);
    if (tail != 0) add(e, tail);
    if (product != 0) add(e, product);
}

Expansion<2> difference(double a, double b) {
    Expansion<2> e;
    double sum, tail;
    two_sum(a, -b, sum, tail);
    if (tail != 0) e.v[e.n++] = tail;
    if (sum != 0) e.v[e.n++] = sum;
    return e;
}

// out += sign * a * b
template <int N, int A, int B>
void accumulate(Expansion<N>& out, const Expansion<A>& a, const Expansion<B>& b, double sign) {
    for (int i = 0; i < a.n; ++i)
        for (int j = 0; j < b.n; ++j) add_product(out, sign * a.v[i], b.v[j]);
}

template <int N>
int sign(const Expansion<N>& e) {
    return e.n == 0 ? 0 : e.v[e.n - 1] > 0 ? 1 : -1;
}

}  // namespace

int orient2d_exact(const double a[2], const double b[2], const double c[2]) {
    const auto ax = difference(a[0], c[0]), ay = difference(a[1], c[1]);
    const auto bx = difference(b[0], c[0]), by = difference(b[1], c[1]);
    Expansion<16> det;
    accumulate(det, ax, by, 1);
    accumulate(det, ay, bx, -1);
    return sign(det);
}

namespace {

int sign_of_determinant(const Expansion<2> (&x)[3], const Expansion<2> (&y)[3], const Expansion<2> (&z)[3]) {
    Expansion<192> det;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        Expansion<16> minor;
        accumulate(minor, x[j], y[k], 1);
        accumulate(minor, x[k], y[j], -1);
        accumulate(det, minor, z[i], 1);
    }
    return sign(det);
}

}  // namespace

int orient3d_exact(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Expansion<2> x[3] = {difference(a.x, d.x), difference(b.x, d.x), difference(c.x, d.x)};
    const Expansion<2> y[3] = {difference(a.y, d.y), difference(b.y, d.y), difference(c.y, d.y)};
    const Expansion<2> z[3] = {difference(a.z, d.z), difference(b.z, d.z), difference(c.z, d.z)};
    return sign_of_determinant(x, y, z);
}

int orient_line_exact(Vec3 direction, Vec3 a, Vec3 b, Vec3 o) {
    const Expansion<2> x[3] = {difference(direction.x, 0), difference(a.x, o.x), difference(b.x, o.x)};
    const Expansion<2> y[3] = {difference(direction.y, 0), difference(a.y, o.y), difference(b.y, o.y)};
    const Expansion<2> z[3] = {difference(direction.z, 0), difference(a.z, o.z), difference(b.z, o.z)};
    return sign_of_determinant(x, y, z);
}

bool collinear(Vec3 a, Vec3 b, Vec3 c) {
    const double p[3][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}};
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double pa[2] = {p[0][u], p[0][v]}, pb[2] = {p[1][u], p[1][v]}, pc[2] = {p[2][u], p[2][v]};
        if (orient2d(pa, pb, pc) != 0) return false;
    }
    return true;
}

}  // namespace fgenv
