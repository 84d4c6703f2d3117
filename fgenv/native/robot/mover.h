// Movers: a body with the bodies that it carries, or a robot, which is a kinematic tree.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <variant>

#include "robot/link_motion.h"

namespace fgenv {

// State of a mover: the pose of a body, or a robot's configuration.
struct Place {
    Rigid pose = identity();
    std::vector<double> q;
};

// Frames that a mover's parts are fixed in: the body's own, or one per link of the robot.
struct Frames {
    Rigid body = identity();
    std::vector<Rigid> links;

    const Rigid& operator[](int32_t link) const { return links.empty() ? body : links[link]; }
};

// `robot` is null for a body, here and below.
Frames frames_at(const Robot* robot, const Place& place);
Place between(const Robot* robot, const Place& from, const Place& to, double t);

// Motion of one part.
class PartMotion {
public:
    PartMotion(const RigidMotion& motion) : motion_(motion) {}
    PartMotion(const LinkMotion& motion) : motion_(motion) {}

    const BodyMotion& operator*() const {
        if (const auto* rigid = std::get_if<RigidMotion>(&motion_)) return *rigid;
        return std::get<LinkMotion>(motion_);
    }
    const BodyMotion* operator->() const { return &**this; }
    // The same motion as a function of t' with t = begin + rate t'.
    PartMotion retimed(double begin, double rate) const {
        return std::visit([&](const auto& m) { return PartMotion(m.retimed(begin, rate)); }, motion_);
    }

private:
    std::variant<RigidMotion, LinkMotion> motion_;
};

// Motion between two places, to which it refers; must outlive the motions of its parts. Not thread-safe.
class MoverMotion {
public:
    MoverMotion() = default;
    MoverMotion(const Robot* robot, const Place& from, const Place& to)
        : robot_(robot),
          from_(&from),
          to_(&to),
          tree_(robot ? std::make_unique<RobotMotion>(*robot, from.q.data(), to.q.data()) : nullptr) {}

    // The part at `offset` in the frame of `link`; null: the body itself.
    PartMotion part(int32_t link, const Rigid* offset) const {
        if (tree_) return LinkMotion(*tree_, link, offset);
        return RigidMotion(from_->pose, to_->pose, offset);
    }

    // Motions of two parts of a robot relative to the last link that carries both: with the same relative motion
    // as in the world, and less motion of each.
    std::pair<PartMotion, PartMotion> beside(int32_t a, const Rigid* held_a, int32_t b, const Rigid* held_b) const;

private:
    const Robot* robot_ = nullptr;
    const Place *from_ = nullptr, *to_ = nullptr;
    std::unique_ptr<RobotMotion> tree_;
    mutable std::map<int32_t, std::unique_ptr<RobotMotion>> seen_from_;  // by that link
};

}  // namespace fgenv
