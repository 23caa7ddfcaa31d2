#pragma once

/// Loops that gain by AVX-512 are compiled twice: for the instructions that the whole program is compiled for
/// (RADIAFIT_ARCH; with AVX2 where nothing else is asked), and for those of x86-64-v4. The processor that runs them
/// decides. Only sums and products of lanes are done, so both give the same numbers but for rounding. What is compiled
/// for one processor needs one of the two, and defines RADIAFIT_RUNS_AVX512 as 1 or as 0.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX512F__)
#define RADIAFIT_TWO_INSTRUCTION_SETS 1
#else
#define RADIAFIT_TWO_INSTRUCTION_SETS 0
#endif

#ifndef RADIAFIT_RUNS_AVX512
#define RADIAFIT_RUNS_AVX512 radiafit::run_avx512()
#endif

namespace radiafit {

/// Whether with_widest_vectors() runs loops as AVX-512: where the whole program is compiled for it, or the processor
/// has it. Not where the environment variable RADIAFIT_INSTRUCTIONS is `base` when this is first called and loops are
/// compiled twice, nor while there is a BaseInstructions.
bool run_avx512();

/// For comparisons: while one lives, loops that are compiled twice run as the rest of the program. To be made and
/// destroyed while no other thread runs such loops. Of models that were compiled from files it changes nothing.
class BaseInstructions {
public:
    BaseInstructions();
    ~BaseInstructions();
    BaseInstructions(const BaseInstructions&) = delete;
    BaseInstructions& operator=(const BaseInstructions&) = delete;

private:
    bool before_;
};

/// What the program is compiled for, and what with_widest_vectors() runs as now: "AVX-512", "AVX2", "SSE2", or
/// "" on other processors.
const char* compiled_instructions();
const char* widest_instructions();

#if RADIAFIT_TWO_INSTRUCTION_SETS
namespace detail {
template <class Body>
[[gnu::target("arch=x86-64-v4"), gnu::flatten, gnu::noinline]] void as_avx512(const Body& body) {
    body();
}
}  // namespace detail
#endif

/// Calls body(), compiled for the widest vectors that this processor has. All that body calls is compiled into it, so
/// it should be a loop over samples or more, and its vectors don't reach it as arguments by value.
template <class Body>
void with_widest_vectors(const Body& body) {
#if RADIAFIT_TWO_INSTRUCTION_SETS
    if (RADIAFIT_RUNS_AVX512) return detail::as_avx512(body);
#endif
    body();
}

}  // namespace radiafit
