// Hears of the progress of a long build, and may end it by an exception.
#pragma once

#include <functional>

namespace fgenv {

// Called often with the share of the work that is done, 0 to 1, in increasing order. May be empty.
using BuildMonitor = std::function<void(double)>;

constexpr double mesh_share = 0.25, graph_share = 0.3;  // done after these steps

static inline void report(const BuildMonitor& monitor, double done) {
    if (monitor) monitor(done);
}

}  // namespace fgenv
