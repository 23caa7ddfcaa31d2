#pragma once
#include <cstdint>
#include <string>

#include "dataset/image_stream.h"

namespace radiafit {

enum class RecordKind {
    compact,  ///< stored channels and the place in the vertex's maps: 4 to 10 bytes a sample and vertex
    full      ///< the paper's: target, residual, surface-map coordinate, three view-map coordinates; 56 bytes
};

struct RecordOptions {
    RecordKind kind = RecordKind::compact;
    TargetSpace space = TargetSpace::stored;
    uint64_t memory = uint64_t(1) << 30;  ///< bytes of samples held at a time; what exceeds it waits in files
    std::string key = {};                 ///< what the records come from; compared when they are opened again
};

}  // namespace radiafit
