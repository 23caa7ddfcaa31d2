#pragma once
#include <cstdint>

#include "dataset/dataset.h"
#include "synthetic/ornament_options.h"

namespace radiafit {

struct SyntheticSize;

/// Images of the ornament under a lamp that moves, with its truth: two materials of Lafortune's model, one that no
/// Lafortune lobe represents exactly, all with relief (Dataset::normal_map). Fills all of `header` but what the writer
/// knows, name and provenance.
void write_ornament(const SyntheticSize& size, uint64_t seed, const OrnamentOptions& options, DatasetWriter& writer,
                    Dataset& header);

}  // namespace radiafit
