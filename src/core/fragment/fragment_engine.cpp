#include "fragment/fragment_engine.h"

#include <stdexcept>

#include "model/lfm_start.h"

namespace radiafit {

std::string to_string(Passes passes) {
    return passes == Passes::paper ? "paper" : passes == Passes::r300 ? "r300" : "combined";
}

FragmentEngine::FragmentEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                               std::vector<uint32_t> views, const LfmOptions& options,
                               const FragmentOptions& fragment_options)
    : options_((check_options(options), options)),
      fragment_options_(fragment_options),
      layout_(rings, atlas, options.view_side, options.terms),
      shape_{&atlas, &rings, &layout_, ProblemGrid(rings.vertex_count(), options.view_side), options.loss},
      images_(dataset, std::move(views), fragment_options.source, fragment_options.space,
              fragment_options.keep_on_device),
      mesh_(atlas, fragment_options.cull),
      run_(mesh_),
      problems_(shape_, fragment_options.sums),
      gathers_(shape_, fragment_options.storage, fragment_options.passes == Passes::r300),
      vertices_(GL_RGBA32F, shape_.grid.columns, shape_.grid.rows, 4) {
    const auto frames = vertex_frames(atlas.mesh());
    std::vector<float> layers[4];
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        const Vec3f* rows[4] = {&atlas.mesh().positions[v], &frames[v].tangent, &frames[v].bitangent,
                                &frames[v].normal};
        for (int layer = 0; layer < 4; ++layer)
            layers[layer].insert(layers[layer].end(), {rows[layer]->x(), rows[layer]->y(), rows[layer]->z(), 0.0f});
    }
    for (int layer = 0; layer < 4; ++layer) problems_.write(vertices_, layer, layers[layer]);

    numbers_ =
        std::make_unique<ProblemNumbers>(run_, 3 * shape_.grid.columns, shape_.grid.rows, 3 * rings.vertex_count(),
                                         std::vector<uint32_t>(), "vertices", fragment_options.passes == Passes::r300);
    make_room({});
    if (fragment_options.passes == Passes::r300) make_spares();
    const Storage storage = fragment_options.storage;
    gradient_sums_ = MapSums(shape_, fragment_options.sums);
    square_sums_ = MapSums(shape_, fragment_options.sums);
    map_passes_ = std::make_unique<MapPasses>(shape_, mesh_, run_, gathers_, problems_, *numbers_, vectors_, spares_,
                                              options_, storage);

    const auto [width, height] = images_.largest();
    const PassResources resources{shape_,
                                  mesh_,
                                  run_,
                                  gathers_,
                                  problems_,
                                  vertices_,
                                  fragment_options.passes,
                                  storage,
                                  fragment_options.sums,
                                  options.lookup,
                                  width,
                                  height,
                                  images_.bits(),
                                  fragment_options.images_per_pass,
                                  fragment_options.keep_samples ? images_.views().size() : 0};
    if (fragment_options.keep_samples && fragment_options.passes == Passes::combined)
        throw std::invalid_argument("combined passes keep no samples");
    image_passes_ =
        fragment_options.passes == Passes::combined ? make_combined_passes(resources) : make_paper_passes(resources);
    images_.set_batch(image_passes_->batch());
    count_bytes();
}

// Streams every image once through body(images), batch by batch.
template <class Body>
void FragmentEngine::sweep(const Body& body) {
    images_.run(
        [&](const std::vector<ImageOnDevice>& images) {
            if (fragment_options_.scissored && !sample_counts_.empty()) {  // count() is spared
                gl().Enable(GL_SCISSOR_TEST);
                gl().Scissor(0, 0, 1, 1);
            }
            body(images);
            gl().Disable(GL_SCISSOR_TEST);
        },
        [&] {
            image_passes_->end_sweep();
            mesh_.select({});
            gathers_.mark_tiles(mesh_);
        });
}

ProblemStatistics FragmentEngine::count() {
    problems_.clear({Sum::target});
    image_passes_->begin_sweep(nullptr, nullptr);
    sweep([&](const std::vector<ImageOnDevice>& images) { image_passes_->count(images); });
    const std::vector<float> sums = problems_.read(Sum::target);
    const size_t vertices = layout_.problem_count();
    ProblemStatistics statistics;
    statistics.samples.resize(vertices);
    statistics.mean.assign(3 * vertices, 0.0f);
    std::vector<float> density(4 * vertices), weights(4 * vertices);
    for (size_t v = 0; v < vertices; ++v) {
        const auto samples = uint32_t(sums[4 * v + 3]);
        const size_t texels = layout_.surface_texels(v);
        statistics.samples[v] = samples;
        density[4 * v] = samples ? float(inverse_density(options_, texels, samples)) : 1.0f;
        density[4 * v + 1] = float(texels);
        for (size_t c = 0; c < 3 && samples; ++c) {
            const float mean = sums[4 * v + c] / float(samples);
            statistics.mean[3 * v + c] = mean;
            weights[4 * v + c] = scaled_lambda_view(options_, texels, mean);
        }
    }
    problems_.write(problems_.constants, 0, density);
    problems_.write(problems_.constants, 1, weights);
    sample_counts_ = statistics.samples;
    return statistics;
}

void FragmentEngine::gradient_pass(bool diagonal) {
    problems_.clear({Sum::residual, Sum::penalty});
    gradient_sums_.clear(run_);
    if (diagonal) square_sums_.clear(run_);
    image_passes_->begin_sweep(&gradient_sums_, diagonal ? &square_sums_ : nullptr);
    const MapVector& trial = vectors_[vector::trial];
    sweep([&](const std::vector<ImageOnDevice>& images) {
        image_passes_->gradient_pass(images, trial, gradient_sums_, diagonal ? &square_sums_ : nullptr);
    });
    map_passes_->finish_gradient(trial, gradient_sums_, first_term_, last_term_);
    if (diagonal) map_passes_->finish_precondition(square_sums_);
}

void FragmentEngine::directional_pass() {
    problems_.clear({Sum::gauss_newton, Sum::curvature, Sum::third, Sum::fourth, Sum::penalty_curvature});
    const bool quartic = options_.mode == Mode::modern;
    const MapVector &p = vectors_[vector::p], &d = vectors_[vector::d];
    image_passes_->begin_sweep(nullptr, nullptr);
    sweep([&](const std::vector<ImageOnDevice>& images) { image_passes_->directional_pass(images, p, d, quartic); });
    map_passes_->finish_directional(p, d);
}

void FragmentEngine::dot(std::initializer_list<DotProduct> products) {
    for (const DotProduct& product : products) map_passes_->dot(product);
}

void FragmentEngine::step(Step which, const Turn& turn) {
    for (const Program& program : numbers_->programs(which, turn)) problems_.bind_to(program);
    numbers_->step(which, turn);
}

std::vector<float> FragmentEngine::trial_errors() const {
    const auto residual = problems_.read(Sum::residual), penalty = problems_.read(Sum::penalty);
    const auto constants = problems_.read(problems_.constants, 0);
    std::vector<float> errors;
    for (size_t i = 0; i < problem_count(); ++i) {
        const size_t at = 4 * (i / 3) + i % 3;
        errors.push_back(0.5f * constants[4 * (i / 3)] * residual[at] + penalty[at]);
    }
    return errors;
}

FragmentEngine::Line FragmentEngine::read_line() const {
    const auto constants = problems_.read(problems_.constants, 0);
    const auto penalty = problems_.read(Sum::penalty_curvature);
    const auto sums = [&](Sum sum, bool penalized) {
        const auto layer = problems_.read(sum);
        std::vector<float> out;
        for (size_t i = 0; i < problem_count(); ++i) {
            const size_t at = 4 * (i / 3) + i % 3;
            out.push_back(constants[4 * (i / 3)] * layer[at] + (penalized ? penalty[at] : 0.0f));
        }
        return out;
    };
    return {sums(Sum::gauss_newton, true), sums(Sum::curvature, true), sums(Sum::third, false),
            sums(Sum::fourth, false)};
}

}  // namespace radiafit
