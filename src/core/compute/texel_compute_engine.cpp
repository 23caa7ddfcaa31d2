#include "compute/texel_compute_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "dataset/encoding.h"
#include "dataset/image_stream.h"
#include "fragment/texel_passes.h"

namespace radiafit {

TexelComputeEngine::TexelComputeEngine(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                                       const TexelOptions& options, const TexelSource& source)
    : options_((require_lights(dataset), check_options(options), options)),
      shape_(atlas, *options.model, options.loss),
      wide_(!has_largest_value(dataset.encoding) || options.curve != ValueCurve::linear),
      unit_(wide_ ? 1 : ImageStream(dataset, StreamSource::disk, TargetSpace::linear).scale16()),
      surface_(GL_RGBA32F, shape_.width(), shape_.height(), 2) {
    make({.problems = "texels_given",
          .problem_count = shape_.texels(),
          .given_bytes = shape_.texels() * 16,
          .vec4s = shape_.texels() * size_t(shape_.maps()),
          .product_bytes = shape_.texels() * sizeof(float),
          .texels = &shape_});
    write_surface(shape_, {}, surface_);
    upload_samples(dataset, views, source);
    std::vector<float> numbers;
    for (const uint32_t view : views) {
        const auto of_view = view_numbers(dataset.views[view], unit_, 0);
        numbers.insert(numbers.end(), of_view.begin(), of_view.end());
    }
    views_ = FetchedBuffer("views", GL_RGBA32F, numbers.size() * sizeof(float), numbers.data());
    for (const bool diagonal : {false, true}) {
        const Program& gradient = gradient_passes_[diagonal] =
            program("texel_gradient.comp", diagonal ? Defines{{"DIAGONAL", ""}} : Defines{});
        gradient.bind("trial", vectors_[vector::trial].texture);
        gradient.bind("Gradient", vectors_[vector::trial_g].buffer);
        gradient.bind_if_used("Fresh", vectors_[vector::fresh].buffer);
    }
    line_ = program("texel_line.comp", {});
    line_.bind("point", vectors_[vector::p].texture);
    line_.bind("direction", vectors_[vector::d].texture);
    compile("texel_", numbers_->groups(shape_.texels()));
    count_bytes();
}

void TexelComputeEngine::upload_samples(const Dataset& dataset, const std::vector<uint32_t>& views,
                                        const TexelSource& source) {
    constexpr size_t most_images = 65535;  // in 16 bits
    if (!wide_ && views.size() > most_images)
        throw UserError(
            fmt::format("{} images are more than the {} that compute shaders count to here; choose another "
                        "engine",
                        views.size(), most_images));
    const TexelLoader loader(dataset, *shape_.atlas, views, options_);
    const TexelShading shading(dataset, views);
    const size_t texels = shape_.texels();
    statistics_.samples.assign(texels, 0);
    statistics_.mean.assign(3 * texels, 0.0f);
    std::vector<std::vector<TexelRadiance>> counted(texels);
    parallel_for(source.block_count(), 1, [&](size_t block, int) {
        TexelSamples samples;
        std::vector<ShadedSample> shaded;
        std::vector<uint32_t> which;
        const uint32_t begin = uint32_t(block) * TexelSource::block;
        source.read(begin, samples);
        for (size_t i = 0; i + 1 < samples.first.size(); ++i) {
            const size_t texel = begin + i;
            const auto all = samples.of(i);
            loader.load(uint32_t(texel), all, shaded, &which);
            for (const uint32_t w : which) counted[texel].push_back(all[w]);
            if (options_.curve != ValueCurve::linear) {  // what the shaders divide by the irradiance
                const auto place = TexelShading::place(*shape_.atlas, uint32_t(texel));
                for (size_t s = 0; s < shaded.size(); ++s) {
                    TexelRadiance& sample = counted[texel][s];
                    const Vec3f irradiance = shading.lit(place, sample.image).irradiance;
                    for (int c = 0; c < 3; ++c) sample.value[c] = shaded[s].target[c] * irradiance[c];
                }
            }
            statistics_.samples[texel] = uint32_t(which.size());
            const Vec3f albedo = lambertian_albedo(shaded);
            for (int c = 0; c < 3; ++c) statistics_.mean[3 * texel + size_t(c)] = albedo[c];
        }
    });
    std::vector<std::array<uint32_t, 4>> rows(texels);
    std::vector<uint32_t> words;
    const size_t each = wide_ ? 4 : 2, lanes = numbers_->lanes();
    for (size_t begin = 0; begin < texels; begin += lanes) {
        const size_t width = std::min(lanes, texels - begin), first = words.size() / each;
        size_t most = 0;
        for (size_t i = 0; i < width; ++i) most = std::max(most, counted[begin + i].size());
        words.resize(words.size() + most * width * each);
        for (size_t i = 0; i < width; ++i) {
            const size_t texel = begin + i;
            rows[texel] = {shape_.place[texel], uint32_t(counted[texel].size()), uint32_t(first + i), uint32_t(width)};
            for (size_t s = 0; s < counted[texel].size(); ++s) {
                const TexelRadiance& sample = counted[texel][s];
                uint32_t* word = &words[(first + s * width + i) * each];
                if (wide_) {
                    for (int c = 0; c < 3; ++c) word[c] = std::bit_cast<uint32_t>(sample.value[c]);
                    word[3] = sample.image;
                } else {
                    uint32_t units[3];
                    for (int c = 0; c < 3; ++c)
                        units[c] = uint32_t(std::clamp(std::lround(sample.value[c] / unit_), 0l, 65535l));
                    word[0] = units[0] | units[1] << 16;
                    word[1] = units[2] | sample.image << 16;
                }
            }
            counted[texel] = {};
        }
    }
    sample_counts_ = statistics_.samples;
    texels_ = FetchedBuffer("texels", GL_RGBA32UI, rows.size() * sizeof rows[0], rows.data());
    samples_ = FetchedBuffer("samples", wide_ ? GL_RGBA32UI : GL_RG32UI, words.size() * sizeof words[0], words.data());
}

Program TexelComputeEngine::program(const std::string& file, const Defines& more) const {
    const Defines wide = wide_ ? Defines{{"WIDE", ""}} : Defines{};
    Program made =
        Program::compute("compute/" + file, numbers_->defines() + shape_.defines(Storage::fp32) + wide + more);
    numbers_->bind_to(made);
    made.set_if_used("texel_count", int(shape_.texels()));
    made.set_if_used("surface_width", shape_.width());
    made.bind_if_used("texels", texels_.texture);
    made.bind_if_used("texel_samples", samples_.texture);
    made.bind_if_used("views", views_.texture);
    made.bind_if_used("surface", surface_);
    const MapBounds bounds(shape_);
    made.set_if_used("mu", options_.mu);
    made.set_if_used("paper_penalty", int(options_.mode == Mode::paper));
    made.set_if_used("lowest", std::span<const float>(bounds.lowest));
    made.set_if_used("highest", std::span<const float>(bounds.highest));
    return made;
}

std::vector<float> TexelComputeEngine::read_given(size_t which) const {
    std::vector<float> all(shape_.texels() * 4), out;
    numbers_->given().read(0, all.size() * sizeof(float), all.data());
    for (size_t texel = 0; texel < shape_.texels(); ++texel) out.push_back(all[4 * texel + which]);
    return out;
}

}  // namespace radiafit
