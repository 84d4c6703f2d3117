// A mover along its motion, as a world's checks look at it.
#pragma once

#include "query/kernels.h"
#include "world/world.h"

namespace fgenv {

// One body along one motion.
struct World::Part {
    const Body* body;
    PartMotion motion;
    Box swept;  // margin and all
};

// A mover's parts along its motion.
struct World::Sweeping {
    const Body* robot = nullptr;
    MoverMotion motion;
    bool turns_in_itself = false;  // parts move against each other
    std::vector<Part> parts;
    Box around = empty_box();
    double speed = 0;  // of its fastest point, at most
};

}  // namespace fgenv
