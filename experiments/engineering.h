#pragma once
#include <fmt/format.h>

#include <string>

#include "base/instructions.h"
#include "base/rings.h"

namespace radiafit::harness {

/// What of a solver's time is no algorithm's.
struct Engineering {
    const char* precision;  ///< of its arithmetic, in bits: see below
    int together;           ///< problems that a register holds side by side
    std::string instructions;
};

inline constexpr const char *in_32 = "32, sums in 64", *in_64_but_schur = "64, Schur complement in 32";

/// Of Ceres as Debian builds it; it calls costs and derivatives that are compiled as the rest of the program.
inline std::string ceres_instructions() {
    const std::string own = compiled_instructions();
    return own.empty() || own == "SSE2" ? own : fmt::format("SSE2; costs {}", own);
}

}  // namespace radiafit::harness
