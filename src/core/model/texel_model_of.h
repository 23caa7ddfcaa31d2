#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>

#include "model/start_sums.h"
#include "model/texel_local.h"
#include "model/texel_model.h"

namespace radiafit {

/// The TexelModel of a text, with real = float: texel_text::NAME<float>.
template <class Text>
class TexelModelOf final : public TexelModel {
    using Model = TexelLocal<Text>;
    using Parameters = typename Model::Parameters;
    using Fine = TexelLocal<typename Text::template with<double>>;

public:
    TexelModelOf() {
        name = Text::name;
        terms = Text::term_count;
        basis = Model::basis;
        shape = Model::shape;
        shaped = Model::shaped;
        parameters = Model::parameters;
        independent = Model::independent();
        for (const char* of : Text::coefficient_names) coefficient_names.emplace_back(of ? of : "");
        if constexpr (Model::shape > 0) {
            for (const char* of : Text::shape_names) shape_names.emplace_back(of ? of : "");
            for (const auto& start : Text::starts) starts.emplace_back(std::begin(start), std::end(start));
        }
        for (int i = 0; i < parameters; ++i) bounds.push_back(Model::bounds(i));
        if constexpr (requires { Text::diffuse_coefficient; }) diffuse = Text::diffuse_coefficient;
    }
    std::array<float, 3> value(std::span<const float> p, const Vec3f& u, const Vec3f& v) const override {
        if (!(u.z() > 0 && v.z() > 0)) return {};
        Parameters q;
        std::copy_n(p.begin(), q.size(), q.begin());
        return Model::value(q, Text::sample_terms({u.x(), u.y(), u.z()}, {v.x(), v.y(), v.z()}));
    }
    void columns(std::span<const float> p, const Vec3f& u, const Vec3f& v, std::span<double> out) const override {
        std::fill(out.begin(), out.end(), 0.0);
        if (!(u.z() > 0 && v.z() > 0)) return;
        typename Fine::Parameters q;
        std::copy_n(p.begin(), q.size(), q.begin());
        const auto terms = Text::template with<double>::sample_terms({double(u.x()), double(u.y()), double(u.z())},
                                                                     {double(v.x()), double(v.y()), double(v.z())});
        std::ranges::copy(Fine::columns(Fine::shape_of(q), terms), out.begin());
    }
    double coefficients_of(std::span<const float> sums, std::span<float> out) const override {
        return coefficients_of_sums<Model>(sums, out);
    }
    int held_by_gauge(std::span<const float> p) const override {
        int held = -1;
        if constexpr (Model::gauge_count > 0) {
            Parameters q;
            std::copy_n(p.begin(), q.size(), q.begin());
            const auto along = Text::gauge_tangent(Model::shape_of(q));
            const auto* most = std::ranges::max_element(along.x, {}, [](float x) { return std::abs(x); });
            held = 3 * Model::basis + int(most - std::begin(along.x));
        }
        return held;
    }
    std::optional<float> lobe_exponent(std::span<const float> p) const override {
        if constexpr (requires(typename Text::Shape s) { Text::lobe_exponent(s); }) {
            Parameters q;
            std::copy_n(p.begin(), q.size(), q.begin());
            return Text::lobe_exponent(Model::shape_of(q));
        }
        return {};
    }
    void make_canonical(std::span<float> p) const override {
        Parameters q;
        std::copy_n(p.begin(), q.size(), q.begin());
        q = Model::canonical(q);
        std::copy(q.begin(), q.end(), p.begin());
    }
};

}  // namespace radiafit
