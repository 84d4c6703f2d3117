#include "bind/parallel.h"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace nb = nanobind;

namespace fgenv {
namespace {

constexpr auto signal_interval = std::chrono::milliseconds(20);

bool signal_raised() {
    nb::gil_scoped_acquire locked;
    return PyErr_CheckSignals() != 0;
}

}  // namespace

int thread_count(int threads) {
    if (threads > 0) return threads;
    if (const char* text = std::getenv("FGENV_THREADS"); text && *text) {
        char* end = nullptr;
        const long n = std::strtol(text, &end, 10);
        if (*end || n < 1 || n > 4096)
            throw nb::value_error(
                ("FGENV_THREADS: got " + std::string(text) + ", expected a number of threads from 1 to 4096").c_str());
        return static_cast<int>(n);
    }
    static const unsigned cores = std::thread::hardware_concurrency();  // cached: each call reads a file
    return cores ? static_cast<int>(cores) : 1;
}

void parallel_for(int64_t n, int threads, const std::function<void(int64_t, int64_t)>& body, int64_t chunk) {
    const int64_t chunks = (n + chunk - 1) / chunk;
    const int workers = static_cast<int>(std::min<int64_t>(thread_count(threads), chunks)) - 1;
    std::atomic<int64_t> next{0};
    std::atomic<bool> stop{false};
    std::exception_ptr failure;  // the first
    std::mutex failing;
    bool raised = false;
    {
        nb::gil_scoped_release released;
        const auto work = [&](bool hears_signals) {
            auto heard = std::chrono::steady_clock::now();
            for (int64_t i; !stop && (i = next++) < chunks;) {
                try {
                    body(i * chunk, std::min(n, (i + 1) * chunk));
                } catch (...) {
                    const std::lock_guard<std::mutex> guard(failing);
                    if (!failure) failure = std::current_exception();
                    stop = true;
                }
                if (!hears_signals) continue;
                const auto now = std::chrono::steady_clock::now();
                if (now - heard < signal_interval) continue;
                heard = now;
                if (signal_raised()) raised = stop = true;
            }
        };
        std::vector<std::thread> team;
        try {
            for (int i = 0; i < workers; ++i) team.emplace_back(work, false);
        } catch (const std::system_error&) {
            // No further threads are available: the started ones do the work.
        }
        work(true);
        for (std::thread& t : team) t.join();
    }
    if (raised) throw nb::python_error();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace fgenv
