// Chooses the table of kernels once: the best that the processor has, or what FGENV_ISA names.
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "query/kernels.h"

namespace fgenv {

namespace baseline {
extern const Kernels table;
}
#if defined(__x86_64__)
namespace v3 {
extern const Kernels table;
}
#endif

namespace {

struct Choice {
    const char* name;
    const Kernels* table;
};

Choice choose() {
    const char* expected = std::getenv("FGENV_ISA");
    const std::string name = expected ? expected : "";
#if defined(__x86_64__)
    const bool has_v3 =
        __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    if (name == "v3" && !has_v3) throw std::runtime_error("FGENV_ISA=v3: this processor has no AVX2");
    if (name == "v3" || (name.empty() && has_v3)) return {"v3", &v3::table};
#endif
    if (name.empty() || name == "baseline") return {"baseline", &baseline::table};
    throw std::runtime_error("FGENV_ISA=" + name + ": unknown, give baseline or v3");
}

const Choice& choice() {
    static const Choice chosen = choose();
    return chosen;
}

}  // namespace

const Kernels& kernels() { return *choice().table; }
const char* kernels_name() { return choice().name; }

}  // namespace fgenv
