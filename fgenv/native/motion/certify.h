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
struct Contact {
    double free_until = 1, shown = 1;
    bool found = false;

    // Whether this one, found after another, is of other faces than that: not that one with less proved free.
    bool replaces(const Contact& before) const {
        return found && (!before.found || (free_until < before.free_until && shown != before.shown));
    }
};

// Conservative advancement (X. Zhang et al., "Interactive continuous collision detection for non-convex
// polyhedra", 2006; M. Tang et al., "C2A", 2009), in two stages: whole trees against each other at the
// middle of a stretch of time, swept along their velocities; what is left, pairs of faces each on its own.
// The stretch is halved where much is left.
//
// Surfaces only, and free at t = lo: whoever calls has asked that, containment included. Looks no farther
// than t = contact.free_until, and leaves there the earlier contact that it finds. Counts in `sweeps` the
// times that two trees were walked.
void find_contact(const Moving& a, const Moving& b, double lo, double hi, const CertifySettings& settings,
                  Contact& contact, int64_t& sweeps);

}  // namespace fgenv
