#include "reference/channel_energy.h"

#include <algorithm>

#include "model/lfm_text.h"
#include "model/with_terms.h"

namespace radiafit::fits {
namespace {

using Text = LfmText<double, double>;

}  // namespace

ChannelEnergy::ChannelEnergy(const LfmVertex& vertex, int channel) : vertex_(&vertex), channel_(channel) {
    target_.reserve(vertex.sample_count());
    for (const auto& t : vertex.target) target_.push_back(t[channel]);
    scratch_.resize(vertex.size() + std::max(vertex.largest_tile(), vertex.view->texel_count()));
}

template <int K>
double ChannelEnergy::data(const double* x, double* gradient) const {
    const LfmVertex& v = *vertex_;
    const size_t terms = K ? size_t(K) : v.terms();
    const double* view = x + v.view_begin();
    double* view_gradient = gradient + v.view_begin();
    double sum = 0;
    for (size_t i = 0; i + 1 < v.groups.size(); ++i) {
        const LfmVertex::Group& group = v.groups[i];
        double h[max_terms], scatter[2][max_terms] = {}, part[2] = {};
        size_t corner[4];
        for (int j = 0; j < 4; ++j) corner[j] = v.corner(group, j) * terms;
        for (size_t k = 0; k < terms; ++k) {
            h[k] = 0;
            for (int j = 0; j < 4; ++j) h[k] += group.weight[j] * view[corner[j] + k];
        }
        const double* surface = x + v.map_begin(group.map);
        double* surface_gradient = gradient + v.map_begin(group.map);
        const auto one = [&](size_t s, int side) {  // two sides: sums that don't wait for one another
            const size_t at = v.local[s] * terms;
            double r = -target_[s];
            for (size_t k = 0; k < terms; ++k) r += Text::lfm_value(surface[at + k], h[k]);
            part[side] += r * r;
            for (size_t k = 0; k < terms; ++k) {
                surface_gradient[at + k] += Text::lfm_gradient_surface(r, h[k]);
                scatter[side][k] += Text::lfm_gradient_view(r, surface[at + k]);
            }
        };
        size_t s = group.first;
        const size_t end = v.groups[i + 1].first;
        for (; s + 2 <= end; s += 2) one(s, 0), one(s + 1, 1);
        if (s < end) one(s, 0);
        sum += part[0] + part[1];
        for (size_t k = 0; k < terms; ++k)
            for (int j = 0; j < 4; ++j)
                view_gradient[corner[j] + k] += group.weight[j] * (scatter[0][k] + scatter[1][k]);
    }
    return 0.5 * sum;
}

double ChannelEnergy::smoothness(const MapNeighbours& map, double lambda, const double* x, double* gradient) const {
    if (lambda == 0) return 0;
    const size_t terms = vertex_->terms();
    double* once = scratch_.data() + vertex_->size();
    double sum = 0;
    for (size_t k = 0; k < terms; ++k) {
        for (size_t i = 0; i < map.texel_count(); ++i) {
            once[i] = double(map.of(i).size()) * x[i * terms + k];
            for (uint16_t n : map.of(i)) once[i] -= x[n * terms + k];
            sum += once[i] * once[i];
        }
        for (size_t i = 0; i < map.texel_count(); ++i) {
            double twice = double(map.of(i).size()) * once[i];
            for (uint16_t n : map.of(i)) twice -= once[n];
            gradient[i * terms + k] += lambda * twice;
        }
    }
    return 0.5 * lambda * sum;
}

double ChannelEnergy::penalties(const double* x, double* gradient) const {
    const LfmVertex& v = *vertex_;
    const size_t terms = v.terms();
    double error = smoothness(*v.view, v.lambda_view[channel_], x + v.view_begin(), gradient + v.view_begin());
    for (size_t map = 0; map < v.maps(); ++map)
        error += smoothness(v.tile(map), v.lambda_surface, x + v.map_begin(map), gradient + v.map_begin(map));
    const double lower = double(v.options.lower), upper = double(v.options.upper), mu = double(v.options.mu);
    for (size_t i = 0; i < size(); i += terms) {
        error += ObjectiveText<double>::bound_error(x[i], lower, upper, mu, false);
        gradient[i] += ObjectiveText<double>::bound_slope(x[i], lower, upper, mu, false);
    }
    return error;
}

double ChannelEnergy::evaluate(const double* x, double* gradient) const {
    double* g = gradient ? gradient : scratch_.data();
    std::fill(g, g + size(), 0.0);
    double error = with_terms(vertex_->options.terms, [&](auto k) { return data<k>(x, g); });
    const double weight = vertex_->inverse_density;
    for (size_t i = 0; i < size(); ++i) g[i] *= weight;
    error *= weight;
    return error + penalties(x, g);
}

std::vector<double> ChannelEnergy::diagonal(const double* x) const {
    const LfmVertex& v = *vertex_;
    const size_t terms = v.terms();
    std::vector<double> out(size(), 0.0);
    for (size_t i = 0; i + 1 < v.groups.size(); ++i) {
        const LfmVertex::Group& group = v.groups[i];
        for (size_t k = 0; k < terms; ++k) {
            double h = 0, squares = 0;
            for (int j = 0; j < 4; ++j) h += group.weight[j] * x[v.view_begin() + v.corner(group, j) * terms + k];
            for (uint32_t s = group.first; s < v.groups[i + 1].first; ++s) {
                const size_t at = v.map_begin(group.map) + v.local[s] * terms + k;
                out[at] += h * h;
                squares += x[at] * x[at];
            }
            for (int j = 0; j < 4; ++j)
                out[v.view_begin() + v.corner(group, j) * terms + k] += group.weight[j] * group.weight[j] * squares;
        }
    }
    double largest = 0;
    for (size_t i = 0; i < out.size(); ++i) {
        out[i] = out[i] * v.inverse_density + 20 * (i < v.view_begin() ? v.lambda_surface : v.lambda_view[channel_]);
        largest = std::max(largest, out[i]);
    }
    for (double& entry : out) entry = ObjectiveText<double>::preconditioner(entry, largest, 1e-30);
    return out;
}

}  // namespace radiafit::fits
