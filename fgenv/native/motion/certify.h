// Certified motion of a pair of bodies: proved free, or the first contact between two fractions.
#pragma once

#include "motion/rigid_motion.h"

namespace fgenv {

struct Moving {
    const Shape* shape;
    const BodyMotion* motion;
};

struct CertifySettings {
    double margin = 0;        // meters: nearer than this is contact
    double tolerance = 1e-6;  // meters that any point moves between the two fractions of a contact
    double speed = 0;         // at least that of any point of the mover or movers, also beyond these two bodies
    bool first = true;        // false: any contact will do
};

// Free up to `free_until`; in contact at `shown`, NaN where the search gave up (unresolved).
struct MotionContact {
    double free_until = 1, shown = 1;
    bool found = false;

    // Whether this one, found after another, is of other faces than that: not that one with less proved free.
    bool replaces(const MotionContact& before) const {
        return found && (!before.found || (free_until < before.free_until && shown != before.shown));
    }
};

// Conservative advancement (X. Zhang et al., "Interactive continuous collision detection for non-convex
// polyhedra", 2006; M. Tang et al., "C2A", 2009), in two stages: whole trees against each other at the
// middle of a stretch of time, swept along their velocities; then each remaining pair of faces on its own.
// The stretch is halved where many pairs remain.
//
// Surfaces only, and free at t = lo: the caller has tested that, containment included. Searches up to
// t = contact.free_until, and stores an earlier contact there.
void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  MotionContact& contact);

}  // namespace fgenv
