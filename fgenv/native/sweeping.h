// A mover along its motion, as a world's checks look at it.
#pragma once

#include "kernels.h"
#include "world.h"

namespace fgenv {

static inline bool hits(const Shape& a, const Rigid& ta, const Shape& b, const Rigid& tb, double margin) {
    const Rigid pose = relative(ta, tb);
    if (kernels().collide(a, b, pose, true, nullptr)) return true;
    return margin > 0 && kernels().nearest(a, b, pose, margin * margin, true).face_a >= 0;
}

// One body along one motion.
struct World::Part {
    const Body* body;
    PartMotion motion;
    Box swept;  // margin and all
};

// A mover's parts along its motion.
struct World::Sweeping {
    const Body* robot;
    MoverMotion motion;
    bool turns_in_itself;  // parts move against each other
    std::vector<Part> parts;
    Box around = empty_box();
    double speed = 0;  // of its fastest point, at most
};

}  // namespace fgenv
