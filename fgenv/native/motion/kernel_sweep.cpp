// Which pairs of faces may come near each other while two shapes move: dual descent with oriented boxes
// that are swept along their velocity, then faces. Nothing here is fused: what is left must not depend on
// the instruction set, since where a contact is bracketed does.
#include "query/box_culling.h"
#include "query/face_culling.h"
#include "query/kernels.h"

namespace fgenv::FGENV_ISA {
namespace {

// Floats of a velocity times half the time are off by less than this share of it.
constexpr float float_share = 1e-5f;

struct Side {
    float v[3], w[3], origin[3];
    float turn, at_origin, by_radius;
};

Side side_of(const Sweep::Side& s, Vec3 v, Vec3 w, Vec3 origin) {
    const double turn = norm(w);
    return {{float(v.x), float(v.y), float(v.z)},
            {float(w.x), float(w.y), float(w.z)},
            {float(origin.x), float(origin.y), float(origin.z)},
            static_cast<float>(turn) * 1.0001f,
            static_cast<float>(s.at_origin) * 1.0001f,
            static_cast<float>(s.by_radius) * 1.0001f};
}

// Both sides as seen from one of the shapes, whose origin is the frame's.
struct View {
    const PairFrame& frame;  // places the other shape
    Side own, other;
    float pad;  // margin and slack
};

struct Drift {
    float u[3];  // displacement of the box's center in half the time
    float e;     // what any point of the box may stray from that
};

// At least the length of a vector, at most 1.16 times it.
FGENV_INLINE float length_bound(float x, float y, float z) {
    const float a = std::fabs(x), b = std::fabs(y), c = std::fabs(z);
    const float most = a > b ? (a > c ? a : c) : (b > c ? b : c);
    return 0.5f * (a + b + c + most);
}

FGENV_INLINE Drift drift(const Side& s, float cx, float cy, float cz, float radius) {
    const float x = cx - s.origin[0], y = cy - s.origin[1], z = cz - s.origin[2];
    Drift out;
    out.u[0] = s.v[0] + (s.w[1] * z - s.w[2] * y);
    out.u[1] = s.v[1] + (s.w[2] * x - s.w[0] * z);
    out.u[2] = s.v[2] + (s.w[0] * y - s.w[1] * x);
    const float far = length_bound(x, y, z) + radius;
    out.e = s.turn * radius + s.at_origin + s.by_radius * far +
            float_share * (length_bound(s.v[0], s.v[1], s.v[2]) + s.turn * far);
    return out;
}

FGENV_INLINE F8 length_bound(F8 x, F8 y, F8 z) {
    x = abs(x);
    y = abs(y);
    z = abs(z);
    return splat(0.5f) * (x + y + z + max(max(x, y), z));
}

// The part of d across u, of any length; a direction to try, so that rounding does no harm.
FGENV_INLINE void across(const F8 (&d)[3], const F8 (&u)[3], F8 (&w)[3]) {
    const F8 uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], du = d[0] * u[0] + d[1] * u[1] + d[2] * u[2];
    const F8 share = uu > splat(1e-30f) ? du / uu : F8{};
    for (int i = 0; i < 3; ++i) w[i] = d[i] - share * u[i];
}

// Which of a node's eight may meet `box` within the half time before and after: a separating axis of the
// boxes at the middle must also hold off what they do along it. As `meeting`.
FGENV_INLINE uint32_t meeting(const Oriented& n, const PlacedBox& box, const View& view) {
    F8 d[3], h[3], axis[3][3], r[3][3], abs_r[3][3], along_n[3], u[3];
    const float box_radius = length_bound(box.h[0], box.h[1], box.h[2]);
    const Drift theirs = drift(view.other, box.c[0], box.c[1], box.c[2], box_radius);
    const Side& own = view.own;
    F8 c[3];
    for (int k = 0; k < 3; ++k) {
        c[k] = load(n.center[k]);
        d[k] = c[k] - splat(box.c[k]);
        h[k] = load(n.half[k]);
        c[k] = c[k] - splat(own.origin[k]);
    }
    load_axes(n, axis);
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        u[k] = splat(own.v[k] - theirs.u[k]) + (splat(own.w[l]) * c[m] - splat(own.w[m]) * c[l]);
    }
    const F8 radius = length_bound(h[0], h[1], h[2]);
    const F8 far = length_bound(c[0], c[1], c[2]) + radius;
    const F8 e = splat(theirs.e + view.pad + own.at_origin + float_share * length_bound(own.v[0], own.v[1], own.v[2])) +
                 splat(own.turn) * radius + splat(own.by_radius + float_share * own.turn) * far;
    I8 meet = h[0] >= splat(0.0f);
    for (int j = 0; j < 3; ++j) {
        const F8 x = splat(box.axis[j][0]), y = splat(box.axis[j][1]), z = splat(box.axis[j][2]);
        F8 reach = splat(box.h[j]) + e;
        for (int i = 0; i < 3; ++i) {
            r[i][j] = x * axis[i][0] + y * axis[i][1] + z * axis[i][2];
            abs_r[i][j] = abs(r[i][j]);
            reach += h[i] * abs_r[i][j];
        }
        meet &= abs(d[0] * x + d[1] * y + d[2] * z) <= reach + abs(u[0] * x + u[1] * y + u[2] * z);
    }
    if (!bits(meet)) return 0;
    // What passes by is held off across its way: along the centers' offset, less what of it is along u.
    {
        F8 w[3];
        across(d, u, w);
        F8 reach = length_bound(w[0], w[1], w[2]) * e;
        for (int i = 0; i < 3; ++i) reach += h[i] * abs(w[0] * axis[i][0] + w[1] * axis[i][1] + w[2] * axis[i][2]);
        for (int j = 0; j < 3; ++j)
            reach += splat(box.h[j]) *
                     abs(w[0] * splat(box.axis[j][0]) + w[1] * splat(box.axis[j][1]) + w[2] * splat(box.axis[j][2]));
        meet &= abs(d[0] * w[0] + d[1] * w[1] + d[2] * w[2]) <= reach + abs(u[0] * w[0] + u[1] * w[1] + u[2] * w[2]);
        if (!bits(meet)) return 0;
    }
    F8 along_u[3];
    for (int i = 0; i < 3; ++i) {
        along_n[i] = d[0] * axis[i][0] + d[1] * axis[i][1] + d[2] * axis[i][2];
        along_u[i] = u[0] * axis[i][0] + u[1] * axis[i][1] + u[2] * axis[i][2];
        F8 reach = h[i] + e;
        for (int j = 0; j < 3; ++j) reach += abs_r[i][j] * splat(box.h[j]);
        meet &= abs(along_n[i]) <= reach + abs(along_u[i]);
    }
    if (!bits(meet)) return 0;
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const F8 along = along_n[i2] * r[i1][j] - along_n[i1] * r[i2][j];
            const F8 moved = along_u[i2] * r[i1][j] - along_u[i1] * r[i2][j];
            const F8 reach = h[i1] * abs_r[i2][j] + h[i2] * abs_r[i1][j] + splat(box.h[j1]) * abs_r[i][j2] +
                             splat(box.h[j2]) * abs_r[i][j1] + e;
            meet &= abs(along) <= reach + abs(moved);
        }
    }
    return bits(meet);
}

// Displacements of the corners of eight faces, less what the other leaf's center does.
FGENV_INLINE void corner_drifts(const FacesF& f, const Side& s, const float center[3], const float less[3],
                                F8 (&u)[3][3]) {
    for (int k = 0; k < 3; ++k) {
        F8 c[3];
        for (int i = 0; i < 3; ++i) c[i] = f.v[k][i] + splat(center[i] - s.origin[i]);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            u[k][i] = splat(s.v[i] - less[i]) + (splat(s.w[j]) * c[l] - splat(s.w[l]) * c[j]);
        }
    }
}

FGENV_INLINE void find_swept_boxes(FacesF& f, const F8 (&u)[3][3], float pad) {
    for (int i = 0; i < 3; ++i) {
        const F8 x = abs(u[0][i]), y = abs(u[1][i]), z = abs(u[2][i]);
        f.lo[i] = min(min(f.v[0][i] - x, f.v[1][i] - y), f.v[2][i] - z) - splat(pad);
        f.hi[i] = max(max(f.v[0][i] + x, f.v[1][i] + y), f.v[2][i] + z) + splat(pad);
    }
}

// The eight faces may meet the plane of one face, or the one the planes of the eight: `side` are heights
// of corners over the plane, `rise` what they change by in half the time, `lift` what the plane's own
// corners do. Heights are linear in time up to `reach`, so two times tell.
FGENV_INLINE I8 crossing_plane(const F8 (&side)[3], const F8 (&rise)[3], const F8 (&lift)[3], F8 reach) {
    const F8 up = max(max(lift[0], lift[1]), lift[2]), down = min(min(lift[0], lift[1]), lift[2]);
    const F8 lo_after = min(min(side[0] + rise[0], side[1] + rise[1]), side[2] + rise[2]) - up;
    const F8 hi_after = max(max(side[0] + rise[0], side[1] + rise[1]), side[2] + rise[2]) - down;
    const F8 lo_before = min(min(side[0] - rise[0], side[1] - rise[1]), side[2] - rise[2]) + down;
    const F8 hi_before = max(max(side[0] - rise[0], side[1] - rise[1]), side[2] - rise[2]) + up;
    return (min(lo_after, lo_before) <= reach) & (max(hi_after, hi_before) >= -reach);
}

struct Found {
    FacePair* out;
    int count, capacity;
};

void near_faces(const Sweep& sweep, const View& view, const Leaf& la, const Leaf& lb, Found& found) {
    FacesF a, b;
    float shift[3];
    // As load_leaves, without fused products.
    const Vec3 at =
        apply(sweep.pose, {lb.center[0], lb.center[1], lb.center[2]}) - Vec3{la.center[0], la.center[1], la.center[2]};
    shift[0] = static_cast<float>(at.x);
    shift[1] = static_cast<float>(at.y);
    shift[2] = static_cast<float>(at.z);
    load_faces(la, a);
    const auto& r = view.frame.r;
    for (int k = 0; k < 3; ++k) {
        const F8 x = load(lb.v[k][0]), y = load(lb.v[k][1]), z = load(lb.v[k][2]);
        for (int i = 0; i < 3; ++i)
            b.v[k][i] = splat(r[i][0]) * x + splat(r[i][1]) * y + splat(r[i][2]) * z + splat(shift[i]);
    }
    const Local local =
        local_errors(2 * (size(la) + size(lb)) + std::fabs(shift[0]) + std::fabs(shift[1]) + std::fabs(shift[2]));
    const float radius_a = length_bound(la.half[0], la.half[1], la.half[2]);
    const float radius_b = length_bound(lb.half[0], lb.half[1], lb.half[2]);
    const float far[3] = {la.center[0] + shift[0], la.center[1] + shift[1], la.center[2] + shift[2]};
    const Drift of_a = drift(view.own, la.center[0], la.center[1], la.center[2], radius_a);
    const Drift of_b = drift(view.other, far[0], far[1], far[2], radius_b);
    // Here every corner has its own displacement: what is left is the acceleration and rounding.
    const float pad = (of_a.e - view.own.turn * radius_a) + (of_b.e - view.other.turn * radius_b) + view.pad +
                      2 * local.slack + 2 * float_share * (view.own.turn * radius_a + view.other.turn * radius_b);
    F8 ua[3][3], ub[3][3];
    corner_drifts(a, view.own, la.center, of_b.u, ua);
    corner_drifts(b, view.other, la.center, of_b.u, ub);
    find_swept_boxes(a, ua, pad);
    find_swept_boxes(b, ub, 0);
    bool normals = false;
    for (uint32_t m = la.valid; m; m &= m - 1) {
        const int i = __builtin_ctz(m);
        I8 near = (b.lo[0] <= splat(a.hi[0][i])) & (b.hi[0] >= splat(a.lo[0][i])) & (b.lo[1] <= splat(a.hi[1][i])) &
                  (b.hi[1] >= splat(a.lo[1][i])) & (b.lo[2] <= splat(a.hi[2][i])) & (b.hi[2] >= splat(a.lo[2][i]));
        uint32_t among = lb.valid & bits(near);
        if (!among) continue;
        if (!normals) {
            for (FacesF* f : {&a, &b}) {
                F8 u[3], w[3];
                f->scale = F8{};
                for (int x = 0; x < 3; ++x) {
                    u[x] = f->v[1][x] - f->v[0][x];
                    w[x] = f->v[2][x] - f->v[0][x];
                    f->scale += abs(u[x]) + abs(w[x]);
                }
                for (int x = 0; x < 3; ++x) {
                    const int y = (x + 1) % 3, z = (x + 2) % 3;
                    f->n[x] = u[y] * w[z] - u[z] * w[y];
                }
            }
            normals = true;
        }
        F8 side[3], rise[3], lift[3];
        const F8 volume = splat(local.volume_slack * local.size);
        for (int k = 0; k < 3; ++k) {
            side[k] = rise[k] = lift[k] = F8{};
            for (int x = 0; x < 3; ++x) {
                const F8 n = splat(a.n[x][i]);
                side[k] += n * (b.v[k][x] - splat(a.v[0][x][i]));
                rise[k] += n * ub[k][x];
                lift[k] += n * splat(ua[k][x][i]);
            }
        }
        const float nx = a.n[0][i], ny = a.n[1][i], nz = a.n[2][i];
        near = crossing_plane(side, rise, lift, splat(length_bound(nx, ny, nz) * pad) + volume * splat(a.scale[i]));
        among &= bits(near);
        if (!among) continue;
        for (int k = 0; k < 3; ++k) {
            side[k] = rise[k] = lift[k] = F8{};
            for (int x = 0; x < 3; ++x) {
                side[k] += b.n[x] * (splat(a.v[k][x][i]) - b.v[0][x]);
                rise[k] += b.n[x] * splat(ua[k][x][i]);
                lift[k] += b.n[x] * ub[k][x];
            }
        }
        near = crossing_plane(side, rise, lift, length_bound(b.n[0], b.n[1], b.n[2]) * splat(pad) + volume * b.scale);
        among &= bits(near);
        if (!among) continue;
        // Across the way of the middles, as for boxes.
        F8 d[3], u[3], w[3];
        for (int x = 0; x < 3; ++x) {
            d[x] = (b.v[0][x] + b.v[1][x] + b.v[2][x]) - splat(a.v[0][x][i] + a.v[1][x][i] + a.v[2][x][i]);
            u[x] = (ub[0][x] + ub[1][x] + ub[2][x]) - splat(ua[0][x][i] + ua[1][x][i] + ua[2][x][i]);
        }
        across(d, u, w);
        F8 top_after = splat(-1e30f), top_before = top_after, low_after = splat(1e30f), low_before = low_after;
        for (int k = 0; k < 3; ++k) {
            F8 at_a = F8{}, at_b = F8{}, rise_a = F8{}, rise_b = F8{};
            for (int x = 0; x < 3; ++x) {
                at_a += w[x] * splat(a.v[k][x][i]);
                at_b += w[x] * b.v[k][x];
                rise_a += w[x] * splat(ua[k][x][i]);
                rise_b += w[x] * ub[k][x];
            }
            top_after = max(top_after, at_a + rise_a);
            top_before = max(top_before, at_a - rise_a);
            low_after = min(low_after, at_b + rise_b);
            low_before = min(low_before, at_b - rise_b);
        }
        near = min(low_after - top_after, low_before - top_before) <= length_bound(w[0], w[1], w[2]) * splat(pad);
        for (among &= bits(near); among; among &= among - 1) {
            if (found.count == found.capacity) {
                ++found.count;
                return;
            }
            found.out[found.count++] = {la.face[i], lb.face[__builtin_ctz(among)]};
        }
    }
}

}  // namespace

int sweep(const Shape& a, const Shape& b, const Sweep& s, FacePair* out, int capacity) {
    const PairFrames frames = pair_frames(a, b, s.pose);
    const float pad = static_cast<float>(s.margin) * 1.00001f + frames.b_in_a.slack * 2;
    const Vec3 b_origin = {s.pose.t[0], s.pose.t[1], s.pose.t[2]};
    const Rigid back = inverse(s.pose);
    const View from_a{frames.b_in_a, side_of(s.a, s.a.v, s.a.w, {0, 0, 0}), side_of(s.b, s.b.v, s.b.w, b_origin), pad};
    const View from_b{frames.a_in_b, side_of(s.b, rotate(back, s.b.v), rotate(back, s.b.w), {0, 0, 0}),
                      side_of(s.a, rotate(back, s.a.v), rotate(back, s.a.w), {back.t[0], back.t[1], back.t[2]}), pad};
    struct Pair {
        Ref a, b;
    };
    Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    Found found{out, 0, capacity};
    const Tree &ta = a.tree, &tb = b.tree;
    if (!meeting(ta.oriented[0], placed(tb.boxes[0], from_a.frame), from_a)) return 0;
    stack[top++] = {0, 0};
    for (int opened = 0; top && found.count <= capacity; ++opened) {
        if (opened == s.budget) return capacity + 1;
        const Pair pair = stack[--top];
        const OrientedBox &box_a = ta.boxes[pair.a], &box_b = tb.boxes[pair.b];
        const int32_t ca = box_a.child, cb = box_b.child;
        if (ca < 0 && cb < 0) {
            near_faces(s, from_a, ta.leaves[~ca], tb.leaves[~cb], found);
            continue;
        }
        if (cb < 0 || (ca >= 0 && size(box_a) >= size(box_b))) {
            for (uint32_t m = meeting(ta.oriented[ca], placed(box_b, from_a.frame), from_a); m; m &= m - 1)
                stack[top++] = {static_cast<Ref>(lanes * ca + __builtin_ctz(m)), pair.b};
        } else {
            for (uint32_t m = meeting(tb.oriented[cb], placed(box_a, from_b.frame), from_b); m; m &= m - 1)
                stack[top++] = {pair.a, static_cast<Ref>(lanes * cb + __builtin_ctz(m))};
        }
    }
    return found.count;
}

}  // namespace fgenv::FGENV_ISA
