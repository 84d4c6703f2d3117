// Constants that several folders share.
#pragma once

namespace fgenv {

constexpr double pi = 3.14159265358979323846;
constexpr double orthonormality = 1.0001;  // factor on lengths: poses may be off orthonormal by 1e-5

}  // namespace fgenv
