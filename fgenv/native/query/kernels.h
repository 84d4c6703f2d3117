// The queries, one table of functions an instruction set.
#pragma once

#include <cstddef>

#include "shape/shape.h"

namespace fgenv {

// Evidence of a collision. With an edge: edge (k, k + 1) of a face, or chord k of a's loop, meets the
// other shape's face. Without: a point of one shape's part is inside the other.
struct Witness {
    enum Side : uint8_t { none, edge_of_a, edge_of_b, chord_of_a, a_inside_b, b_inside_a };
    Side side = none;
    int32_t face_a = -1, face_b = -1;
    int32_t edge = -1;
    Vec3 point{0, 0, 0};  // containment: in the frame of the shape that is inside
};

struct Nearest {
    double squared;   // of the distance
    Vec3 on_a, on_b;  // in a's frame
    int32_t face_a, face_b;
};

struct RayHit {
    double distance;  // in units of the direction's length; infinite: no hit
    int32_t face;
};

// Two shapes at the middle of a stretch of time, and how they move: all in a's frame, per half the stretch.
struct Sweep {
    struct Side {
        Vec3 v, w;                    // displacement of the origin; rotation vector
        double at_origin, by_radius;  // a point at distance d from the origin strays from what v and w
                                      // say by at most at_origin + d by_radius
    };
    Rigid pose;  // of b
    Side a, b;
    double margin;  // meters: nearer than this is met
    int budget;     // pairs of boxes to open at most; then as if there were too many pairs of faces
};

struct FacePair {
    int32_t a, b;
};

// Two bodies at one instant, their velocities, and how long before and after it is of interest. World
// axes, from b's origin.
struct SeparationWindow {
    Rigid a, b;  // b's translation is 0
    Vec3 va, wa, vb, wb;
    double acceleration_a[2], acceleration_b[2];  // at the origin, and what a unit of distance adds
    double before, after;
    double margin, slack;  // meters
};

// Poses are b's in a's frame.
struct Kernels {
    // By the edges of the shapes' graphs; with lossless = true by those of the exact graphs, whatever
    // the shapes' methods.
    bool (*collide)(const Shape& a, const Shape& b, const Rigid& pose, bool lossless, Witness* witness);
    // The nearest pair of points of the two surfaces that is closer than sqrt(bound); face_a < 0 if
    // there is none. With any = true the first pair found within the bound.
    Nearest (*nearest)(const Shape& a, const Shape& b, const Rigid& pose, double bound, bool any);
    RayHit (*raycast)(const Shape& shape, Vec3 origin, Vec3 direction, double max_distance);
    // Whether a ray meets the shape at all.
    bool (*obstructed)(const Shape& shape, Vec3 origin, Vec3 direction);
    // Winding number of the closed shells around p; `touching` is set if p is on one of them.
    int (*winding)(const Shape& shape, Vec3 p, bool& touching);
    // First face found that segment pq meets, -1 if none.
    int32_t (*segment)(const Shape& shape, Vec3 p, Vec3 q);
    // All pairs of faces that may meet in the stretch; returns their number, capacity + 1 if there are more.
    int (*sweep)(const Shape& a, const Shape& b, const Sweep& sweep, FacePair* out, int capacity);
    // Moves the pairs that may meet within the window to the front; returns their number.
    int (*drop_separated)(const Shape& a, const Shape& b, const SeparationWindow& window, FacePair* pairs, int count);
    // The nearest points of two faces that do not cross.
    Nearest (*nearest_faces)(const Vec3 a[3], const Vec3 b[3]);
};

// Distance of two shapes that do not collide, from its square: above 0, also where rounding hides the gap.
static inline double distance_apart(double squared) { return std::sqrt(greater(squared, 0x1p-1022)); }

const Kernels& kernels();    // the table in use
const char* kernels_name();  // "v3", "baseline"

// Whether two bodies collide or are nearer than `margin` (meters); a margin needs the exact graphs.
static inline bool hits(const Shape& a, const Shape& b, const Rigid& b_in_a, double margin, bool lossless) {
    return kernels().collide(a, b, b_in_a, lossless || margin > 0, nullptr) ||
           (margin > 0 && kernels().nearest(a, b, b_in_a, margin * margin, true).face_a >= 0);
}

}  // namespace fgenv
