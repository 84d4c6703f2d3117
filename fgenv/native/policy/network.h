// A feed-forward network: layers of a matrix, an offset and an activation, in double precision.
#pragma once

#include <cstdint>
#include <vector>

namespace fgenv {

enum class Activation : uint8_t { none, tanh, relu };

struct Layer {
    int64_t inputs, outputs;
    std::vector<double> weights;  // (inputs, outputs)
    std::vector<double> offsets;  // (outputs)
    Activation activation;
};

struct Network {
    std::vector<Layer> layers;  // each takes what the one before gives

    int64_t inputs() const { return layers.front().inputs; }
    int64_t outputs() const { return layers.back().outputs; }
    // n rows of inputs to n rows of outputs. A sum begins with the offset and goes through the inputs in
    // their order, whatever is done at once: the same bits on every machine.
    void run(const double* rows, int64_t n, double* out) const;
};

}  // namespace fgenv
