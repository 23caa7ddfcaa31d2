#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "base/pack.h"
#include "base/rings.h"
#include "model/texel_text_begin.h"

namespace radiafit::fits {
inline constexpr int most_lobes = 4;
}

namespace radiafit::texel_text {

using fits::most_lobes;

/// shaders/model/sg.glsl for any scalar type and number of lobes, and where fits of them begin.
template <class real_type, int LOBE_COUNT>
struct SphericalGaussians {
    using real = real_type;
    template <class other>
    using with = SphericalGaussians<other, LOBE_COUNT>;
    using real2 = shared_text::real2_t<real>;
    using real3 = shared_text::real3_t<real>;
#include "model/sg.glsl"
    static constexpr int term_count = TERM_COUNT, basis_count = BASIS_COUNT, shape_count = SHAPE_COUNT;
#undef TERM_COUNT
#undef BASIS_COUNT
#undef SHAPE_COUNT
    static Terms sample_terms(const real3&, const real3& v) { return {{v.x, v.y, v.z}}; }
    static constexpr int lobe_shape_count = 3;
    static constexpr int shape_owner(int i) { return 1 + i / lobe_shape_count; }

    static constexpr const char* coefficient_names[1 + most_lobes] = {"d", "a1", "a2", "a3", "a4"};
    static constexpr const char* shape_names[3 * most_lobes] = {"x1", "y1", "log_lambda1", "x2", "y2", "log_lambda2",
                                                                "x3", "y3", "log_lambda3", "x4", "y4", "log_lambda4"};
    template <size_t rows>
    struct Bounds {
        double at[rows][2];
    };
    static constexpr auto free = [] {
        Bounds<size_t(basis_count)> bounds{};
        for (auto& [lowest, highest] : bounds.at) lowest = -1e30, highest = 1e30;
        return bounds;
    }();
    static constexpr auto sharpness = [] {
        Bounds<size_t(shape_count)> bounds{};
        for (int i = 0; i < shape_count; ++i) {
            bounds.at[i][0] = i % 3 == 2 ? 0 : -1.2;  // lambda = 1 to 150
            bounds.at[i][1] = i % 3 == 2 ? 5.010635294 : 1.2;
        }
        return bounds;
    }();
    static constexpr auto& coefficient_bounds = free.at;
    static constexpr auto& shape_bounds = sharpness.at;

    /// A lobe's starts: 32 axes over the hemisphere, each with lambda = 3, 8, 20 and 50.
    static constexpr int lobe_group = 4;
    static const std::vector<std::array<double, 3>>& lobe_starts() {
        static const auto starts = [] {
            std::vector<std::array<double, 3>> all;
            constexpr int on_ring[] = {1, 6, 11, 14};  // at 0, 21, 42 and 63 degrees
            for (int ring = 0; ring < 4; ++ring)
                for (int i = 0; i < on_ring[ring]; ++i) {
                    const double r = std::tan(ring * 10.5 * M_PI / 180),
                                 turn = 2 * M_PI * (i + 0.5 * ring) / on_ring[ring];
                    for (const double lambda : {3.0, 8.0, 20.0, 50.0})
                        all.push_back({r * std::cos(turn), r * std::sin(turn), std::log(lambda)});
                }
            return all;
        }();
        return starts;
    }
    /// The lobe at the four starts from `first` on: lambdas are whole, so by products alone.
    static void one_lobe_at_starts(size_t first, const Terms& t, real (&out)[lobe_group]) {
        using std::exp;
        const auto& start = lobe_starts()[first];
        Shape s{};
        s.x[0] = real(float(start[0]));
        s.x[1] = real(float(start[1]));
        const real e = exp(off_axis(s, 0, t)), e2 = e * e, e4 = e2 * e2, e8 = e4 * e4, e16 = e8 * e8;
        out[0] = e2 * e;
        out[1] = e8;
        out[2] = e16 * e4;
        out[3] = e16 * e16 * e16 * e2;
    }
};

}  // namespace radiafit::texel_text
