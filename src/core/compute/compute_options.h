#pragma once
#include "dataset/image_stream.h"

namespace radiafit {

/// How sums over samples come about.
enum class Accumulate {
    gather,         ///< each sum has one invocation that makes it, in one order
    scatter_fixed,  ///< each sample adds to its sums in 64-bit fixed point: the same bits in any order
    scatter_float,  ///< each sample adds in floats, by atomic additions of the driver's: rounding depends on the order
    scatter_swap    ///< the same where the driver has no such addition, by comparing and swapping
};
/// What an engine uses on this device where a fit asks for `wanted`: scatter_float may become scatter_swap.
Accumulate accumulate_here(Accumulate wanted);
/// For people: "scattered sums in 64-bit fixed point".
const char* describe(Accumulate accumulate);

/// Where images come from that are distributed in every sweep; as those of FragmentOptions.
struct StreamOptions {
    StreamSource source = StreamSource::memory;
    bool keep_on_device = false;
    TargetSpace space = TargetSpace::stored;
};

}  // namespace radiafit
