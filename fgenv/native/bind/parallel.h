// Runs independent queries on several threads, without the interpreter's lock and with checks for Ctrl-C.
#pragma once

#include <cstdint>
#include <functional>

namespace fgenv {

// `threads` <= 0: the environment variable FGENV_THREADS, else all cores. Throws on a bad value.
int thread_count(int threads);

// Calls body(first, last) over [0, n) in chunks (microseconds to milliseconds of work between checks for
// Ctrl-C), on any thread, in any order: results must not depend on it. The caller holds the interpreter's lock, which is released meanwhile. Throws nanobind's
// python_error if a signal handler raised (KeyboardInterrupt); chunks not begun are then left out.
void parallel_for(int64_t n, int threads, const std::function<void(int64_t, int64_t)>& body, int64_t chunk = 64);

}  // namespace fgenv
