#include "gl/texel_engine.h"

#include "dataset/encoding.h"

namespace radiafit {
namespace {

constexpr float unbound = 3e38f;

}  // namespace

TexelFragmentEngine::TexelFragmentEngine(const Dataset& dataset, const Atlas& atlas, std::vector<uint32_t> views,
                                         const TexelOptions& options, const FragmentOptions& fragment_options)
    : allocated_before_(Context::current().allocated_bytes()),
      dataset_((require_lights(dataset), &dataset)),
      options_((check_options(options), options)),
      shape_(atlas, *options.model),
      images_(dataset, std::move(views), fragment_options.source, TargetSpace::linear, fragment_options.resident) {
    if (const auto* triangles = dynamic_cast<const TriangleAtlas*>(&atlas)) {
        mesh_.emplace(*triangles);
        run_.emplace(*mesh_);
    } else {
        run_.emplace();
    }
    const auto single = [&](int layers) { return Texture(GL_RGBA32F, shape_.width(), shape_.height(), layers); };
    surface_ = single(2);
    state_ = single(2);
    products_ = single(0);
    for (Texture* texture : {&alpha_, &density_, &penalty_})
        *texture = Texture(GL_R32F, shape_.width(), shape_.height());
    const Storage storage = fragment_options.storage;
    Vectors& v = vectors_;
    for (TexelVector* vector : {&v.p, &v.trial, &v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d})
        *vector = TexelVector(shape_, storage);
    const GLenum summed = sums_format(fragment_options.sums);
    sums_.gradient = TexelSumLayers(summed, shape_, shape_.maps());
    sums_.diagonal = TexelSumLayers(summed, shape_, shape_.diagonal_layers());
    sums_.line = TexelSumLayers(summed, shape_, 1);
    sums_.count = TexelSumLayers(GL_RGBA32F, shape_, 2);

    const TexelWorld world{shape_,
                           mesh_ ? &*mesh_ : nullptr,
                           *run_,
                           surface_,
                           sums_,
                           dataset,
                           images_,
                           storage,
                           has_largest_value(dataset.encoding) ? options_.clip_above : 0};
    passes_ = fragment_options.passes == Passes::paper ? make_paper_texel_passes(world)
                                                       : make_combined_texel_passes(world, fragment_options.together);
    images_.set_batch(passes_->batch());

    state_target_ = Framebuffer({{&state_, 0}, {&state_, 1}});
    line_target_ = Framebuffer({{&state_, 1}, {&alpha_}});
    penalty_target_ = Framebuffer({{&penalty_}});
    products_target_ = Framebuffer({{&products_}});
    for (int map = 0; map < shape_.maps(); ++map) {
        gradient_targets_.push_back(Framebuffer({v.trial_g.target(map)}));
        fresh_targets_.push_back(Framebuffer({v.fresh.target(map)}));
        trial_targets_.push_back(Framebuffer({v.trial.target(map)}));
        update_targets_.push_back(
            Framebuffer({v.p.target(map), v.g.target(map), v.precondition.target(map), v.d.target(map)}));
    }
    const auto whole = [&](const char* shader, const Defines& what = {}) {
        return Program::draw("common/whole.vert", std::string("reflect/") + shader, shape_.defines(storage) + what);
    };
    penalty_program_ = whole("penalty.frag");
    penalty_curvature_ = whole("penalty.frag", {{"ALONG", ""}});
    gradient_ = whole("gradient.frag");
    precondition_ = whole("precondition.frag");
    dots_ = whole("dots.frag");
    after_direction_ = whole("after_direction.frag");
    after_line_ = whole("after_line.frag");
    update_ = whole("update_direction.frag");
    advance_ = whole("advance.frag");
    for (const Program* program : {&penalty_program_, &penalty_curvature_, &gradient_}) set_bounds(*program);
    write_surface({});
    bytes_ = uint64_t(Context::current().allocated_bytes() - allocated_before_);
}

TexelFragmentEngine::~TexelFragmentEngine() = default;

// For shaders/reflect/bounds.glsl.
void TexelFragmentEngine::set_bounds(const Program& program) const {
    std::vector<float> lowest(4 * size_t(shape_.maps()), -unbound), highest(lowest.size(), unbound);
    for (int i = 0; i < shape_.model->parameters; ++i) {
        const auto [map, channel] = TexelShape::map_of(i);
        const size_t at = 4 * size_t(map) + size_t(channel);
        lowest[at] = float(shape_.model->bounds[size_t(i)][0]);
        highest[at] = float(shape_.model->bounds[size_t(i)][1]);
    }
    program.set(14, options_.mu);
    program.set(15, options_.mode == Mode::paper ? 1 : 0);
    program.set4(16, shape_.maps(), lowest.data());
    program.set4(32, shape_.maps(), highest.data());
}

// darkness [texels], or none: samples whose channels' sum is below that share of u_z lie in shadow.
void TexelFragmentEngine::write_surface(std::span<const float> darkness) {
    const Atlas& atlas = *shape_.atlas;
    std::vector<float> layers[2];
    for (auto& layer : layers) layer.resize(4 * size_t(shape_.width()) * size_t(shape_.height()));
    for (uint32_t texel = 0; texel < shape_.texels(); ++texel) {
        const auto write = [&](int layer, const Vec3f& three, float fourth) {
            float* at = layers[layer].data() + 4 * size_t(shape_.place[texel]);
            at[0] = three.x(), at[1] = three.y(), at[2] = three.z(), at[3] = fourth;
        };
        write(0, atlas.position(texel), atlas.usable(texel) ? 1.0f : 0.0f);
        write(1, atlas.normal(texel), darkness.empty() ? 0.0f : darkness[texel]);
    }
    for (int layer = 0; layer < 2; ++layer) surface_.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

// Streams every image once through body(images), batch by batch.
template <class Body>
void TexelFragmentEngine::sweep(const Body& body) {
    images_.run(body, [&] {
        passes_->finish();
        if (mesh_) mesh_->select({});
    });
}

void TexelFragmentEngine::count_samples(std::span<const float> darkness) {
    write_surface(darkness);
    sums_.count.clear(*run_);
    sweep([&](const std::vector<ImageOnDevice>& images) { passes_->count(images); });
}

ProblemStatistics TexelFragmentEngine::count() {
    const size_t texels = shape_.texels();
    ProblemStatistics statistics;
    const auto fit_albedo = [&] {
        statistics.mean.assign(3 * texels, 0.0f);
        const std::vector<float> squares = read_texels(shape_, sums_.count.layers, 3);
        for (int c = 0; c < 3; ++c) {
            const std::vector<float> products = read_texels(shape_, sums_.count.layers, c);
            for (size_t texel = 0; texel < texels; ++texel)
                if (squares[texel] > 0) statistics.mean[3 * texel + size_t(c)] = products[texel] / squares[texel];
        }
    };
    count_samples({});
    fit_albedo();
    if (options_.shadow_below > 0) {
        std::vector<float> darkness(texels);
        for (size_t texel = 0; texel < texels; ++texel)
            for (size_t c = 0; c < 3; ++c) darkness[texel] += options_.shadow_below * statistics.mean[3 * texel + c];
        count_samples(darkness);
        fit_albedo();
    }
    std::vector<float> density(texels);
    for (const float n : read_texels(shape_, sums_.count.layers, 0, 1)) statistics.samples.push_back(uint32_t(n));
    for (size_t texel = 0; texel < texels; ++texel)
        density[texel] = statistics.samples[texel] ? 1 / float(statistics.samples[texel]) : 0.0f;
    write_texels(shape_, density, density_);
    samples_ = statistics.samples;
    return statistics;
}

std::vector<float> TexelFragmentEngine::start() {
    const StartLayout layout(*shape_.model);
    StartSolver solver(*shape_.model, shape_.texels());
    const size_t stride = 4 * size_t(layout.targets());
    std::vector<float> numbers(shape_.texels() * stride);
    const TexelSumLayers sums(GL_RGBA32F, shape_, layout.targets_in(0));
    for (int group = 0; group < layout.groups; ++group) {
        for (int window = 0; window < layout.windows(); ++window) {
            const int targets = layout.targets_in(window);
            sums.clear(*run_);
            sweep([&](const std::vector<ImageOnDevice>& images) { passes_->start(images, group, window, sums); });
            for (int number = 0; number < 4 * targets; ++number) {
                const std::vector<float> values = read_texels(shape_, sums.layers, number % 4, number / 4);
                const size_t at = size_t(4 * window * StartLayout::most_targets + number);
                for (size_t texel = 0; texel < values.size(); ++texel) numbers[texel * stride + at] = values[texel];
            }
        }
        solver.take(group, numbers);
    }
    return std::move(solver).parameters();
}

void TexelFragmentEngine::reset(std::span<const float> start) {
    Vectors& v = vectors_;
    v.trial.upload(shape_, start);
    v.p.upload(shape_, start);  // what a problem without samples returns
    for (TexelVector* vector : {&v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d}) vector->clear();
    alpha_.clear();
    using real = float;  // HUGE_ERROR is text shared with GLSL
    std::vector<float> layers[2];
    for (auto& layer : layers) layer.resize(4 * size_t(shape_.width()) * size_t(shape_.height()));
    for (size_t at = 0; at < layers[0].size(); at += 4) {
        layers[0][at] = HUGE_ERROR;
        layers[0][at + 3] = 1;                               // step factor
        layers[1][at + 2] = float(int(Status::no_samples));  // padding, too
    }
    for (size_t texel = 0; texel < shape_.texels(); ++texel)
        if (samples_[texel]) layers[1][4 * size_t(shape_.place[texel]) + 2] = float(int(Status::active));
    for (int layer = 0; layer < 2; ++layer) state_.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

void TexelFragmentEngine::penalty_pass(const Program& program, const TexelVector& x, const TexelVector* d) {
    x.bind(5);
    if (d) d->bind(6);
    run_->bind(penalty_target_, program);
    run_->draw_whole();
}

// A pass for each map into targets [map], with textures bound by bind().
template <class Bind>
void TexelFragmentEngine::map_passes(const Program& program, const std::vector<Framebuffer>& targets,
                                     const Bind& bind) {
    bind();
    density_.bind(12);
    state_.bind(9);
    alpha_.bind(10);
    for (int map = 0; map < shape_.maps(); ++map) {
        program.set(10, map);
        run_->bind(targets[size_t(map)], program);
        run_->draw_whole();
    }
}

void TexelFragmentEngine::direction_pass(bool diagonal) {
    const Vectors& v = vectors_;
    sums_.gradient.clear(*run_);
    if (diagonal) sums_.diagonal.clear(*run_);
    sweep([&](const std::vector<ImageOnDevice>& images) { passes_->direction(images, v.trial, diagonal); });
    penalty_pass(penalty_program_, v.trial, nullptr);
    map_passes(gradient_, gradient_targets_, [&] {
        v.trial.bind(5);
        sums_.gradient.layers.bind(11);
    });
    if (diagonal)
        map_passes(precondition_, fresh_targets_, [&] {
            v.trial.bind(5);
            sums_.diagonal.layers.bind(11);
        });
}

void TexelFragmentEngine::project(Rule rule, bool fresh) {
    const Vectors& v = vectors_;
    v.trial_g.bind(1);
    v.g.bind(2);
    v.d.bind(3);
    (fresh ? v.fresh : v.precondition).bind(4);
    dots_.set(18, rule == Rule::cg_modern ? 1 : 0);
    run_->bind(products_target_, dots_);
    run_->draw_whole();
}

// One fragment per texel, between the reads and the writes of its state.
void TexelFragmentEngine::after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
    after_direction_.set(20, int(rule));
    after_direction_.set(21, restart ? 1 : 0);
    after_direction_.set2(22, stop.residual, stop.output_change);
    sums_.gradient.layers.bind(11);
    products_.bind(14);
    update_states(after_direction_, state_target_);
}

void TexelFragmentEngine::after_line(Rule rule, ProblemText<float>::StopRules stop) {
    after_line_.set(20, int(rule));
    after_line_.set2(22, stop.residual, stop.output_change);
    sums_.line.layers.bind(11);
    update_states(after_line_, line_target_);
}

void TexelFragmentEngine::update_states(const Program& program, const Framebuffer& target) {
    gl().TextureBarrier();
    state_.bind(9);
    alpha_.bind(10);
    density_.bind(12);
    penalty_.bind(13);
    run_->bind(target, program);
    run_->draw_whole();
    gl().TextureBarrier();
}

void TexelFragmentEngine::update_direction(Rule rule, bool fresh) {
    const Vectors& v = vectors_;
    update_.set(18, rule == Rule::cg_modern ? 1 : 0);
    update_.set(19, rule == Rule::cg_modern && fresh ? 1 : 0);
    gl().TextureBarrier();
    map_passes(update_, update_targets_, [&] {
        unsigned unit = 0;
        for (const TexelVector* x : {&v.p, &v.trial, &v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d})
            x->bind(unit++);
    });
    gl().TextureBarrier();
}

void TexelFragmentEngine::line_pass() {
    const Vectors& v = vectors_;
    sums_.line.clear(*run_);
    sweep([&](const std::vector<ImageOnDevice>& images) { passes_->line(images, v.p, v.d); });
    penalty_pass(penalty_curvature_, v.p, &v.d);
}

void TexelFragmentEngine::advance() {
    map_passes(advance_, trial_targets_, [&] {
        vectors_.p.bind(0);
        vectors_.d.bind(6);
    });
}

EngineSummary TexelFragmentEngine::summary() const {
    using real = float;
    const std::vector<float> error = field(0), accepted = field(5), status = field(6);
    EngineSummary sum;
    for (size_t i = 0; i < error.size(); ++i) {
        sum.active += status[i] == float(Status::active);
        sum.accepted += accepted[i] != 0;
        if (error[i] < HUGE_ERROR) sum.error += double(error[i]);  // else never evaluated, or not finite
    }
    return sum;
}

void TexelFragmentEngine::outcomes(std::span<ProblemOutcome> out) const {
    using real = float;
    const std::vector<float> error = field(0), status = field(6), iterations = field(7);
    for (size_t i = 0; i < error.size(); ++i) {
        out[i] = {error[i] < HUGE_ERROR ? error[i] : 0, Status(int(status[i])), uint32_t(iterations[i])};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

void TexelFragmentEngine::read_errors(std::span<float> out) const {
    const std::vector<float> error = field(0);
    std::copy(error.begin(), error.end(), out.begin());
}

void TexelFragmentEngine::read_parameters(std::span<float> out) const { vectors_.p.download(shape_, out); }

TexelFragmentEngine::Evaluation TexelFragmentEngine::read_evaluation() const {
    Evaluation result;
    const std::vector<float> squares = read_texels(shape_, sums_.gradient.layers, 3),
                             density = read_texels(shape_, density_, 0), penalty = read_texels(shape_, penalty_, 0);
    for (size_t i = 0; i < squares.size(); ++i) result.error.push_back(0.5f * density[i] * squares[i] + penalty[i]);
    result.gradient.resize(parameter_count());
    result.diagonal.resize(parameter_count());
    vectors_.trial_g.download(shape_, result.gradient);
    vectors_.fresh.download(shape_, result.diagonal);
    return result;
}

void TexelFragmentEngine::set_line(std::span<const float> p, std::span<const float> d) {
    vectors_.p.upload(shape_, p);
    vectors_.d.upload(shape_, d);
}

TexelFragmentEngine::Line TexelFragmentEngine::read_line() const {
    const std::vector<float> density = read_texels(shape_, density_, 0), penalty = read_texels(shape_, penalty_, 0);
    const auto sums = [&](int channel) {
        std::vector<float> out = read_texels(shape_, sums_.line.layers, channel);
        for (size_t i = 0; i < out.size(); ++i) out[i] = density[i] * out[i] + penalty[i];
        return out;
    };
    return {sums(0), sums(1)};
}

const FragmentTimes& TexelFragmentEngine::times() const {
    static_cast<SweepTimes&>(times_) = images_.times();
    times_.counters = run_->counters;
    return times_;
}

}  // namespace radiafit
