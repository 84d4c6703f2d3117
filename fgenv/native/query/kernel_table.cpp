#include "query/kernels.h"

namespace fgenv::FGENV_ISA {

bool collide(const Shape& a, const Shape& b, const Rigid& pose, bool lossless, Witness* witness);
Nearest nearest(const Shape& a, const Shape& b, const Rigid& pose, double bound, bool any);
RayHit raycast(const Shape& s, Vec3 o, Vec3 d, double max_distance);
bool obstructed(const Shape& s, Vec3 o, Vec3 d);
int winding(const Shape& s, Vec3 p, bool& touching);
int32_t segment(const Shape& s, Vec3 p, Vec3 q);
int sweep(const Shape& a, const Shape& b, const Sweep& sweep, FacePair* out, int capacity);
int drop_separated(const Shape& a, const Shape& b, const SeparationWindow& window, FacePair* pairs, int count);
Nearest nearest_faces(const Vec3 a[3], const Vec3 b[3]);

extern const Kernels table;
const Kernels table = {collide, nearest, raycast, obstructed, winding, segment, sweep, drop_separated, nearest_faces};

}  // namespace fgenv::FGENV_ISA
