#include "mover.h"

namespace fgenv {

Frames frames_at(const Robot* robot, const Place& place) {
    Frames out{place.pose, {}};
    if (robot) {
        out.links.resize(robot->n_links());
        forward(*robot, place.q.data(), out.links.data());
    }
    return out;
}

Place between(const Robot* robot, const Place& from, const Place& to, double t) {
    if (!robot) return {RigidMotion(from.pose, to.pose).pose(t), {}};
    Place out{identity(), std::vector<double>(robot->nq())};
    interpolate(*robot, from.q.data(), to.q.data(), t, out.q.data());
    return out;
}

}  // namespace fgenv
