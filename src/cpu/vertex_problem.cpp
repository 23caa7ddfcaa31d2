#include "cpu/vertex_problem.h"

#include <algorithm>
#include <cstring>

namespace radiafit {

VertexProblem::VertexProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const DiskRecords& records, const LfmOptions& options)
    : atlas_(&atlas),
      rings_(&rings),
      records_(&records),
      options_((check_options(options), options)),
      objective_(options),
      frames_(vertex_frames(atlas.mesh())) {
    for (uint32_t view : records.views()) centers_.push_back(dataset.views[view].camera.center());
}

void VertexProblem::load(size_t v, const uint8_t* block) {
    const VertexRecord& record = records_->vertex(v);
    samples_ = record.samples;
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
    std::copy_n(record.mean, 3, mean_);
    scale_ = objective_.scale(texels(0), samples_, mean_);
    groups_.resize(record.images + 1);
    uint32_t first = 0;
    for (uint32_t g = 0; g < record.images; ++g) {
        RecordGroup group;
        std::memcpy(&group, block + g * sizeof group, sizeof group);
        groups_[g].first = first;
        first += group.samples;
        const ViewFootprint f = view_footprint(frames_[v], atlas_->mesh().positions[v], centers_[group.image],
                                               options_.view_side, options_.lookup);
        groups_[g].footprint = {f.texel, {f.weight[0], f.weight[1], f.weight[2], f.weight[3]}};
        groups_[g].weight =
            float(view_weight(frames_[v], atlas_->mesh().positions[v], centers_[group.image], options_.loss.weights));
    }
    groups_[record.images].first = first;
    targets_.resize(samples_);
    texels_.resize(samples_);
    const uint8_t* samples = block + record.images * sizeof(RecordGroup);
    records_->kind() == RecordKind::full ? take_full(samples) : take_compact(record, samples);
}

void VertexProblem::take_compact(const VertexRecord& record, const uint8_t* from) {
    const auto take = [&](auto channel) {
        using Channel = decltype(channel);
        constexpr int unit = sizeof(Channel) == 1 ? 257 : 1;  // in 16 bits, as every engine's targets are
        for (uint32_t i = 0; i < samples_; ++i) {
            Channel rgb[3];
            uint32_t place = 0;
            std::memcpy(rgb, from, sizeof rgb);
            std::memcpy(&place, from + sizeof rgb, record.texel_bytes);
            from += sizeof rgb + record.texel_bytes;
            texels_[i] = place;
            targets_[i] = weights_[place] *
                          (records_->scale() * V{float(unit * rgb[0]), float(unit * rgb[1]), float(unit * rgb[2]), 0});
        }
    };
    records_->bits() == 8 ? take(uint8_t{}) : take(uint16_t{});
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
