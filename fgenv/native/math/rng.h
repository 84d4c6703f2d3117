// Random numbers of one episode: the same on every machine, whichever thread draws them.
#pragma once

#include <cstdint>

namespace fgenv {

// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014).
class Rng {
public:
    Rng(uint64_t seed, uint64_t episode) : state_(mixed(mixed(seed) + episode)) {}

    double unit() {  // in [0, 1)
        state_ += 0x9e3779b97f4a7c15;
        return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
    }
    double between(double low, double high) { return low + (high - low) * unit(); }
    int64_t below(int64_t n) { return static_cast<int64_t>(unit() * static_cast<double>(n)); }

private:
    static uint64_t mixed(uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }

    uint64_t state_;
};

}  // namespace fgenv
