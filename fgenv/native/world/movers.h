// Movers at one place or along one motion, prepared for collision checks.
#pragma once

#include <span>

#include "query/kernels.h"
#include "world/world.h"

namespace fgenv {

// A body of a mover at one place.
struct PlacedPart {
    const Body* body;
    Rigid pose;
    Box box;  // margin included
};

// A body of a mover along one motion.
struct SweptPart {
    const Body* body;
    PartMotion motion;
    Box box;  // of the whole motion, margin included
};

struct PlacedMover {
    using Part = PlacedPart;
    const Body* robot;
    std::vector<PlacedPart> parts;  // in the order of robot->parts
    Box around = empty_box();

    const OwnPairs& own_pairs() const { return robot->own_pairs; }
    const Box& own_box(int32_t i) const { return parts[i].box; }
};

struct SweptMover {
    using Part = SweptPart;
    const Body* robot = nullptr;
    MoverMotion motion;
    bool bends = false;  // joints move, hence parts move relative to each other
    std::vector<SweptPart> parts;
    Box around = empty_box();
    double speed = 0;  // upper bound over all points

    const OwnPairs& own_pairs() const {
        static const OwnPairs none;
        return bends ? robot->own_pairs : none;
    }
    const Box& own_box(int32_t i) const { return parts[i].box; }
};

// A swept mover at one fraction of its motion.
struct InstantMover {
    using Part = PlacedPart;
    const SweptMover& swept;
    const Body* robot;
    std::vector<PlacedPart> parts;
    const Box& around;

    const OwnPairs& own_pairs() const { return robot->own_pairs; }
    const Box& own_box(int32_t i) const { return swept.parts[i].box; }
};

}  // namespace fgenv
