#include "sg/solve_sg.h"

#include <algorithm>

#include "base/parallel.h"
#include "cpu/texel_fit_impl.h"
#include "sg/sg_text.h"
#include "viewbasis/finish_tiles.h"
#include "viewbasis/texel_views.h"

namespace radiafit::fits {
namespace {

// Standard deviations that the prior takes parameters to have.
constexpr double of_diffuse = 0.15, of_lobe = 0.13, of_axis = 1, of_sharpness = 1;

/// One thread's room for a tile.
template <int lobes>
class TileSolver {
public:
    TileSolver(const TriangleAtlas& atlas, const SampleList& samples, const TexelViewReader& reader, const Vec3f& up,
               const SgOptions& options)
        : atlas_(atlas), samples_(samples), reader_(reader), up_(up), fit_({.iterations = options.iterations}) {
        const auto weight = [&](double deviation) { return options.noise / (deviation * deviation); };
        prior_.weight.fill(weight(of_lobe));
        prior_.weight[0] = weight(of_diffuse);
        for (size_t i = 0; i < prior_.shape_weight.size(); ++i) {
            prior_.shape_weight[i] = weight(i % 3 == 2 ? of_sharpness : of_axis);
            prior_.shape_mean[i] = i % 3 == 2 ? std::log(5.0) : 0;
        }
    }

    /// elsewhere: the colour of a triangle that no image shows.
    void solve(uint32_t tile, const Vec3f& elsewhere, SgSolution& out) {
        const uint32_t first = tile * atlas_.texels_per_tile(), texels = atlas_.tile(tile).texels();
        const Vec3f mean = read(tile, texels, elsewhere);
        for (size_t c = 0; c < 3; ++c) prior_.mean[c][0] = double(mean[Eigen::Index(c)]);
        for (uint32_t begin = 0; begin < texels; begin += lanes) {
            const auto outcomes = fit_.solve(batches_[begin / lanes], nullptr, &prior_);
            for (uint32_t l = begin; l < std::min(begin + lanes, texels); ++l) {
                const auto& o = outcomes[l % lanes];
                float* p = std::copy(o.parameters.begin(), o.parameters.end(), &out.parameters[(first + l) * N]) - N;
                if (o.samples == 0) std::copy_n(mean.data(), 3, p);
                out.samples[first + l] = o.samples;
                out.iterations[first + l] = uint32_t(o.iterations);
                out.error[first + l] = float(o.error);
                out.status[first + l] = o.status;
            }
        }
    }

private:
    using Text = texel_text::SphericalGaussians<Pack, lobes>;
    using Fit = TexelFit<Text>;
    static constexpr uint32_t lanes = Pack::size;
    static constexpr size_t N = size_t(Fit::Model::parameters);

    /// Fills the batches; the mean colour of what was seen.
    Vec3f read(uint32_t tile, uint32_t texels, const Vec3f& elsewhere) {
        const uint32_t first = tile * atlas_.texels_per_tile();
        if (batches_.size() * lanes < texels) batches_.resize((texels + lanes - 1) / lanes);
        for (auto& batch : batches_) batch.clear();
        frames_.resize(texels);
        positions_.resize(texels);
        for (uint32_t l = 0; l < texels; ++l) {
            frames_[l] = view_frame(atlas_.normal(first + l), up_);
            positions_[l] = atlas_.position(first + l);
        }
        Vec3f sum = Vec3f::Zero();
        float weights = 0;
        for (uint32_t g = samples_.tile_groups[tile]; g < samples_.tile_groups[tile + 1]; ++g) {
            const Vec3f& eye = reader_.eye(samples_.groups[g].image);
            for (const Sample& s : samples_.of_group(g)) {
                const Vec3f v = view_direction(frames_[s.local], positions_[s.local], eye);
                const Vec3f colour = samples_.scale * Vec3f(s.rgb[0], s.rgb[1], s.rgb[2]);
                const float weight = view_sample_weight(v);
                batches_[s.local / lanes].push(int(s.local % lanes),
                                               {{v.x(), v.y(), v.z()}, {colour.x(), colour.y(), colour.z()}, weight});
                sum += weight * colour;
                weights += weight;
            }
        }
        return weights > 0 ? Vec3f(sum / weights) : elsewhere;
    }

    const TriangleAtlas& atlas_;
    const SampleList& samples_;
    const TexelViewReader& reader_;
    Vec3f up_;
    Fit fit_;
    typename Fit::Prior prior_;
    std::vector<typename Fit::Batch> batches_;
    std::vector<Frame> frames_;
    std::vector<Vec3f> positions_;
};

ColourSum sum_of(const SampleList& samples) {
    ColourSum sum;
    sum.scale = samples.scale;
    sum.samples = samples.samples.size();
    for (const Sample& s : samples.samples)
        for (size_t c = 0; c < 3; ++c) sum.rgb[c] += s.rgb[c];
    return sum;
}

template <int lobes>
void solve_tiles(const TriangleAtlas& atlas, const SampleList& samples, const TexelViewReader& reader, const Vec3f& up,
                 const SgOptions& options, Journal* journal, SgSolution& out) {
    std::vector<TileSolver<lobes>> solvers(size_t(thread_count()), {atlas, samples, reader, up, options});
    out.colours = sum_of(samples);
    const Vec3f elsewhere = out.colours.mean();
    finish_tiles(
        journal, atlas,
        [&](auto& visit, size_t texel, size_t count) {
            const size_t numbers = size_t(sg_parameters(lobes));
            visit(std::span(out.parameters).subspan(texel * numbers, count * numbers));
            visit(std::span(out.samples).subspan(texel, count));
            visit(std::span(out.iterations).subspan(texel, count));
            visit(std::span(out.error).subspan(texel, count));
            visit(std::span(out.status).subspan(texel, count));
        },
        [&](uint32_t tile, int worker) { solvers[size_t(worker)].solve(tile, elsewhere, out); });
}

}  // namespace

void check_options(const SgOptions& options) {
    radiafit::require("lobes", options.lobes, limits::lobes);
    radiafit::require("noise", options.noise, limits::lobe_noise);
}

void ColourSum::add(const ColourSum& other) {
    for (size_t c = 0; c < 3; ++c) rgb[c] += other.rgb[c];
    samples += other.samples;
    scale = other.scale;
}

Vec3f ColourSum::mean() const {
    const Vec3d sum{double(rgb[0]), double(rgb[1]), double(rgb[2])};
    return (double(scale) / double(std::max<uint64_t>(1, samples)) * sum).cast<float>();
}

void colour_unseen(const TriangleAtlas& atlas, std::span<const uint32_t> samples, int lobes, const Vec3f& colour,
                   std::vector<float>& parameters) {
    const size_t n = size_t(sg_parameters(lobes)), per_tile = atlas.texels_per_tile();
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
        const auto seen = samples.subspan(tile * per_tile, per_tile);
        if (atlas.degenerate(tile) || std::ranges::any_of(seen, [](uint32_t count) { return count > 0; })) continue;
        for (size_t texel = tile * per_tile; texel < tile * per_tile + atlas.tile(tile).texels(); ++texel)
            std::copy_n(colour.data(), 3, &parameters[texel * n]);
    }
}

SgSolution solve_sg(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples, const Vec3f& up,
                    const SgOptions& options, Journal* journal) {
    check_options(options);
    const size_t texels = atlas.texel_count();
    SgSolution out;
    out.parameters.assign(texels * size_t(sg_parameters(options.lobes)), 0.0f);
    out.samples.assign(texels, 0);
    out.iterations.assign(texels, 0);
    out.error.assign(texels, 0.0f);
    out.status.assign(texels, Status::no_samples);
    const TexelViewReader reader(dataset, atlas, samples, up);
    constexpr decltype(&solve_tiles<1>) solvers[] = {solve_tiles<1>, solve_tiles<2>, solve_tiles<3>, solve_tiles<4>};
    solvers[options.lobes - 1](atlas, samples, reader, up, options, journal, out);
    return out;
}

}  // namespace radiafit::fits
