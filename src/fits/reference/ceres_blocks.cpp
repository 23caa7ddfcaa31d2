#include "reference/ceres_blocks.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/lfm_text.h"

namespace radiafit::fits {

/// What the residuals of one channel are made of; cost functions read it through a pointer, so that one structure
/// serves three channels.
struct CeresVertex::Channel {
    double root_weight = 1;                  ///< sqrt(1/S-bar)
    double root_surface = 0, root_view = 0;  ///< sqrt(lambda)
    double root_mu = 0, lower = 0, upper = 0;
    std::vector<uint32_t> sample;               ///< [S] of LfmVertex, in the order of the residual blocks
    std::vector<uint16_t> local;                ///< [S] place in the surface block: 0, or the tile texel
    std::vector<std::array<double, 4>> weight;  ///< [S] of the view texels that are read, the first `corners` of 4
    std::vector<double> target;                 ///< [S] of the current channel
};

namespace {

using Text = LfmText<double, double>;
using Channel = CeresVertex::Channel;

/// Samples that share a surface block and view texels. Parameters: the surface block [texel][term], then each view
/// texel [term].
class SampleCost final : public ceres::CostFunction {
public:
    SampleCost(const Channel& channel, uint32_t first, uint32_t count, int terms, int surface_size, int corners)
        : channel_(&channel), first_(first), terms_(terms), surface_size_(surface_size), corners_(corners) {
        set_num_residuals(int(count));
        mutable_parameter_block_sizes()->push_back(surface_size);
        for (int j = 0; j < corners; ++j) mutable_parameter_block_sizes()->push_back(terms);
    }

    bool Evaluate(const double* const* p, double* residuals, double** jacobians) const override {
        const double scale = channel_->root_weight;
        if (jacobians && jacobians[0] && surface_size_ > terms_)
            std::fill(jacobians[0], jacobians[0] + num_residuals() * surface_size_, 0.0);
        for (int i = 0; i < num_residuals(); ++i) {
            const size_t s = first_ + size_t(i);
            const std::array<double, 4>& w = channel_->weight[s];
            const int at = channel_->local[s] * terms_;
            double r = -channel_->target[s];
            for (int k = 0; k < terms_; ++k) {
                double h = 0;
                for (int j = 0; j < corners_; ++j) h += w[size_t(j)] * p[1 + j][k];
                const double g = p[0][at + k];
                r += Text::lfm_value(g, h);
                if (!jacobians) continue;
                if (jacobians[0]) jacobians[0][i * surface_size_ + at + k] = Text::lfm_gradient_surface(scale, h);
                const double by_view = Text::lfm_gradient_view(scale, g);
                for (int j = 0; j < corners_; ++j)
                    if (jacobians[1 + j]) jacobians[1 + j][i * terms_ + k] = w[size_t(j)] * by_view;
            }
            residuals[i] = scale * r;
        }
        return true;
    }

private:
    const Channel* channel_;
    uint32_t first_;
    int terms_, surface_size_, corners_;
};

double beyond(const Channel& channel, double value) {
    return ObjectiveText<double>::bound_excess(value, channel.lower, channel.upper);
}

/// One texel: sqrt(lambda) (L p) per term, and sqrt(mu) dist(p, [a, b]) of the first term. Parameters: the texel, then
/// its neighbours.
class TexelPenalty final : public ceres::CostFunction {
public:
    TexelPenalty(const Channel& channel, double Channel::*root_lambda, int terms, int neighbours, bool bounds)
        : channel_(&channel), root_lambda_(root_lambda), terms_(terms), neighbours_(neighbours) {
        set_num_residuals((root_lambda ? terms : 0) + (bounds ? 1 : 0));
        for (int j = 0; j < (root_lambda ? 1 + neighbours : 1); ++j) mutable_parameter_block_sizes()->push_back(terms);
    }

    bool Evaluate(const double* const* p, double* residuals, double** jacobians) const override {
        const int blocks = int(parameter_block_sizes().size());
        for (int j = 0; jacobians && j < blocks; ++j)
            if (jacobians[j]) std::fill(jacobians[j], jacobians[j] + num_residuals() * terms_, 0.0);
        int row = 0;
        for (int k = 0; root_lambda_ && k < terms_; ++k, ++row) {
            const double root = channel_->*root_lambda_;
            residuals[row] = 0;
            for (int j = 0; j < blocks; ++j) {
                const double factor = root * (j ? -1 : neighbours_);
                residuals[row] += factor * p[j][k];
                if (jacobians && jacobians[j]) jacobians[j][row * terms_ + k] = factor;
            }
        }
        if (row == num_residuals()) return true;
        const double distance = beyond(*channel_, p[0][0]);
        residuals[row] = channel_->root_mu * distance;
        if (jacobians && jacobians[0]) jacobians[0][row * terms_] = distance != 0 ? channel_->root_mu : 0;
        return true;
    }

private:
    const Channel* channel_;
    double Channel::*root_lambda_;
    int terms_, neighbours_;
};

/// The same for a whole surface map as one block.
class MapPenalty final : public ceres::CostFunction {
public:
    MapPenalty(const Channel& channel, const MapNeighbours& map, int terms, bool smooth, bool bounds)
        : channel_(&channel), map_(&map), terms_(terms), smooth_(smooth), bounds_(bounds) {
        const int texels = int(map.texel_count());
        set_num_residuals((smooth ? texels * terms : 0) + (bounds ? texels : 0));
        mutable_parameter_block_sizes()->push_back(texels * terms);
    }

    bool Evaluate(const double* const* p, double* residuals, double** jacobians) const override {
        const int texels = int(map_->texel_count()), width = texels * terms_;
        double* jacobian = jacobians ? jacobians[0] : nullptr;
        if (jacobian) std::fill(jacobian, jacobian + num_residuals() * width, 0.0);
        int row = 0;
        const double root = channel_->root_surface;
        for (int i = 0; smooth_ && i < texels; ++i) {
            const auto neighbours = map_->of(size_t(i));
            for (int k = 0; k < terms_; ++k, ++row) {
                residuals[row] = root * double(neighbours.size()) * p[0][i * terms_ + k];
                for (uint16_t n : neighbours) residuals[row] -= root * p[0][n * terms_ + k];
                if (!jacobian) continue;
                jacobian[row * width + i * terms_ + k] = root * double(neighbours.size());
                for (uint16_t n : neighbours) jacobian[row * width + n * terms_ + k] = -root;
            }
        }
        for (int i = 0; bounds_ && i < texels; ++i, ++row) {
            const double distance = beyond(*channel_, p[0][i * terms_]);
            residuals[row] = channel_->root_mu * distance;
            if (jacobian) jacobian[row * width + i * terms_] = distance != 0 ? channel_->root_mu : 0;
        }
        return true;
    }

private:
    const Channel* channel_;
    const MapNeighbours* map_;
    int terms_;
    bool smooth_, bounds_;
};

}  // namespace

CeresVertex::CeresVertex(const LfmVertex& vertex, CeresBlocks blocks)
    : vertex_(&vertex), channel_(std::make_unique<Channel>()), x_(vertex.size()) {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(options);
    const int terms = int(vertex.terms());
    for (size_t map = 0; map < vertex.maps(); ++map) {
        const size_t end = vertex.map_begin(map + 1);
        const size_t width = blocks == CeresBlocks::maps ? end - vertex.map_begin(map) : vertex.terms();
        for (size_t at = vertex.map_begin(map); at < end; at += width) {
            surface_.push_back(&x_[at]);
            problem_->AddParameterBlock(&x_[at], int(width));
        }
    }
    for (size_t at = vertex.view_begin(); at < x_.size(); at += vertex.terms()) view_.push_back(&x_[at]);
    for (double* block : view_) problem_->AddParameterBlock(block, terms);
    add_samples(vertex, blocks);
    add_penalties(vertex, blocks);
}

CeresVertex::~CeresVertex() = default;

void CeresVertex::add(std::unique_ptr<ceres::CostFunction> cost, const std::vector<double*>& parameters) {
    problem_->AddResidualBlock(cost.get(), nullptr, parameters);
    costs_.push_back(std::move(cost));
}

void CeresVertex::add_samples(const LfmVertex& vertex, CeresBlocks blocks) {
    struct Item {
        uint32_t block, corner, read, sample, group;
        bool same_block(const Item& o) const { return block == o.block && corner == o.corner && read == o.read; }
    };
    std::vector<Item> items;
    items.reserve(vertex.sample_count());
    for (uint32_t i = 0; i + 1 < vertex.groups.size(); ++i) {
        const LfmVertex::Group& g = vertex.groups[i];
        for (uint32_t s = g.first; s < vertex.groups[i + 1].first; ++s)
            items.push_back({blocks == CeresBlocks::maps ? g.map : vertex.first_texels[g.map] + vertex.local[s],
                             g.texel, LfmVertex::corners_read(g), s, i});
    }
    std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return std::array{a.block, a.corner, a.read} < std::array{b.block, b.corner, b.read};
    });
    Channel& data = *channel_;
    data.target.resize(items.size());
    const int terms = int(vertex.terms());
    for (size_t first = 0; first < items.size();) {
        size_t last = first;
        const LfmVertex::Group& shared = vertex.groups[items[first].group];
        std::vector<double*> parameters = {surface_[items[first].block]};
        for (int j = 0; j < 4; ++j)
            if (items[first].read >> j & 1) parameters.push_back(view_[vertex.corner(shared, j)]);
        for (; last < items.size() && items[last].same_block(items[first]); ++last) {
            const LfmVertex::Group& g = vertex.groups[items[last].group];
            std::array<double, 4> weight{};
            for (int j = 0, n = 0; j < 4; ++j)
                if (items[first].read >> j & 1) weight[size_t(n++)] = g.weight[j];
            data.sample.push_back(items[last].sample);
            data.local.push_back(blocks == CeresBlocks::maps ? vertex.local[items[last].sample] : uint16_t(0));
            data.weight.push_back(weight);
        }
        const int width = blocks == CeresBlocks::maps ? int(vertex.tile(shared.map).texel_count()) * terms : terms;
        add(std::make_unique<SampleCost>(data, uint32_t(first), uint32_t(last - first), terms, width,
                                         int(parameters.size()) - 1),
            parameters);
        first = last;
    }
}

void CeresVertex::add_penalties(const LfmVertex& vertex, CeresBlocks blocks) {
    const LfmOptions& o = vertex.options;
    const int terms = o.terms;
    const bool bounds = o.mu > 0;
    const auto texels = [&](const MapNeighbours& map, double* first, double Channel::*root_lambda) {
        if (!root_lambda && !bounds) return;
        for (size_t i = 0; i < map.texel_count(); ++i) {
            std::vector<double*> parameters = {first + i * vertex.terms()};
            for (uint16_t n : map.of(i)) parameters.push_back(first + n * vertex.terms());
            if (!root_lambda) parameters.resize(1);
            add(std::make_unique<TexelPenalty>(*channel_, root_lambda, terms, int(map.of(i).size()), bounds),
                parameters);
        }
    };
    texels(*vertex.view, view_[0], o.lambda_view > 0 ? &Channel::root_view : nullptr);
    for (size_t map = 0; map < vertex.maps(); ++map) {
        double* first = x_.data() + vertex.map_begin(map);
        if (blocks == CeresBlocks::texels)
            texels(vertex.tile(map), first, o.lambda_surface > 0 ? &Channel::root_surface : nullptr);
        else if (bounds || o.lambda_surface > 0)
            add(std::make_unique<MapPenalty>(*channel_, vertex.tile(map), terms, o.lambda_surface > 0, bounds),
                {first});
    }
}

void CeresVertex::set_channel(int c) {
    Channel& data = *channel_;
    data.root_weight = std::sqrt(vertex_->inverse_density);
    data.root_surface = std::sqrt(vertex_->lambda_surface);
    data.root_view = std::sqrt(vertex_->lambda_view[c]);
    data.root_mu = std::sqrt(double(vertex_->options.mu));
    data.lower = double(vertex_->options.lower);
    data.upper = double(vertex_->options.upper);
    for (size_t i = 0; i < data.sample.size(); ++i) data.target[i] = vertex_->target[data.sample[i]][c];
}

}  // namespace radiafit::fits
