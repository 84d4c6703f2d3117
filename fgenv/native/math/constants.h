#pragma once

namespace fgenv {

constexpr double pi = 3.14159265358979323846;

}  // namespace fgenv
