#include "bind/arrays.h"

#include <cmath>

namespace fgenv {
namespace {

constexpr double rigid_tolerance = 1e-5;  // accepts float32 poses, rejects a scale of 1.001

[[noreturn]] void bad_value(const std::string& text) { throw nb::value_error(text.c_str()); }
[[noreturn]] void bad_type(const std::string& text) { throw nb::type_error(text.c_str()); }

template <class T>
Array<T> wrap(nb::ndarray<const T, nb::c_contig, nb::device::cpu> view) {
    Dims dims(view.ndim());
    for (size_t i = 0; i < view.ndim(); ++i) dims[i] = static_cast<int64_t>(view.shape(i));
    return {view, dims};
}

// Converts with NumPy; `kinds` are the accepted dtype kinds.
template <class T>
Array<T> through_numpy(nb::handle value, const char* name, const char* kinds, const char* dtype) {
    const nb::module_ numpy = nb::module_::import_("numpy");
    nb::object array;
    try {
        array = numpy.attr("asarray")(value);
    } catch (nb::python_error& e) {
        if (!e.matches(PyExc_ValueError) && !e.matches(PyExc_TypeError)) throw;
        bad_value(std::string(name) + ": got rows of different lengths, expected an array of numbers");
    }
    const std::string kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
    const bool empty = nb::cast<int64_t>(array.attr("size")) == 0;
    if (std::string(kinds).find(kind) == std::string::npos && !(empty && kind == "f"))
        bad_type(std::string(name) + ": got dtype " + nb::cast<std::string>(array.attr("dtype").attr("name")) +
                 ", expected " + dtype);
    array = numpy.attr("ascontiguousarray")(array, numpy.attr(dtype)).attr("reshape")(array.attr("shape"));
    return wrap(nb::cast<nb::ndarray<const T, nb::c_contig, nb::device::cpu>>(array));
}

// Largest deviation of the columns from orthonormal.
double skewness(const double* m) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) {
            const double d = m[i] * m[j] + m[4 + i] * m[4 + j] + m[8 + i] * m[8 + j] - (i == j);
            worst = std::fabs(d) <= worst ? worst : std::fabs(d);  // keeps NaN
        }
    return worst;
}

double determinant(const double* m) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

constexpr double farthest = 1e12;  // meters

bool is_rigid(const double* m) {
    return std::fabs(m[3]) <= farthest && std::fabs(m[7]) <= farthest && std::fabs(m[11]) <= farthest && m[12] == 0 &&
           m[13] == 0 && m[14] == 0 && m[15] == 1 && skewness(m) <= rigid_tolerance && determinant(m) > 0;
}

// Describes the fault of a pose that is not rigid.
const char* fault(const double* m, double& value) {
    for (int i = 0; i < 16; ++i)
        if (!std::isfinite(m[i])) return value = m[i], "an entry that is not finite";
    if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) return value = m[15], "a last row other than 0 0 0 1";
    for (int i = 3; i < 12; i += 4)
        if (std::fabs(m[i]) > farthest) return value = m[i], "a position over 1e12 m from the origin";
    value = determinant(m);
    if (skewness(m) <= rigid_tolerance) return "a mirrored matrix";
    return std::fabs(value) < 1e-9 ? "a singular matrix" : "a scaled or sheared matrix";
}

}  // namespace

std::string to_string(const Dims& dims) {
    std::string text = "(";
    for (size_t i = 0; i < dims.size(); ++i) text += (i ? ", " : "") + std::to_string(dims[i]);
    return text + (dims.size() == 1 ? ",)" : ")");
}

std::string index_text(const Dims& dims, int64_t flat) {
    if (dims.empty()) return "";
    std::string text;
    for (size_t i = dims.size(); i-- > 0; flat /= dims[i])
        text = std::to_string(flat % dims[i]) + (text.empty() ? "" : ", ") + text;
    return "[" + text + "]";
}

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

Array<double> doubles(nb::handle value, const char* name) {
    nb::ndarray<const double, nb::c_contig, nb::device::cpu> view;
    if (nb::try_cast(value, view, false)) return wrap(view);
    return through_numpy<double>(value, name, "fiu", "float64");
}

Array<int64_t> indices(nb::handle value, const char* name) {
    return through_numpy<int64_t>(value, name, "iu", "int64");
}

Array<double> points(nb::handle value, const char* name) {
    Array<double> array = doubles(value, name);
    if (array.dims.empty() || array.dims.back() != 3)
        bad_value(std::string(name) + ": got shape " + to_string(array.dims) + ", expected (..., 3)");
    Dims rows = array.dims;
    rows.pop_back();
    for (size_t i = 0; i < array.view.size(); ++i)
        if (!std::isfinite(array.data()[i]))
            bad_value(std::string(name) + index_text(array.dims, static_cast<int64_t>(i)) + ": got " +
                      number(array.data()[i]) + ", expected finite coordinates");
    return array;
}

Poses poses(nb::handle value, const char* name) {
    Poses out{doubles(value, name), {}};
    const Array<double>& array = out.array;
    const size_t n = array.dims.size();
    if (n < 2 || array.dims[n - 1] != 4 || array.dims[n - 2] != 4)
        bad_value(std::string(name) + ": got shape " + to_string(array.dims) +
                  ", expected homogeneous poses (..., 4, 4)");
    out.dims.assign(array.dims.begin(), array.dims.end() - 2);
    for (size_t i = 0; i < out.size(); ++i) {
        const double* m = array.data() + 16 * i;
        if (is_rigid(m)) continue;
        double found = 0;
        const char* text = fault(m, found);
        bad_value(std::string(name) + index_text(out.dims, static_cast<int64_t>(i)) + ": got " + text + " (" +
                  number(found) + "), expected a rigid motion; scale a shape with Shape.load(scale=)");
    }
    return out;
}

Broadcast broadcast(std::initializer_list<std::pair<const char*, Dims>> operands) {
    Broadcast out;
    for (const auto& [name, dims] : operands) {
        const size_t n = std::max(out.dims.size(), dims.size());
        out.dims.insert(out.dims.begin(), n - out.dims.size(), 1);
        for (size_t i = 0; i < dims.size(); ++i) {
            int64_t& d = out.dims[n - dims.size() + i];
            if (d != dims[i] && d != 1 && dims[i] != 1) {
                std::string text;
                for (const auto& [other, shape] : operands)
                    text += (text.empty() ? "" : ", ") + std::string(other) + " " + to_string(shape);
                bad_value("shapes: got " + text + ", expected leading dimensions that broadcast");
            }
            if (d == 1) d = dims[i];
        }
    }
    for (int64_t d : out.dims) out.size *= d;
    for (const auto& [name, dims] : operands) {
        Dims stride(out.dims.size(), 0);
        int64_t step = 1;
        for (size_t i = dims.size(); i-- > 0; step *= dims[i])
            if (dims[i] != 1) stride[out.dims.size() - dims.size() + i] = step;
        out.strides.push_back(stride);
    }
    return out;
}

}  // namespace fgenv
