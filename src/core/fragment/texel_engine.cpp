#include "fragment/texel_engine.h"

#include "dataset/encoding.h"

namespace radiafit {

TexelFragmentEngine::TexelFragmentEngine(const Dataset& dataset, const Atlas& atlas, std::vector<uint32_t> views,
                                         const TexelOptions& options, const FragmentOptions& fragment_options)
    : dataset_((require_lights(dataset), &dataset)),
      options_((check_options(options), options)),
      storage_(fragment_options.storage),
      shape_(atlas, *options.model, options.loss),
      images_(dataset, std::move(views), fragment_options.source, TargetSpace::linear,
              fragment_options.keep_on_device) {
    if (const auto* triangles = dynamic_cast<const TriangleAtlas*>(&atlas)) {
        mesh_.emplace(*triangles);
        run_.emplace(*mesh_);
    } else {
        run_.emplace();
    }
    const auto single = [&](int layers) { return Texture(GL_RGBA32F, shape_.width(), shape_.height(), layers); };
    surface_ = single(2);
    for (Texture* texture : {&inverse_samples_, &penalty_})
        *texture = Texture(GL_R32F, shape_.width(), shape_.height());
    numbers_ = std::make_unique<ProblemNumbers>(*run_, shape_.width(), shape_.height(), shape_.texels(), shape_.place,
                                                "texels", fragment_options.passes == Passes::r300);
    make_room({});
    if (fragment_options.passes == Passes::r300) make_spares();
    const GLenum summed = sums_format(fragment_options.sums);
    sums_.gradient = TexelSumLayers(summed, shape_, shape_.maps());
    sums_.diagonal = TexelSumLayers(summed, shape_, shape_.diagonal_layers());
    sums_.line = TexelSumLayers(summed, shape_, 1);
    sums_.count = TexelSumLayers(GL_RGBA32F, shape_, 2);

    const TexelPassResources resources{shape_,
                                       mesh_ ? &*mesh_ : nullptr,
                                       *run_,
                                       surface_,
                                       sums_,
                                       dataset,
                                       images_,
                                       storage_,
                                       has_largest_value(dataset.encoding) ? options_.clip_above : 0};
    passes_ = fragment_options.passes == Passes::combined
                  ? make_combined_texel_passes(resources, fragment_options.images_per_pass)
                  : make_paper_texel_passes(resources);
    images_.set_batch(passes_->batch());

    penalty_target_ = Framebuffer({{&penalty_}});
    const auto whole = [&](const char* shader, const Defines& what = {}) {
        return Program::draw("common/whole.vert", std::string("reflect/") + shader, shape_.defines(storage_) + what);
    };
    penalty_program_ = whole("penalty.frag");
    penalty_curvature_ = whole("penalty.frag", {{"ALONG", ""}});
    gradient_ = whole("gradient.frag");
    precondition_ = whole("precondition.frag");
    dot_ = Program::draw("common/whole.vert", "optimize/dot.frag",
                         {{"STORAGE", std::to_string(int(storage_))},
                          {"TERMS", std::to_string(shape_.maps())},
                          {"TOGETHER", ""},
                          {"VIEW_MAPS", ""}});  // as view maps, these are layers of one texture
    for (const Update which : {Update::update_direction, Update::advance}) update_programs(which);
    for (const Program* program : {&penalty_program_, &penalty_curvature_, &gradient_}) set_bounds(*program);
    gradient_.bind("sample_sums", sums_.gradient.layers);
    precondition_.bind("sample_sums", sums_.diagonal.layers);
    for (const Program* program : {&gradient_, &precondition_}) program->bind("inverse_samples", inverse_samples_);
    write_surface(shape_, {}, surface_);
    count_bytes();
}

void TexelFragmentEngine::set_bounds(const Program& program) const {
    const MapBounds bounds(shape_);
    program.set("mu", options_.mu);
    program.set("paper_penalty", options_.mode == Mode::paper);
    program.set("lowest", std::span<const float>(bounds.lowest));
    program.set("highest", std::span<const float>(bounds.highest));
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
    write_surface(shape_, darkness, surface_);
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
    std::vector<float> inverse_samples(texels);
    for (const float n : read_texels(shape_, sums_.count.layers, 0, 1)) statistics.samples.push_back(uint32_t(n));
    for (size_t texel = 0; texel < texels; ++texel)
        inverse_samples[texel] = statistics.samples[texel] ? 1 / float(statistics.samples[texel]) : 0.0f;
    write_texels(shape_, inverse_samples, inverse_samples_);
    sample_counts_ = statistics.samples;
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

void TexelFragmentEngine::make_products(int count) {
    if (products_ && products_.layers() == count) return;
    product_targets_.clear();
    products_ = Texture(GL_R32F, shape_.width(), shape_.height(), count);
    for (int layer = 0; layer < count; ++layer) product_targets_.push_back(Framebuffer({{&products_, layer}}));
}

const std::vector<Program>& TexelFragmentEngine::update_programs(Update which) {
    std::vector<Program>& programs = updates_[which];
    if (programs.empty())
        for (const Defines& result : result_defines(updates[int(which)].written, !spares_.empty()))
            programs.push_back(
                make_update(which, "common/whole.vert", "texel_elements", shape_.defines(storage_) + result));
    return programs;
}

const std::vector<Framebuffer>& TexelFragmentEngine::targets(std::span<const TexelVector* const> vectors) {
    TextureList names{};
    std::ranges::transform(vectors, names.begin(), [](const TexelVector* x) { return x->maps().name(); });
    std::vector<Framebuffer>& targets = targets_[names];
    for (int map = int(targets.size()); map < shape_.maps(); ++map) {
        std::vector<Target> colours;
        for (const TexelVector* x : vectors) colours.push_back(x->target(map));
        targets.push_back(Framebuffer(colours));
    }
    return targets;
}

void TexelFragmentEngine::penalty_pass(const Program& program, const TexelVector& x) {
    program.bind("parameters", x.maps());
    run_->draw_whole(penalty_target_, program);
}

// A pass for each map into targets [map].
void TexelFragmentEngine::map_passes(const Program& program, const std::vector<Framebuffer>& targets) {
    for (int map = 0; map < shape_.maps(); ++map) {
        program.set_if_used("map", map);
        run_->draw_whole(targets[size_t(map)], program);
    }
}

void TexelFragmentEngine::gradient_pass(bool diagonal) {
    const TexelVector& trial = vectors_[vector::trial];
    sums_.gradient.clear(*run_);
    if (diagonal) sums_.diagonal.clear(*run_);
    sweep([&](const std::vector<ImageOnDevice>& images) { passes_->gradient_pass(images, trial, diagonal); });
    penalty_pass(penalty_program_, trial);
    for (const Program* program : {&gradient_, &precondition_}) program->bind_if_used("parameters", trial.maps());
    map_passes(gradient_, targets({{&vectors_[vector::trial_g]}}));
    if (diagonal) map_passes(precondition_, targets({{&vectors_[vector::fresh]}}));
}

void TexelFragmentEngine::directional_pass() {
    const TexelVector &p = vectors_[vector::p], &d = vectors_[vector::d];
    sums_.line.clear(*run_);
    sweep([&](const std::vector<ImageOnDevice>& images) { passes_->directional_pass(images, p, d); });
    penalty_curvature_.bind("direction", d.maps());
    penalty_pass(penalty_curvature_, p);
}

void TexelFragmentEngine::dot(std::initializer_list<DotProduct> products) {
    for (const DotProduct& product : products) {
        const bool weighted = product.weight != vector::none;
        dot_.bind("left", vectors_[size_t(product.a)].maps());
        dot_.bind("right", vectors_[size_t(product.b)].maps());
        dot_.bind("weights", vectors_[size_t(weighted ? product.weight : product.a)].maps());
        dot_.set("weighted", weighted);
        run_->draw_whole(product_targets_[size_t(product.into)], dot_);
    }
}

void TexelFragmentEngine::step(Step which, const Turn& turn) {
    for (const Program& program : numbers_->programs(which, turn)) {
        program.bind_if_used("gradient_sums", sums_.gradient.layers);
        program.bind_if_used("inverse_samples", inverse_samples_);
        program.bind_if_used("penalties", penalty_);
        program.bind_if_used("line_sums", sums_.line.layers);
        program.bind_if_used("products", products_);
    }
    numbers_->step(which, turn);
}

void TexelFragmentEngine::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                                 std::initializer_list<float> constants) {
    const std::span<const int> list(vectors);
    const size_t count = size_t(updates[int(which)].written);
    std::array<const TexelVector*, MOST_VECTORS> written{};
    for (size_t k = 0; k < count; ++k) written[k] = spares_.empty() ? &vectors_[size_t(list[k])] : &spares_[k];
    const std::vector<Program>& programs = update_programs(which);
    gl().TextureBarrier();
    for (size_t i = 0; i < programs.size(); ++i) {
        numbers_->set_update(programs[i], products_, numbers, constants);
        for (size_t k = 0; k < list.size(); ++k) programs[i].bind("vectors", vectors_[size_t(list[k])].maps(), k);
        map_passes(programs[i], targets(std::span(written).subspan(i, count / programs.size())));
    }
    gl().TextureBarrier();
    exchange_spares(which, list);
}

std::vector<float> TexelFragmentEngine::trial_errors() const {
    std::vector<float> errors = read_texels(shape_, sums_.gradient.layers, 3);
    const std::vector<float> inverse_samples = read_texels(shape_, inverse_samples_, 0),
                             penalty = read_texels(shape_, penalty_, 0);
    for (size_t i = 0; i < errors.size(); ++i) errors[i] = 0.5f * inverse_samples[i] * errors[i] + penalty[i];
    return errors;
}

TexelFragmentEngine::Line TexelFragmentEngine::read_line() const {
    const std::vector<float> inverse_samples = read_texels(shape_, inverse_samples_, 0),
                             penalty = read_texels(shape_, penalty_, 0);
    const auto sums = [&](int channel) {
        std::vector<float> out = read_texels(shape_, sums_.line.layers, channel);
        for (size_t i = 0; i < out.size(); ++i) out[i] = inverse_samples[i] * out[i] + penalty[i];
        return out;
    };
    return {sums(0), sums(1), {}, {}};
}

}  // namespace radiafit
