#include "gl/fragment_engine.h"

#include <algorithm>

#include "model/lfm_start.h"

namespace radiafit {

std::string to_string(Passes passes) { return passes == Passes::paper ? "paper" : "combined"; }

FragmentEngine::FragmentEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                               std::vector<uint32_t> views, const LfmOptions& options,
                               const FragmentOptions& fragment_options)
    : options_((check_options(options), options)),
      fragment_options_(fragment_options),
      layout_(rings, int(atlas.texels_per_tile()), options.view_side, options.terms),
      shape_{&atlas, &rings, &layout_, ProblemGrid(rings.vertex_count(), options.view_side)},
      images_(dataset, std::move(views), fragment_options.source, fragment_options.space, fragment_options.resident),
      mesh_(atlas),
      run_(mesh_),
      problems_(shape_, fragment_options.sums),
      gathers_(shape_, fragment_options.storage),
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

    const Storage storage = fragment_options.storage;
    MapPasses::Vectors& v = vectors_;
    for (MapVector* vector : {&v.p, &v.trial, &v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d})
        *vector = MapVector(shape_, storage);
    gradient_sums_ = MapSums(shape_, fragment_options.sums);
    square_sums_ = MapSums(shape_, fragment_options.sums);
    map_passes_ = std::make_unique<MapPasses>(shape_, mesh_, run_, gathers_, problems_, options_, storage);
    map_passes_->prepare(vectors_);

    const auto [width, height] = images_.largest();
    const PassWorld world{shape_,         mesh_,     run_,    gathers_,
                          problems_,      vertices_, storage, fragment_options.sums,
                          options.lookup, width,     height,  images_.bits()};
    image_passes_ = fragment_options.passes == Passes::paper ? make_paper_passes(world) : make_combined_passes(world);
    images_.set_batch(image_passes_->batch());

    after_direction_ = Program::draw("common/whole.vert", "optimize/after_direction.frag");
    after_line_ = Program::draw("common/whole.vert", "optimize/after_line.frag");
    bytes_ = uint64_t(Context::current().allocated_bytes() - allocated_before_);
}

FragmentEngine::~FragmentEngine() = default;

// Streams every image once through body(images), batch by batch.
template <class Body>
void FragmentEngine::sweep(const Body& body) {
    images_.run(
        [&](const std::vector<ImageOnDevice>& images) {
            if (fragment_options_.scissored && !samples_.empty()) {  // count() is spared
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

const FragmentTimes& FragmentEngine::times() const {
    static_cast<SweepTimes&>(times_) = images_.times();
    times_.counters = run_.counters;
    return times_;
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
        const size_t texels = shape_.rings->ring(v).size() * size_t(layout_.tile_texels());
        statistics.samples[v] = samples;
        density[4 * v] = samples ? float(double(texels) / samples) : 1.0f;
        density[4 * v + 1] = float(texels);
        for (size_t c = 0; c < 3 && samples; ++c) {
            const float mean = sums[4 * v + c] / float(samples);
            statistics.mean[3 * v + c] = mean;
            weights[4 * v + c] = scaled_lambda_view(options_, texels, mean);
        }
    }
    problems_.write(problems_.constants, 0, density);
    problems_.write(problems_.constants, 1, weights);
    samples_ = statistics.samples;
    return statistics;
}

void FragmentEngine::reset(std::span<const float> start) {
    MapPasses::Vectors& v = vectors_;
    v.trial.upload(shape_, start);
    v.p.upload(shape_, start);  // what a problem without samples returns
    for (MapVector* vector : {&v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d}) vector->clear();
    problems_.alpha.clear();
    problems_.state.clear();
    using real = float;  // HUGE_ERROR is text shared with GLSL
    const size_t vertices = layout_.problem_count();
    std::vector<float> error(4 * vertices, HUGE_ERROR), one(4 * vertices, 1.0f), status(4 * vertices);
    for (size_t i = 0; i < status.size(); ++i) status[i] = float(samples_[i / 4] ? Status::active : Status::no_samples);
    problems_.write(problems_.state, 0, error);
    problems_.write(problems_.state, 3, one);
    problems_.write(problems_.state, 6, status);
}

void FragmentEngine::direction_pass(bool diagonal) {
    problems_.clear({Sum::residual, Sum::penalty});
    gradient_sums_.clear(run_);
    if (diagonal) square_sums_.clear(run_);
    image_passes_->begin_sweep(&gradient_sums_, diagonal ? &square_sums_ : nullptr);
    sweep([&](const std::vector<ImageOnDevice>& images) {
        image_passes_->direction(images, vectors_.trial, gradient_sums_, diagonal ? &square_sums_ : nullptr);
    });
    map_passes_->finish_direction(vectors_.trial, gradient_sums_, first_term_, last_term_);
    if (diagonal) map_passes_->finish_precondition(square_sums_);
}

void FragmentEngine::project(Rule rule, bool fresh) {
    problems_.clear({Sum::norm, Sum::cross, Sum::conjugate});
    const MapVector* weight = rule != Rule::cg_modern ? nullptr : fresh ? &vectors_.fresh : &vectors_.precondition;
    map_passes_->project(vectors_, weight);
}

// One fragment per vertex, between the reads and the writes of its state.
void FragmentEngine::update_states(const Program& program, const Framebuffer& target) {
    gl().TextureBarrier();
    problems_.state.bind(7);
    problems_.bind_sums();
    problems_.constants.bind(12);
    problems_.alpha.bind(14);
    run_.bind(target, program);
    run_.draw_whole();
    gl().TextureBarrier();
}

void FragmentEngine::after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
    after_direction_.set(20, int(rule));
    after_direction_.set(21, restart ? 1 : 0);
    after_direction_.set2(22, stop.residual, stop.output_change);
    update_states(after_direction_, problems_.state_target);
}

void FragmentEngine::update_direction(Rule rule, bool fresh) {
    map_passes_->update_direction(vectors_, rule == Rule::cg_modern, rule == Rule::cg_modern && fresh);
}

void FragmentEngine::line_pass() {
    problems_.clear({Sum::gauss_newton, Sum::curvature, Sum::third, Sum::fourth, Sum::penalty_curvature});
    const bool quartic = options_.mode == Mode::modern;
    image_passes_->begin_sweep(nullptr, nullptr);
    sweep([&](const std::vector<ImageOnDevice>& images) {
        image_passes_->line(images, vectors_.p, vectors_.d, quartic);
    });
    map_passes_->finish_line(vectors_.p, vectors_.d);
}

void FragmentEngine::after_line(Rule rule, ProblemText<float>::StopRules stop) {
    after_line_.set(20, int(rule));
    after_line_.set2(22, stop.residual, stop.output_change);
    update_states(after_line_, problems_.line_target);
}

void FragmentEngine::advance() { map_passes_->advance(vectors_); }

EngineSummary FragmentEngine::summary() const {
    const std::vector<float> error = read_state(0), accepted = read_state(5), status = read_state(6);
    EngineSummary sum;
    for (size_t i = 0; i < error.size(); ++i) {
        sum.active += status[i] == float(Status::active);
        sum.accepted += accepted[i] != 0;
        if (status[i] != float(Status::no_samples)) sum.error += double(error[i]);
    }
    return sum;
}

// One field of every problem's state, [M].
std::vector<float> FragmentEngine::read_state(int field) const {
    const std::vector<float> layer = problems_.read(problems_.state, field);
    std::vector<float> out(problem_count());
    for (size_t i = 0; i < out.size(); ++i) out[i] = layer[4 * (i / 3) + i % 3];
    return out;
}

void FragmentEngine::outcomes(std::span<ProblemOutcome> out) const {
    const std::vector<float> error = read_state(0), status = read_state(6), iterations = read_state(7);
    for (size_t i = 0; i < error.size(); ++i) {
        out[i] = {error[i], Status(int(status[i])), uint32_t(iterations[i])};
        if (out[i].status == Status::no_samples) out[i].error = 0;
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

void FragmentEngine::read_errors(std::span<float> out) const {
    const std::vector<float> error = read_state(0);
    std::copy(error.begin(), error.end(), out.begin());
}

void FragmentEngine::read_parameters(std::span<float> out) const {
    std::fill(out.begin(), out.end(), 0.0f);
    vectors_.p.download(shape_, out);
}

FragmentEngine::Evaluation FragmentEngine::read_evaluation() const {
    Evaluation result;
    const auto residual = problems_.read(Sum::residual);
    const auto penalty = problems_.read(Sum::penalty);
    const auto constants = problems_.read(problems_.constants, 0);
    for (size_t i = 0; i < problem_count(); ++i) {
        const size_t at = 4 * (i / 3) + i % 3;
        result.error.push_back(0.5f * constants[4 * (i / 3)] * residual[at] + penalty[at]);
    }
    result.gradient.assign(layout_.size(), 0.0f);
    result.diagonal.assign(layout_.size(), 0.0f);
    vectors_.trial_g.download(shape_, result.gradient);
    vectors_.fresh.download(shape_, result.diagonal);
    return result;
}

void FragmentEngine::set_line(std::span<const float> p, std::span<const float> d) {
    vectors_.p.upload(shape_, p);
    vectors_.d.upload(shape_, d);
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
