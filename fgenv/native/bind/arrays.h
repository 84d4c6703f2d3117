// The boundary between NumPy and the core. Shape, dtype and finiteness of every argument are checked here;
// errors have the form `name: got X, expected Y; remedy`.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <string>
#include <vector>

#include "math/geometry.h"

namespace fgenv {

namespace nb = nanobind;

using Dims = std::vector<int64_t>;

std::string to_string(const Dims& dims);
std::string index_text(const Dims& dims, int64_t flat);  // "[i, j]"; empty for a single value
std::string number(double x);

// A C-contiguous array of doubles or of 64-bit indices, kept alive.
template <class T>
struct Array {
    nb::ndarray<const T, nb::c_contig, nb::device::cpu> view;
    Dims dims;
    const T* data() const { return view.data(); }
};

// Converts real numbers of any type and nesting to doubles; complex numbers, text and objects raise TypeError.
Array<double> doubles(nb::handle value, const char* name);
// Integers only.
Array<int64_t> indices(nb::handle value, const char* name);

// Rows of three finite coordinates: (..., 3).
Array<double> points(nb::handle value, const char* name);

// Rigid motions (..., 4, 4): finite, last row 0 0 0 1, orthonormal to 1e-5, right-handed.
struct Poses {
    Array<double> array;
    Dims dims;  // without the last two

    size_t size() const { return array.view.size() / 16; }
    bool single() const { return dims.empty(); }
    Rigid operator[](int64_t i) const {
        Rigid out;
        const double* m = array.data() + 16 * i;
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) out.r[r][c] = m[4 * r + c];
            out.t[r] = m[4 * r + 3];
        }
        return out;
    }
    std::vector<Rigid> all() const {
        std::vector<Rigid> out;
        for (size_t i = 0; i < size(); ++i) out.push_back((*this)[static_cast<int64_t>(i)]);
        return out;
    }
};
Poses poses(nb::handle value, const char* name);

// Writes a pose into an array (..., 4, 4).
static inline void write_pose(const Rigid& pose, double* m) {
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) m[4 * r + c] = pose.r[r][c];
        m[4 * r + 3] = pose.t[r];
    }
    m[12] = m[13] = m[14] = 0;
    m[15] = 1;
}

// Broadcast of leading dimensions with NumPy's rules.
struct Broadcast {
    Dims dims;
    int64_t size = 1;
    std::vector<Dims> strides;  // per operand and dimension, 0 where it is repeated

    int64_t offset(size_t operand, int64_t flat) const {
        const Dims& stride = strides[operand];
        if (dims.size() == 1) return flat * stride[0];
        int64_t out = 0;
        for (size_t i = dims.size(); i-- > 0; flat /= dims[i]) out += flat % dims[i] * stride[i];
        return out;
    }
};
Broadcast broadcast(std::initializer_list<std::pair<const char*, Dims>> operands);

// A fresh NumPy array that owns its memory.
template <class T>
struct Output {
    T* data;
    nb::ndarray<nb::numpy, T> array;
};

template <class T>
Output<T> make_output(const Dims& dims, std::initializer_list<int64_t> tail = {}) {
    std::vector<size_t> shape(dims.begin(), dims.end());
    shape.insert(shape.end(), tail.begin(), tail.end());
    size_t n = 1;
    for (size_t d : shape) n *= d;
    T* data = new T[n ? n : 1]();
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return {data, nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), owner)};
}

template <class T>
nb::object copy_out(const T* from, const Dims& dims, std::initializer_list<int64_t> tail = {}) {
    Output<T> out = make_output<T>(dims, tail);
    size_t n = 1;
    for (size_t i = 0; i < out.array.ndim(); ++i) n *= out.array.shape(i);
    std::copy(from, from + n, out.data);
    return nb::cast(out.array);
}

}  // namespace fgenv
