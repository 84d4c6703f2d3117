// Rows of observations: parts in a fixed order, see ObservationSettings.
#pragma once

#include <string>
#include <vector>

#include "simulator/episode.h"
#include "simulator/robot_spec.h"
#include "simulator/settings.h"

namespace fgenv {

// A part of a robot's row.
struct Slice {
    std::string name;
    int32_t begin, size;
};

class Observer {
public:
    Observer(const std::vector<RobotSpec>& specs, const ObservationSettings& settings);

    std::vector<Slice> slices(int32_t i) const;
    int32_t size() const { return size_; }                  // of the longest row
    void write(const Episode& episode, float* rows) const;  // (robots, size())

private:
    struct BaseMotions;

    int32_t neighbor_size() const;
    void write_goal(const RobotSpec& spec, const RobotState& state, float*& out) const;
    void write_path_hint(const RobotSpec& spec, const RobotState& state, float*& out) const;
    void write_neighbors(const Episode& episode, int32_t i, const BaseMotions& bases, float*& out) const;
    void write_nearest(const Episode& episode, int32_t i, int32_t first, int32_t last, const BaseMotions& bases,
                       float*& out) const;
    void write_neighbor(const Episode& episode, int32_t i, int32_t j, double distance, const BaseMotions& bases,
                        float*& out) const;
    void write_lidar(const Episode& episode, int32_t i, const Rigid& base, float*& out) const;

    const std::vector<RobotSpec>& specs_;
    ObservationSettings settings_;
    bool planar_ = true;  // all bases are planar
    int32_t size_ = 0;
};

}  // namespace fgenv
