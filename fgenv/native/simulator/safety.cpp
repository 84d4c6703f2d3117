// The look-ahead: steps in a copy of a world.
#include <algorithm>

#include "simulator/simulator.h"

namespace fgenv {

std::vector<bool> Simulator::would_collide(int32_t e, const double* actions) const {
    Episode ahead(*episodes_[e]);
    move(ahead, actions);
    std::vector<bool> out;
    for (const RobotState& robot : ahead.robots) out.push_back(robot.hit >= 0);
    return out;
}

// A robot that stops may be hit by those behind it, hence the rounds: after as many as there are robots all stop.
void Simulator::make_safe(int32_t e, const double* rest, double* actions) const {
    const Episode& episode = *episodes_[e];
    Episode ahead(episode);
    std::vector<bool> stopped(n_robots());
    for (int32_t round = 0; round < n_robots(); ++round) {
        move(ahead, actions);
        bool changed = false;
        for (int32_t i = 0; i < n_robots(); ++i) {
            if (ahead.robots[i].hit < 0 || stopped[i]) continue;
            std::copy_n(rest + i * action_size_, action_size_, actions + i * action_size_);
            stopped[i] = changed = true;
        }
        if (!changed) return;
        rewind(ahead, episode);
    }
}

void Simulator::rewind(Episode& ahead, const Episode& episode) const {
    ahead.robots = episode.robots;
    for (int32_t i = 0; i < n_robots(); ++i)
        if (episode.robots[i].status == Status::moving)
            ahead.world.set_configuration(specs_[i].id, episode.robots[i].q);
}

}  // namespace fgenv
