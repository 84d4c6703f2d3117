#include "robot/mover.h"

namespace fgenv {

Frames frames_at(const Robot* robot, const Place& place) {
    Frames out{place.pose, {}};
    if (robot) {
        out.links.resize(robot->n_links());
        forward(*robot, place.q.data(), out.links.data());
    }
    return out;
}

std::pair<PartMotion, PartMotion> MoverMotion::beside(int32_t a, const Rigid* held_a, int32_t b,
                                                      const Rigid* held_b) const {
    const int32_t link = common_link(*robot_, a, b);
    std::unique_ptr<RobotMotion>& seen = seen_from_[link];
    if (!seen) {
        const std::vector<double> to = held_up_to(*robot_, link, from_->q, to_->q);
        seen = std::make_unique<RobotMotion>(*robot_, from_->q.data(), to.data());
    }
    return {LinkMotion(*seen, a, held_a), LinkMotion(*seen, b, held_b)};
}

Place between(const Robot* robot, const Place& from, const Place& to, double t) {
    if (!robot) return {RigidMotion(from.pose, to.pose).pose(t), {}};
    Place out{identity(), std::vector<double>(robot->nq())};
    interpolate(*robot, from.q.data(), to.q.data(), t, out.q.data());
    return out;
}

}  // namespace fgenv
