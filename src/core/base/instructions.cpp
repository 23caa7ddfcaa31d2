#include "base/instructions.h"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string_view>

namespace radiafit {

namespace {
std::atomic<bool> base_alone = false;
}

bool run_avx512() {
#if RADIAFIT_TWO_INSTRUCTION_SETS
    static const bool yes = [] {
        const char* asked = std::getenv("RADIAFIT_INSTRUCTIONS");
        return __builtin_cpu_supports("x86-64-v4") && !(asked && std::string_view(asked) == "base");
    }();
    return yes && !base_alone.load(std::memory_order_relaxed);
#elif defined(__AVX512F__)
    return true;
#else
    return false;
#endif
}

BaseInstructions::BaseInstructions() : before_(base_alone.exchange(true)) {}
BaseInstructions::~BaseInstructions() { base_alone = before_; }

const char* compiled_instructions() {
#if defined(__AVX512F__)
    return "AVX-512";
#elif defined(__AVX2__)
    return "AVX2";
#elif defined(__x86_64__)
    return "SSE2";
#else
    return "";
#endif
}

const char* widest_instructions() { return run_avx512() ? "AVX-512" : compiled_instructions(); }

#if defined(__AVX2__)
namespace {

/// Runs before anything needs newer instructions: one line instead of a signal. Calls nothing compiled to such ones.
[[gnu::constructor(101)]] void refuse_older_processors() {
    __builtin_cpu_init();
#if defined(__AVX512F__)
    const bool enough = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    constexpr std::string_view text =
        "radiafit: this processor lacks AVX-512, which the program was built for; build it with "
        "-DRADIAFIT_ARCH=x86-64-v3\n";
#else
    const bool enough = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    constexpr std::string_view text =
        "radiafit: this processor lacks AVX2, which the program was built for; build it with -DRADIAFIT_ARCH=x86-64\n";
#endif
    if (enough) return;
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    _exit(2);
}

}  // namespace
#endif

}  // namespace radiafit
