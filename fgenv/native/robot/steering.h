// How a robot gets from one configuration to another where there is nothing in the way: legs, each straight.
#pragma once

#include "robot/robot.h"

namespace fgenv {

// straight: as `interpolate`. turn_drive_turn: turns on the spot, drives (backwards if that turns less),
// turns. dubins, reeds_shepp: the shortest way of a car, forwards only or both ways.
enum class Way : uint8_t { straight, turn_drive_turn, dubins, reeds_shepp };

struct Steering {
    Way way = Way::straight;
    double radius = 1;  // of a car's smallest circle, meters
    bool reverse = true;
};

// A stretch of a car's way: an arc to the left (1) or the right (-1), or straight (0).
struct CarPiece {
    int turn;
    double length;  // in radii; below 0 backwards
};

// The shortest way from the origin, heading along x, to (x, y), in radii, heading along `yaw`.
// L. Dubins, "On curves of minimal length", 1957; J. Reeds and L. Shepp, "Optimal paths for a car that goes
// both forwards and backwards", 1990.
std::vector<CarPiece> dubins(double x, double y, double yaw);
std::vector<CarPiece> reeds_shepp(double x, double y, double yaw);

// Configurations that are passed, row by row (nq each), q0 and q1 among them; from one to the next it goes
// straight. A car's arcs are cut into chords of a tenth of a radian at most. Joints move along all the way.
void legs(const Robot& robot, const Steering& steering, const double* q0, const double* q1, std::vector<double>& rows);

}  // namespace fgenv
