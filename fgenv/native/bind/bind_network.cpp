// Python class of a feed-forward network.
#include "bind/bind.h"

#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bind/arguments.h"
#include "bind/parallel.h"
#include "policy/network.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr int64_t most = 1 << 20;  // width of a layer
constexpr int64_t chunk = 16;      // rows

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

std::vector<double> finite(const Array<double>& a, const std::string& name) {
    for (size_t i = 0; i < a.view.size(); ++i)
        if (!std::isfinite(a.data()[i]))
            fail(name + index_text(a.dims, static_cast<int64_t>(i)) + ": got " + number(a.data()[i]) +
                 ", expected a finite number");
    return {a.data(), a.data() + a.view.size()};
}

Activation activation_of(const std::string& name) {
    if (name == "tanh") return Activation::tanh;
    if (name == "relu") return Activation::relu;
    if (name == "none") return Activation::none;
    fail("activation: got '" + name + "', expected tanh, relu or none");
}

// Weights (inputs, outputs), offsets (outputs,), activation.
Layer layer_of(nb::handle weights, nb::handle offsets, const std::string& activation, const std::string& name) {
    const Array<double> w = doubles(weights, "weights"), b = doubles(offsets, "offsets");
    if (w.dims.size() != 2 || w.dims[0] < 1 || w.dims[1] < 1 || w.dims[0] > most || w.dims[1] > most)
        fail(name + ": got weights of shape " + to_string(w.dims) + ", expected (inputs, outputs)");
    if (b.dims != Dims{w.dims[1]})
        fail(name + ": got offsets of shape " + to_string(b.dims) + ", expected " + to_string({w.dims[1]}));
    return {w.dims[0], w.dims[1], finite(w, name + ": weights"), finite(b, name + ": offsets"),
            activation_of(activation)};
}

void make_network(Network* self, nb::sequence layers) {
    Network network;
    for (nb::handle item : layers) {
        const auto [w, b, activation] = nb::cast<std::tuple<nb::object, nb::object, std::string>>(item);
        const std::string name = "layers[" + std::to_string(network.layers.size()) + "]";
        network.layers.push_back(layer_of(w, b, activation, name));
        if (network.layers.size() < 2) continue;
        const int64_t before = network.layers[network.layers.size() - 2].outputs, inputs = network.layers.back().inputs;
        if (inputs != before)
            fail(name + ": got " + std::to_string(inputs) + " inputs, expected the " + std::to_string(before) +
                 " outputs of the layer before");
    }
    if (network.layers.empty()) fail("layers: got none, expected at least one");
    new (self) Network(std::move(network));
}

nb::object run(const Network& network, nb::handle rows, nb::handle threads) {
    const Array<double> x = doubles(rows, "rows");
    if (x.dims.empty() || x.dims.back() != network.inputs())
        fail("rows: got shape " + to_string(x.dims) + ", expected (..., " + std::to_string(network.inputs()) + ")");
    const int n_threads = threads_of(threads);
    finite(x, "rows");
    const Dims dims = rows_of(x);
    Output<double> out = make_output<double>(dims, {network.outputs()});
    const int64_t n = static_cast<int64_t>(x.view.size()) / network.inputs();
    parallel_for(
        n, n_threads,
        [&](int64_t first, int64_t last) {
            network.run(x.data() + first * network.inputs(), last - first, out.data + first * network.outputs());
        },
        chunk);
    return nb::cast(out.array);
}

}  // namespace

void bind_network(nb::module_& m) {
    nb::class_<Network>(m, "Network")
        .def("__init__", &make_network, "layers"_a)
        .def("run", &run, "rows"_a.none(), "threads"_a.none())
        .def_prop_ro("inputs", [](const Network& n) { return n.inputs(); })
        .def_prop_ro("outputs", [](const Network& n) { return n.outputs(); });
}

}  // namespace fgenv
