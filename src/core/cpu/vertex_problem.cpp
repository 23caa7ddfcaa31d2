#include "cpu/vertex_problem.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "cpu/ring_samples.h"

namespace radiafit {

VertexProblem::VertexProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const std::vector<uint32_t>& views, const LfmOptions& options)
    : atlas_(&atlas),
      rings_(&rings),
      options_((check_options(options), options)),
      objective_(options),
      frames_(std::make_shared<const std::vector<Frame>>(vertex_frames(atlas.mesh()))) {
    for (uint32_t view : views) centers_.push_back(dataset.views[view].camera.center());
}

/// Loads all but the samples and their groups.
void VertexProblem::take_maps(size_t v, uint32_t samples, const float* mean) {
    samples_ = samples;
    sides_.clear();
    tiles_.clear();
    first_texels_.clear();
    weights_.clear();
    for (const Corner& corner : rings_->ring(v)) {
        const TriangleTile& tile = atlas_->tile(corner.triangle);
        sides_.push_back(uint8_t(tile.side()));
        tiles_.push_back(&tile);
        first_texels_.push_back(uint32_t(weights_.size()));
        for (uint32_t local = 0; local < tile.texels(); ++local)
            weights_.push_back(broadcast3(tile.barycentric(local)[corner.corner]));
    }
    size_ = size_t(options_.terms) * (texels(0) + size_t(options_.view_side) * size_t(options_.view_side));
    std::copy_n(mean, 3, mean_);
    scale_ = objective_.scale(texels(0), samples_, mean_);
    targets_.resize(samples_);
    texels_.resize(samples_);
}

VertexProblem::Group VertexProblem::group(size_t v, uint32_t image, uint32_t first) const {
    const Vec3f& position = atlas_->mesh().positions[v];
    const Frame& frame = (*frames_)[v];
    const ViewFootprint f = view_footprint(frame, position, centers_[image], options_.view_side, options_.lookup);
    return {first,
            {f.texel, {f.weight[0], f.weight[1], f.weight[2], f.weight[3]}},
            float(view_weight(frame, position, centers_[image], options_.loss.weights))};
}

void VertexProblem::load(size_t v, const DiskRecords& records, const uint8_t* block) {
    const VertexRecord& record = records.vertex(v);
    take_maps(v, record.samples, record.mean);
    groups_.clear();
    uint32_t first = 0;
    for (uint32_t g = 0; g < record.images; ++g) {
        RecordGroup on_disk;
        std::memcpy(&on_disk, block + g * sizeof on_disk, sizeof on_disk);
        groups_.push_back(group(v, on_disk.image, first));
        first += on_disk.samples;
    }
    groups_.push_back({first, {}, 0});
    const uint8_t* samples = block + record.images * sizeof(RecordGroup);
    records.kind() == RecordKind::full ? take_full(samples) : take_compact(records, record, samples);
}

void VertexProblem::load(size_t v, const SampleList& list, const float* mean) {
    const auto ring = rings_->ring(v);
    std::vector<uint32_t> next, end;  // groups of the ring's triangles that are still to come
    uint64_t samples = 0;
    for (const Corner& corner : ring) {
        next.push_back(list.tile_groups[corner.triangle]);
        end.push_back(list.tile_groups[corner.triangle + 1]);
        samples += list.groups[end.back()].first - list.groups[next.back()].first;
    }
    take_maps(v, uint32_t(samples), mean);
    groups_.clear();
    uint32_t at = 0;
    for (;;) {
        uint32_t image = ~0u;
        for (size_t p = 0; p < ring.size(); ++p)
            if (next[p] < end[p]) image = std::min(image, list.groups[next[p]].image);
        if (image == ~0u) break;
        groups_.push_back(group(v, image, at));
        for (size_t p = 0; p < ring.size(); ++p) {
            if (next[p] == end[p] || list.groups[next[p]].image != image) continue;
            for (const Sample& sample : list.of_group(next[p]++)) {
                const uint32_t place = texels_[at] = first_texels_[p] + sample.local;
                targets_[at++] = weights_[place] * (list.scale * load_sample<float>(&sample));
            }
        }
    }
    groups_.push_back({at, {}, 0});
}

namespace {

using Colour8 = uint8_t __attribute__((vector_size(4)));
using Colour16 = uint16_t __attribute__((vector_size(8)));
using Widened = int32_t __attribute__((vector_size(16)));

/// Three channels in 16 bits, as every engine's targets are, and in the fourth lane anything. Four bytes are read.
Lanes<float> colour(const uint8_t* from, uint8_t) {
    Colour8 rgb;
    std::memcpy(&rgb, from, sizeof rgb);
    return 257.0f * __builtin_convertvector(__builtin_convertvector(rgb, Widened), Lanes<float>);
}
Lanes<float> colour(const uint8_t* from, uint16_t) {
    uint32_t rg;
    uint16_t b;
    std::memcpy(&rg, from, sizeof rg);
    std::memcpy(&b, from + sizeof rg, sizeof b);
    const auto rgb = std::bit_cast<Colour16>(uint64_t(rg) | uint64_t(b) << 32);
    return __builtin_convertvector(__builtin_convertvector(rgb, Widened), Lanes<float>);
}

}  // namespace

void VertexProblem::take_compact(const DiskRecords& records, const VertexRecord& record, const uint8_t* from) {
    const auto take = [&]<class Channel, int texel_bytes>(Channel channel, std::integral_constant<int, texel_bytes>) {
        constexpr size_t rgb_bytes = 3 * sizeof channel;
        static_assert(rgb_bytes + texel_bytes >= 4);
        for (uint32_t i = 0; i < samples_; ++i, from += rgb_bytes + texel_bytes) {
            uint32_t place = 0;
            std::memcpy(&place, from + rgb_bytes, texel_bytes);
            texels_[i] = place;
            targets_[i] = weights_[place] * (records.scale() * colour(from, channel));
        }
    };
    const auto by_bits = [&](auto bytes) { records.bits() == 8 ? take(uint8_t{}, bytes) : take(uint16_t{}, bytes); };
    switch (record.texel_bytes) {
        case 1:
            return by_bits(std::integral_constant<int, 1>{});
        case 2:
            return by_bits(std::integral_constant<int, 2>{});
        default:
            return by_bits(std::integral_constant<int, 4>{});
    }
}

// Everything comes from the record itself, as in the paper: also where a sample falls in the vertex's view map.
void VertexProblem::take_full(const uint8_t* from) {
    for (size_t g = 0; g + 1 < groups_.size(); ++g)
        for (uint32_t i = groups_[g].first; i < groups_[g + 1].first; ++i, from += sizeof(FullRecord)) {
            FullRecord full;
            std::memcpy(&full, from, sizeof full);
            const auto position = static_cast<uint32_t>(full.surface[0]);
            const TriangleTile& tile = *tiles_[position];
            const float n = float(tile.side());
            const int column = int((full.surface[0] - float(position)) * n), row = int(full.surface[1] * n);
            texels_[i] = first_texels_[position] + tile.local_of_cell(column, row);
            targets_[i] = weights_[texels_[i]] * V{full.target[0], full.target[1], full.target[2], 0};
            if (i > groups_[g].first) continue;
            const ViewFootprint f =
                view_footprint({full.view[0][0], full.view[0][1]}, options_.view_side, options_.lookup);
            groups_[g].footprint = {f.texel, {f.weight[0], f.weight[1], f.weight[2], f.weight[3]}};
        }
}

void VertexProblem::direction(size_t, const V* x, V* gradient, V* diagonal, double error[3]) const {
    const size_t size = size_, view = texels(0) * size_t(options_.terms);
    std::fill(gradient, gradient + size, V{});
    if (diagonal) std::fill(diagonal, diagonal + size, V{});
    Lanes<double> data{};
    const auto sum = [&](auto kernel) {
        for (size_t g = 0; g + 1 < groups_.size(); ++g) {
            kernel.begin(groups_[g].footprint, x + view, groups_[g].weight);
            kernel.add(of_group(g), x, gradient, diagonal);
            kernel.end(groups_[g].footprint, gradient + view, diagonal ? diagonal + view : nullptr, data);
        }
    };
    with_kernels(options_, [&](auto terms, auto loss) {
        if (diagonal)
            sum(DirectionKernel<float, terms, true, decltype(loss)>(options_.terms, options_.view_side, loss));
        else
            sum(DirectionKernel<float, terms, false, decltype(loss)>(options_.terms, options_.view_side, loss));
    });
    objective_.finish_direction(scale_, sides_, x, gradient, diagonal, data);
    for (int c = 0; c < 3; ++c) error[c] = data[c];
}

void VertexProblem::line(size_t, const V* x, const V* d, LineLanes& sums) const {
    sums = {};
    const size_t view = texels(0) * size_t(options_.terms);
    with_kernels(options_, [&](auto terms, auto loss) {
        LineKernel<float, terms, decltype(loss)> kernel(options_.terms, options_.view_side, loss);
        for (size_t g = 0; g + 1 < groups_.size(); ++g) {
            kernel.begin(groups_[g].footprint, x + view, d + view, groups_[g].weight);
            kernel.add(of_group(g), x, d);
            kernel.end(sums);
        }
    });
    objective_.finish_line(scale_, sides_, x, d, sums);
}

uint64_t VertexProblem::working_set_bytes() const {
    return targets_.size() * (sizeof(V) + sizeof(uint32_t)) + groups_.size() * sizeof(Group) + 7 * size_ * sizeof(V);
}

}  // namespace radiafit
