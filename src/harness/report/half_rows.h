#pragma once
#include "report/columns.h"

/// A file that several experiments leave: what the 16-bit floats of their OpenGL are.
namespace radiafit::harness::rows_of {

struct Halves {
    std::string of, values, subnormals;
};
inline const RowFileOf<Halves> halves{
    "halves.csv",
    "How OpenGL rounds to 16-bit floats, which it leaves to drivers: measured before anything else.",
    {{"of", columns::key(),
      "packing: by packHalf2x16; storage: of fp16, which is packed so or, where that is not to nearest, rounded in "
      "shaders; render target: of fp16-truncate; blended sum: of sums in fp16",
      &Halves::of},
     {"values", columns::shown(), "between two halves: to nearest, ties to even, or towards zero", &Halves::values},
     {"subnormals", columns::shown(), "the same of those below 6.1e-5; or they become 0", &Halves::subnormals}},
    columns::partial};

}  // namespace radiafit::harness::rows_of
