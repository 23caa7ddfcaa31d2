#pragma once
#include <span>
#include <vector>

#include "compute/buffer_engine.h"
#include "dataset/dataset.h"
#include "samples/texel_loader.h"

namespace radiafit {

/// Texel-local models by OpenGL's compute shaders, over samples that were distributed once and stay on the device:
/// those that count, in eight bytes each (16 bits a channel in linear light, to which the fragment engine rounds, too,
/// and the image), or in sixteen where the dataset has floats. Fulfils Engine, with a problem per texel of the atlas;
/// an invocation is a texel, so the same fit gives the same bits. The context must be current wherever it is used, and
/// when it is destroyed.
class TexelComputeEngine final : public BufferEngine {
public:
    /// Nothing of the arguments is kept. source: samples of these views. Throws UserError for options out of range, for
    /// a dataset without lights, and where a buffer would be larger than the device allows.
    TexelComputeEngine(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const TexelOptions& options, const TexelSource& source);

    size_t parameter_count() const override { return shape_.texels() * size_t(shape_.model->parameters); }

    // The verbs of optim/engine.h that DeviceEngine and BufferEngine lack. Parameters [texels][parameters].
    /// samples: those that count (model/texel_options.h). mean: the Lambertian albedo of these; 0 without samples.
    ProblemStatistics count() const { return statistics_; }
    void gradient_pass(bool diagonal) { gradient_passes_[diagonal].dispatch(numbers_->groups(shape_.texels())); }
    void directional_pass() { line_.dispatch(numbers_->groups(shape_.texels())); }
    Line read_line() const override { return {read_given(1), read_given(2), {}, {}}; }

private:
    void upload_samples(const Dataset& dataset, const std::vector<uint32_t>& views, const TexelSource& source);
    Program program(const std::string& file, const Defines& more) const override;
    std::vector<float> trial_errors() const override { return read_given(0); }
    std::vector<float> read_given(size_t which) const;  ///< [texels]

    TexelOptions options_;
    TexelShape shape_;
    ProblemStatistics statistics_;
    bool wide_;   ///< samples are floats
    float unit_;  ///< of a channel
    FetchedBuffer texels_, samples_, views_;
    Texture surface_;
    Program gradient_passes_[2], line_;
};

}  // namespace radiafit
