// A small replacement of libFuzzer for compilers without it, with its arguments: -max_total_time=SECONDS, -seed=N, a
// folder to start from and to keep what is found in, or files to run again. Mutations are seeded; an
// input that reaches code that none before it reached is kept and mutated in its turn. GCC's
// -fsanitize-coverage=trace-pc reports the code that is reached. This file is compiled without it.
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

// Every fault ends in SIGABRT, so that the input can be written down.
extern "C" const char* __asan_default_options() { return "abort_on_error=1:handle_abort=0:detect_leaks=0"; }
extern "C" const char* __ubsan_default_options() { return "abort_on_error=1:print_stacktrace=1"; }

namespace {

using Input = std::vector<uint8_t>;

constexpr size_t longest = 1024;

uint8_t reached[1 << 20];  // by a hash of the place in the code
size_t places = 0;
Input current;

Input read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return Input(std::istreambuf_iterator<char>(file), {});
}

std::string keep(const std::string& folder, const char* what, const Input& input) {
    uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (uint8_t byte : input) hash = (hash ^ byte) * 1099511628211ull;
    char name[40];
    std::snprintf(name, sizeof name, "%s%016llx", what, static_cast<unsigned long long>(hash));
    const std::string path = folder.empty() ? name : folder + "/" + name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
    return path;
}

void on_abort(int) {
    std::fprintf(stderr, "input kept as %s\n", keep("", "crash-", current).c_str());
    std::signal(SIGABRT, SIG_DFL);
    std::raise(SIGABRT);
}

// Whether an input reached new code.
bool run(const Input& input) {
    const size_t before = places;
    current = input;
    LLVMFuzzerTestOneInput(current.data(), current.size());
    return places > before;
}

Input mutated(const std::vector<Input>& corpus, std::mt19937_64& random) {
    const auto below = [&](size_t n) { return static_cast<size_t>(random() % n); };
    Input out = corpus[below(corpus.size())];
    for (size_t changes = 1 + below(6); changes; --changes) {
        const size_t at = out.empty() ? 0 : below(out.size());
        const auto here = out.begin() + static_cast<std::ptrdiff_t>(at);
        switch (out.empty() ? 2 : below(6)) {
            case 0: *here = static_cast<uint8_t>(random()); break;
            case 1: *here = static_cast<uint8_t>(*here ^ 1 << below(8)); break;
            case 2: out.insert(here, static_cast<uint8_t>(random())); break;
            case 3: out.erase(here); break;
            case 4: *here = out[below(out.size())]; break;
            default: {  // append the end of another input
                const Input& other = corpus[below(corpus.size())];
                out.resize(at);
                if (at < other.size())
                    out.insert(out.end(), other.begin() + static_cast<std::ptrdiff_t>(at), other.end());
            }
        }
    }
    if (out.size() > longest) out.resize(longest);
    return out;
}

}  // namespace

extern "C" void __sanitizer_cov_trace_pc() {
    const auto place = reinterpret_cast<uintptr_t>(__builtin_return_address(0));
    uint8_t& seen = reached[place * 0x9E3779B97F4A7C15ull >> 44];
    places += !seen;
    seen = 1;
}

int main(int count, char** arguments) {
    double seconds = 10;
    uint64_t seed = 0;
    std::string folder;
    size_t replayed = 0;
    std::signal(SIGABRT, on_abort);
    for (int i = 1; i < count; ++i) {
        const std::string argument = arguments[i];
        if (argument.rfind("-max_total_time=", 0) == 0)
            seconds = std::atof(argument.c_str() + 16);
        else if (argument.rfind("-seed=", 0) == 0)
            seed = std::strtoull(argument.c_str() + 6, nullptr, 10);
        else if (std::filesystem::is_directory(argument))
            folder = argument;
        else if (std::filesystem::is_regular_file(argument))
            run(read(argument)), ++replayed;
        else
            return std::fprintf(stderr, "%s: no such option, folder or file\n", arguments[i]), 2;
    }
    if (replayed) return std::printf("%zu inputs: no law broken\n", replayed), 0;

    std::mt19937_64 random(seed);
    std::vector<Input> corpus;
    for (int i = 0; i < 32; ++i) {
        Input start(64 + 16 * static_cast<size_t>(i));
        for (uint8_t& byte : start) byte = static_cast<uint8_t>(random());
        corpus.push_back(start);
    }
    if (!folder.empty())
        for (const auto& entry : std::filesystem::directory_iterator(folder)) corpus.push_back(read(entry.path()));
    for (const Input& input : corpus) run(input);

    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    size_t runs = 0;
    for (; elapsed() < seconds; ++runs) {
        if (!run(mutated(corpus, random))) continue;
        corpus.push_back(current);
        if (!folder.empty()) keep(folder, "", current);
    }
    std::printf("%zu runs in %.0f s, %zu inputs kept, %zu places in the code reached\n", runs, elapsed(), corpus.size(),
                places);
}
