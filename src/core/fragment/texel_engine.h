#pragma once
#include <map>
#include <memory>
#include <optional>

#include "fragment/fragment_engine.h"
#include "fragment/problem_numbers.h"
#include "fragment/texel_passes.h"
#include "model/texel_options.h"

namespace radiafit {

/// The paper's engine for reflectance models whose problems are single texels (Section 4.2): images stream through the
/// device as they do for light field maps, and each texel has one error, one step and one decision for all its
/// parameters. Fulfils Engine, with a problem per texel of the atlas; E of a texel is over the number of its samples.
/// Images are fitted in linear light. The context must be current wherever it is used, and when it is destroyed.
class TexelFragmentEngine final : public DeviceEngine<TexelVector, ProblemNumbers> {
public:
    /// dataset and atlas must outlive it. atlas: the triangles of the dataset's mesh, or its grid. views: indices of
    /// the images to fit, each with a light. Of fragment_options, space and scissored mean nothing here. Throws
    /// UserError for a dataset without lights, options out of range and sizes beyond the device's limits.
    TexelFragmentEngine(const Dataset& dataset, const Atlas& atlas, std::vector<uint32_t> views,
                        const TexelOptions& options, const FragmentOptions& fragment_options);

    size_t parameter_count() const override { return shape_.texels() * size_t(shape_.model->parameters); }

    /// samples: those that count (model/texel_options.h). mean: the Lambertian albedo sum t u_z / sum u_z^2 over them;
    /// 0 without samples. Two sweeps where shadow_below needs that albedo first.
    ProblemStatistics count();
    /// Parameters [texels][parameters]: for every texel the best of the model's starts, with coefficients by linear
    /// least squares within their bounds; for a model without a shape that alone. After count(). A sweep per group of
    /// starts; allocates up to eight layers for its time, and a group's sums in host memory.
    std::vector<float> start();

    // The other verbs of optim/engine.h that DeviceEngine lacks.
    void gradient_pass(bool diagonal);
    void directional_pass();
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn);
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);
    Line read_line() const override;

    SweepTimes times() const { return images_.times(); }
    PassRunner& passes() { return *run_; }  ///< to tally them

private:
    template <class Body>
    void sweep(const Body& body);
    void count_samples(std::span<const float> darkness);
    void penalty_pass(const Program& program, const TexelVector& x);
    void set_bounds(const Program& program) const;
    void map_passes(const Program& program, const std::vector<Framebuffer>& targets);
    const std::vector<Program>& update_programs(Update which);  ///< compiled when they are first asked for
    /// Render targets of these vectors together, [map].
    const std::vector<Framebuffer>& targets(std::span<const TexelVector* const> vectors);
    TexelVector make_vector() const override { return {shape_, storage_}; }
    void make_products(int count) override;
    void drop_targets() override { targets_.clear(); }
    std::vector<float> trial_errors() const override;

    const Dataset* dataset_;
    TexelOptions options_;
    Storage storage_;
    TexelShape shape_;
    ImageSweep images_;
    std::optional<SlsMesh> mesh_;  ///< none over a grid
    std::optional<PassRunner> run_;
    Texture surface_;  ///< layers: position and usability; normal and darkness
    Texture inverse_samples_, penalty_, products_;
    TexelAccumulators sums_;
    std::unique_ptr<TexelPasses> passes_;
    Framebuffer penalty_target_;
    std::vector<Framebuffer> product_targets_;
    std::map<TextureList, std::vector<Framebuffer>> targets_;
    std::map<Update, std::vector<Program>> updates_;
    Program penalty_program_, penalty_curvature_, gradient_, precondition_, dot_;
};

}  // namespace radiafit
