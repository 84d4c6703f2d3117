// What moves as one: a body with all that it carries, or a robot, which is a kinematic tree.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <variant>

#include "robot/link_motion.h"

namespace fgenv {

// Where a mover is: the pose of a body, or a robot's configuration.
struct Place {
    Rigid pose = identity();
    std::vector<double> q;
};

// Frames that a mover's parts are held in: the body's own, or one for each link of the robot.
struct Frames {
    Rigid body = identity();
    std::vector<Rigid> links;

    const Rigid& operator[](int32_t link) const { return links.empty() ? body : links[link]; }
};

// `robot` is null for a body, here and below.
Frames frames_at(const Robot* robot, const Place& place);
Place between(const Robot* robot, const Place& from, const Place& to, double t);

// Of one part.
class PartMotion {
public:
    PartMotion(const RigidMotion& motion) : motion_(motion) {}
    PartMotion(const LinkMotion& motion) : motion_(motion) {}

    const BodyMotion& operator*() const {
        if (const auto* rigid = std::get_if<RigidMotion>(&motion_)) return *rigid;
        return std::get<LinkMotion>(motion_);
    }
    const BodyMotion* operator->() const { return &**this; }
    // The same motion as seen by t' with t = begin + rate t'.
    PartMotion retimed(double begin, double rate) const {
        return std::visit([&](const auto& m) { return PartMotion(m.retimed(begin, rate)); }, motion_);
    }

private:
    std::variant<RigidMotion, LinkMotion> motion_;
};

// From place to place, both of which it refers to; outlives the motions of its parts. Not for several threads.
class MoverMotion {
public:
    MoverMotion() = default;
    MoverMotion(const Robot* robot, const Place& from, const Place& to)
        : robot_(robot),
          from_(&from),
          to_(&to),
          tree_(robot ? std::make_unique<RobotMotion>(*robot, from.q.data(), to.q.data()) : nullptr) {}

    // Held in the frame of `link` at `offset`; null: the body itself.
    PartMotion part(int32_t link, const Rigid* offset) const {
        if (tree_) return LinkMotion(*tree_, link, offset);
        return RigidMotion(from_->pose, to_->pose, offset);
    }

    // The same of two parts of a robot as seen from the last link that carries both: they are to each other as in
    // the world, and move less.
    std::pair<PartMotion, PartMotion> beside(int32_t a, const Rigid* held_a, int32_t b, const Rigid* held_b) const;

private:
    const Robot* robot_ = nullptr;
    const Place *from_ = nullptr, *to_ = nullptr;
    std::unique_ptr<RobotMotion> tree_;
    mutable std::map<int32_t, std::unique_ptr<RobotMotion>> seen_from_;  // by that link
};

}  // namespace fgenv
