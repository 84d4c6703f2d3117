// Straight motions of a robot and its links from one configuration to another.
#pragma once

#include <array>
#include <vector>

#include "robot/chain_bound.h"
#include "robot/robot.h"

namespace fgenv {

// The motions of all links. The robot must outlive its motions. Not thread-safe.
class RobotMotion {
public:
    RobotMotion(const Robot& robot, const double* q0, const double* q1);

    // Pose at fraction s, in [0, 1]: bit for bit that of `forward` at `interpolate(s)`.
    Rigid pose(int32_t link, double s) const;
    Rigid pose(int32_t link, double s, Velocity& velocity) const;
    // Acceleration bound of a frame that is fixed in the link.
    Acceleration acceleration(int32_t link, const Rigid& offset) const;
    double turn(int32_t link) const { return links_[link].chain.turn(); }

private:
    struct Link {
        bool still;        // in the world
        Rigid at;          // pose in the world, if still; else in the last link that a joint moves
        ChainBound chain;  // of that link
    };

    // All links at a fraction that every pair of parts is checked at: computed once.
    struct Snapshot {
        std::vector<Rigid> poses;
        std::vector<Velocity> velocities;
    };
    const Snapshot* snapshot(double s) const;
    Rigid chain(int32_t link, double s, Velocity& velocity) const;
    Rigid next(int32_t link, double s, const Rigid& parent, Velocity& velocity) const;

    bool moves(const Joint& joint) const;
    double change_of(const Joint& joint, int32_t k) const;
    Rigid carry(const Joint& joint, const Rigid& held, double s) const;
    void bound(const Joint& joint, const Rigid& held, Link& link) const;

    const Robot* robot_;
    std::vector<double> q0_, q1_;
    Slerp slerp_;  // of a free base
    std::vector<Link> links_;
    mutable std::array<Snapshot, 3> snapshots_;  // at 0, 0.5 and 1
};

// The motion of one link, or of a body held at `offset` in its frame; the RobotMotion must outlive it.
class LinkMotion final : public BodyMotion {
public:
    LinkMotion(const RobotMotion& robot, int32_t link, const Rigid* offset = nullptr);
    // The same motion as a function of t' with t = begin + rate t'.
    LinkMotion retimed(double begin, double rate) const;

    Rigid pose(double t) const override;
    Velocity velocity(double t) const override;
    Rigid pose(double t, Velocity& velocity) const override;
    Acceleration acceleration() const override { return acceleration_; }
    double turn() const override { return rate_ * robot_->turn(link_); }

private:
    double fraction(double t) const { return lesser(greater(begin_ + rate_ * t, 0), 1); }

    const RobotMotion* robot_;
    int32_t link_;
    Rigid offset_;
    bool has_offset_;
    double begin_ = 0, rate_ = 1;
    Acceleration acceleration_;
};

}  // namespace fgenv
