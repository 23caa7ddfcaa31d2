#pragma once
#include <map>
#include <span>
#include <vector>

#include "compute/problem_buffers.h"
#include "dataset/dataset.h"
#include "fragment/texel_arrays.h"
#include "gl/context.h"
#include "samples/texel_loader.h"

namespace radiafit {

/// Texel-local models by OpenGL's compute shaders, over samples that were distributed once and stay on the device:
/// thosethat count, in eight bytes each (16 bits a channel in linear light, to which the fragment engine rounds, too,
/// and the image), or in sixteen where the dataset has floats.Fulfils Engine, with a problem per texel of the atlas; an
/// invocation is a texel, so the same fit gives the same bits. The context must be current wherever it is used, and
/// when it is destroyed.
class TexelComputeEngine {
public:
    /// Nothing of the arguments is kept. source: of these views. Throws UserError for options out of range, for a
    /// dataset without lights, and where a buffer would be larger than the device allows.
    TexelComputeEngine(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const TexelOptions& options, const TexelSource& source);

    size_t problem_count() const { return shape_.texels(); }
    size_t parameter_count() const { return shape_.texels() * size_t(shape_.model->parameters); }

    // The verbs of optim/engine.h. Parameters [texels][parameters].
    /// samples: those that count (model/texel_options.h). mean: the Lambertian albedo of these; 0 without samples.
    ProblemStatistics count() const { return statistics_; }
    void reset(std::span<const float> start);
    void fit_terms(int, int) {}
    void make_room(const Room& room);
    void gradient_pass(bool diagonal);
    void directional_pass();
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn) { problems_.step(which, turn); }
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);
    EngineSummary summary() { return problems_.summary(); }
    void outcomes(std::span<ProblemOutcome> out) const { problems_.outcomes(out); }
    void read_errors(std::span<float> out) const { problems_.read_errors(out); }
    void read_parameters(std::span<float> out) const { read(vectors_[vector::p].buffer, out); }  ///< in any gauge

    // What tests and agreement checks look at.
    struct Evaluation {
        std::vector<float> error;               ///< [texels] E_t at the trial point
        std::vector<float> gradient, diagonal;  ///< [texels][parameters]; diagonal: the fresh preconditioner
    };
    Evaluation read_evaluation() const;  ///< after gradient_pass(true)
    struct Line {
        std::vector<float> gauss_newton, curvature;  ///< [texels], penalties included
    };
    Line read_line() const;                                             ///< after directional_pass()
    void set_line(std::span<const float> p, std::span<const float> d);  ///< for directional_pass()

    /// Allocated on the device by this engine.
    uint64_t bytes() const { return uint64_t(Context::current().allocated_bytes() - allocated_before_); }

private:
    void upload_samples(const Dataset& dataset, const std::vector<uint32_t>& views, const TexelSource& source);
    FetchedBuffer make_vector() const;
    void write(FetchedBuffer& vector, std::span<const float> values) const;
    void read(const Buffer& buffer, std::span<float> values) const;
    std::vector<float> read_given(size_t which) const;
    Program program(const std::string& file, const Defines& more = {}) const;
    const Program& update_program(Update which);

    int64_t allocated_before_ = Context::current().allocated_bytes();
    TexelOptions options_;
    TexelShape shape_;
    ProblemBuffers problems_;
    ProblemStatistics statistics_;
    bool wide_;   ///< samples are floats
    float unit_;  ///< of a channel
    FetchedBuffer texels_, samples_, views_;
    Texture surface_;
    std::vector<FetchedBuffer> vectors_;  ///< those of optim/verbs.h, then the optimizer's own
    Program gradient_passes_[2], line_, dot_;
    std::map<Update, Program> updates_;
};

}  // namespace radiafit
