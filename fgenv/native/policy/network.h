// A feed-forward network in double precision.
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
    std::vector<Layer> layers;  // a layer's inputs are the outputs of the layer before

    int64_t inputs() const { return layers.front().inputs; }
    int64_t outputs() const { return layers.back().outputs; }
    // Maps n rows of inputs to n rows of outputs. Sums begin with the offset and follow the order of the inputs,
    // whatever the vector width: the same bits on every machine.
    void run(const double* rows, int64_t n, double* out) const;
};

}  // namespace fgenv
