#pragma once
#include <algorithm>

#include "model/texel_local.h"
#include "model/texel_model.h"

namespace radiafit {

/// The TexelModel of a text, with real = float: texel_text::NAME<float>.
template <class Text>
class TexelModelOf final : public TexelModel {
    using Model = TexelLocal<Text>;
    using Parameters = typename Model::Parameters;

public:
    TexelModelOf() {
        name = Text::name;
        terms = Text::term_count;
        basis = Model::basis;
        shape = Model::shape;
        parameters = Model::parameters;
        independent = Model::independent;
        coefficient_names.assign(std::begin(Text::coefficient_names), std::end(Text::coefficient_names));
        if constexpr (Model::shape > 0) {
            shape_names.assign(std::begin(Text::shape_names), std::end(Text::shape_names));
            for (const auto& start : Text::starts) starts.emplace_back(std::begin(start), std::end(start));
        }
        for (int i = 0; i < parameters; ++i) bounds.push_back(Model::bounds(i));
    }
    std::array<float, 3> value(std::span<const float> p, const Vec3f& u, const Vec3f& v) const override {
        if (!(u.z() > 0 && v.z() > 0)) return {};
        Parameters q;
        std::copy_n(p.begin(), q.size(), q.begin());
        return Model::value(q, Text::sample_terms({u.x(), u.y(), u.z()}, {v.x(), v.y(), v.z()}));
    }
    void make_canonical(std::span<float> p) const override {
        Parameters q;
        std::copy_n(p.begin(), q.size(), q.begin());
        q = Model::canonical(q);
        std::copy(q.begin(), q.end(), p.begin());
    }
};

}  // namespace radiafit
