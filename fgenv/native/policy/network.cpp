#include "policy/network.h"

#include <algorithm>

#include "math/exponential.h"

namespace fgenv {
namespace {

void activate(Activation activation, int64_t n, double* x) {
    if (activation == Activation::tanh)
        for (int64_t j = 0; j < n; ++j) x[j] = hyperbolic_tangent(x[j]);
    if (activation == Activation::relu)
        for (int64_t j = 0; j < n; ++j) x[j] = x[j] > 0 ? x[j] : 0.0;
}

// The inner loop runs over outputs, each with its own sum, so that it vectorizes without reordering.
void apply(const Layer& layer, const double* x, double* y) {
    std::copy(layer.offsets.begin(), layer.offsets.end(), y);
    for (int64_t k = 0; k < layer.inputs; ++k) {
        const double* const row = layer.weights.data() + k * layer.outputs;
        const double a = x[k];
        for (int64_t j = 0; j < layer.outputs; ++j) y[j] += a * row[j];
    }
    activate(layer.activation, layer.outputs, y);
}

}  // namespace

void Network::run(const double* rows, int64_t n, double* out) const {
    int64_t widest = 0;
    for (const Layer& layer : layers) widest = std::max(widest, layer.outputs);
    std::vector<double> from(widest), to(widest);
    for (int64_t i = 0; i < n; ++i) {
        const double* x = rows + i * inputs();
        for (const Layer& layer : layers) {
            apply(layer, x, to.data());
            std::swap(from, to);
            x = from.data();
        }
        std::copy(x, x + outputs(), out + i * outputs());
    }
}

}  // namespace fgenv
