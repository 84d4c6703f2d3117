#include <algorithm>

#include "math/geometry.h"
#include "robot/car_path.h"

namespace fgenv {

double arc_cosine(double x) { return arc_tangent(std::sqrt(greater(0, (1 - x) * (1 + x))), x); }

double wrapped_positive(double angle) {
    const double r = angle - 2 * pi * std::floor(angle / (2 * pi));
    return r > 2 * pi - path_slack ? 0 : r;
}

double wrapped_symmetric(double angle) {
    const double r = wrapped_positive(angle);
    return r > pi ? r - 2 * pi : r;
}

void ShortestPath::offer(const CarPath& path) {
    double length = 0;
    for (const PathSegment& segment : path) length += std::fabs(segment.length);
    if (length >= length_) return;
    length_ = length;
    path_ = path;
}

CarPath ShortestPath::take() {
    const auto empty = [](const PathSegment& segment) { return segment.length == 0; };
    path_.erase(std::remove_if(path_.begin(), path_.end(), empty), path_.end());
    return std::move(path_);
}

namespace {

// Arc, line, arc: from the line between the centers of the two circles.
void offer_with_line(double x, double y, double yaw, ShortestPath& best) {
    const SineCosine end(yaw);
    for (const int first : {1, -1})
        for (const int last : {1, -1}) {
            const double cx = x - last * end.s, cy = y + last * end.c - first, d = std::hypot(cx, cy);
            const double direction = arc_tangent(cy, cx);
            double heading = direction, line = d;
            if (first != last) {
                if (d < 2 - path_slack) continue;
                line = std::sqrt(greater(0, d * d - 4));
                heading = direction + first * arc_tangent(2, line);
            }
            best.offer({{first, wrapped_positive(first * heading)},
                        {0, line},
                        {last, wrapped_positive(last * (yaw - heading))}});
        }
}

// Three arcs; the middle one turns the other way, half of it on either side of the line between the centers.
void offer_three_arcs(double x, double y, double yaw, ShortestPath& best) {
    const SineCosine end(yaw);
    for (const int turn : {1, -1}) {
        const double cx = x - turn * end.s, cy = y + turn * end.c - turn, d = std::hypot(cx, cy);
        if (d > 4) continue;
        const double direction = arc_tangent(cy, cx), middle = 2 * pi - arc_cosine(greater(-1, 1 - d * d / 8));
        for (const double arc : {middle, 2 * pi - middle}) {
            const double before = turn * direction + arc / 2;
            best.offer(
                {{turn, wrapped_positive(before)}, {-turn, arc}, {turn, wrapped_positive(turn * yaw - before + arc)}});
        }
    }
}

}  // namespace

CarPath dubins(double x, double y, double yaw) {
    ShortestPath best;
    offer_with_line(x, y, yaw, best);
    offer_three_arcs(x, y, yaw, best);
    return best.take();
}

}  // namespace fgenv
