#include "base/instructions.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace radiafit {

bool run_avx512() {
#if RADIAFIT_TWO_INSTRUCTION_SETS
    static const bool yes = [] {
        const char* asked = std::getenv("RADIAFIT_INSTRUCTIONS");
        return __builtin_cpu_supports("x86-64-v4") && !(asked && std::string_view(asked) == "base");
    }();
    return yes;
#elif defined(__AVX512F__)
    return true;
#else
    return false;
#endif
}

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
