// How a link moves while its robot goes straight from one configuration to another.
#pragma once

#include <vector>

#include "motion.h"
#include "robot.h"

namespace fgenv {

// pose(t) is, bit for bit, where `forward` puts the link at `interpolate(t)`; then the offset, if any.
class LinkMotion final : public BodyMotion {
public:
    // The robot and the configurations outlive this.
    LinkMotion(const Robot& robot, int32_t link, const double* q0, const double* q1, const Rigid* offset = nullptr);
    // The same motion as seen by t' with t = begin + rate t'.
    LinkMotion retimed(double begin, double rate) const;

    Rigid pose(double t) const override;
    Velocity velocity(double t) const override;
    Acceleration acceleration() const override { return acceleration_; }
    double turn() const override { return rate_ * turn_; }

private:
    double fraction(double t) const { return lesser(greater(begin_ + rate_ * t, 0), 1); }
    bool moves(const Joint& joint) const;
    Rigid frame(const Joint& joint, const Rigid& parent) const;
    Rigid carry(const Joint& joint, const Rigid& parent, double s) const;
    double change_of(const Joint& joint, int32_t k) const;
    void bound();

    const Robot* robot_;
    const double *q0_, *q1_;
    Slerp slerp_;                       // of a free base
    Rigid start_;                       // of the link before the first joint that moves
    std::vector<const Joint*> joints_;  // from the first one that moves to the link
    Rigid offset_;
    bool has_offset_;
    double begin_ = 0, rate_ = 1, turn_ = 0;
    Acceleration acceleration_;
};

}  // namespace fgenv
