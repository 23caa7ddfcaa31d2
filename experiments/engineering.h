#pragma once
#include "base/rings.h"

namespace radiafit::harness {

/// What of a solver's time is no algorithm's.
struct Engineering {
    const char* precision;  ///< of its arithmetic: "32" bits, "64", or "32 and 64"
    int together;           ///< problems that a register holds side by side
    const char* instructions;
};

inline constexpr const char* debian_instructions = "SSE2";  ///< of Ceres as Debian builds it

}  // namespace radiafit::harness
