#pragma once
#include "samples/texel_source.h"

namespace radiafit {

/// Some texels of a source, numbered anew in their order.
class PickedTexels final : public TexelSource {
public:
    /// The source must outlive it. texels: ascending.
    PickedTexels(const TexelSource& source, std::vector<uint32_t> texels)
        : source_(&source), texels_(std::move(texels)) {}
    uint32_t texel_count() const override { return uint32_t(texels_.size()); }
    uint64_t sample_count() const override;  ///< by reading them all
    void read(uint32_t begin, TexelSamples& out) const override;

private:
    const TexelSource* source_;
    std::vector<uint32_t> texels_;
};

/// Of all texels of a source these ones' samples; of the others none. texels: ascending.
TexelSamples samples_of(const TexelSource& source, std::span<const uint32_t> texels);

}  // namespace radiafit
