// Certified motion of a pair of bodies: proved free, or a first contact bracketed by two fractions.
#pragma once

#include "motion/rigid_motion.h"

namespace fgenv {

struct Moving {
    const Shape* shape;
    const BodyMotion* motion;
};

struct CertifySettings {
    double margin = 0;        // meters; a smaller distance counts as contact
    double tolerance = 1e-6;  // meters; bound on any point's motion between the two fractions of a contact
    double speed = 0;         // upper bound over all points of the movers, including their other bodies
    bool first = true;        // false: report any contact
};

// Free up to `free_until`; in contact at `shown`, which is NaN if the search gave up (unresolved). Where bodies graze,
// or the tolerance is below the rounding of coordinates, `shown` may be later than the tolerance allows.
struct MotionContact {
    double free_until = 1, shown = 1;
    bool found = false;
    int64_t work = 0;  // steps of the searches so far

    // Whether this later result is a contact of other faces, rather than the earlier contact with less proved free.
    bool replaces(const MotionContact& before) const {
        return found && (!before.found || (free_until < before.free_until && shown != before.shown));
    }
};

// Conservative advancement (X. Zhang et al., "Interactive continuous collision detection for non-convex
// polyhedra", 2006; M. Tang et al., "C2A", 2009), in two stages: whole trees against each other at the
// middle of a stretch of time, swept along their velocities; then each remaining pair of faces on its own.
// The stretch is halved if many pairs remain. Bodies that slide flush are separated by planes at rest (flush_plane.h),
// each for a long stretch. A bound on the number of steps, which depends on the number of faces, ends the search.
//
// Tests surfaces only. The caller has tested that the pair is free at t = lo, including containment. Searches
// up to t = contact.free_until, and stores an earlier contact in `contact`.
void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  MotionContact& contact);

}  // namespace fgenv
