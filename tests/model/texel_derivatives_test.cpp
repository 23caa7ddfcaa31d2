// Every texel-local model of the list, a new one without a line here: its derivatives against central differences of
// its own values, in double, over parameters within its bounds and directions above the surface.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/rng.h"
#include "model/texel_local.h"
#include "model/texel_texts.h"

namespace radiafit {
namespace {

template <class Text>
class TexelDerivatives : public ::testing::Test {
protected:
    using Model = TexelLocal<Text>;
    static constexpr int count = Model::parameters;
    using Parameters = typename Model::Parameters;
    using Values = std::array<double, 3>;

    /// Of a model without a bound, within [-2, 2].
    double parameter(int i) {
        const auto [lowest, highest] = Model::bounds(i);
        const double from = std::max(lowest, -2.0), to = std::min(highest, 2.0 + std::max(lowest, 0.0));
        return from + (std::max(to, std::min(highest, 6.0)) - from) * rng_.uniform();
    }
    Parameters parameters_in_any_gauge() {
        Parameters p;
        for (int i = 0; i < count; ++i) p[size_t(i)] = parameter(i);
        return p;
    }
    /// In the canonical gauge, where values are no larger than those that fits meet.
    Parameters parameters() { return Model::canonical(parameters_in_any_gauge()); }
    /// Whether the last basis function ends before these terms: no derivative by the shape is left.
    static bool cut(const Parameters& p, const typename Model::Terms& terms) {
        const auto columns = Model::columns(Model::shape_of(p), terms);
        bool out = Model::shape > 0;
        for (size_t i = size_t(Model::basis); i < columns.size(); ++i) out = out && columns[i] == 0;
        return out;
    }
    Parameters direction() {
        Parameters d;
        for (double& x : d) x = 2 * rng_.uniform() - 1;
        return d;
    }
    typename Model::Terms terms() { return Text::sample_terms(unit(), unit()); }

    /// From steps h and 2 h, by Richardson's extrapolation: an error of order h^4. `doubt`: by how much the two alone
    /// disagree (an error of order h^2), and rounding. Where it is large, such as around a model's cuts, differences
    /// tell nothing.
    struct Difference {
        double value, doubt;
    };
    template <class Function>
    static Difference difference(const Function& f, double h) {
        const double ahead = f(h), behind = f(-h);
        const double near = (ahead - behind) / (2 * h), far = (f(2 * h) - f(-2 * h)) / (4 * h);
        return {near + (near - far) / 3,
                std::abs(near - far) + 1e-15 * std::max(std::abs(ahead), std::abs(behind)) / h};
    }
    /// Whether it was judged.
    static bool expect_slope(double derivative, const Difference& expected, double scale, const char* what) {
        if (expected.doubt > 1e-3 * (std::abs(expected.value) + scale)) return false;
        EXPECT_NEAR(derivative, expected.value, 1e-4 * (std::abs(expected.value) + scale)) << what;
        return true;
    }

private:
    typename Text::real3 unit() {
        const double z = 0.02 + 0.98 * rng_.uniform(), angle = 6.283185307179586 * rng_.uniform();
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }
    Rng rng_{17};
};

#define EACH(NAME) , texel_text::NAME<double>
template <class, class... Texts>
using TypesAfterFirst = ::testing::Types<Texts...>;
using Texts = TypesAfterFirst<void RADIAFIT_TEXEL_MODELS(EACH)>;
#undef EACH
struct NameOfText {
    template <class Text>
    static std::string GetName(int) {
        return Text::name;
    }
};
TYPED_TEST_SUITE(TexelDerivatives, Texts, NameOfText);

constexpr int trials = 4000;
constexpr double step = 1e-5;

TYPED_TEST(TexelDerivatives, ColumnsAreDerivativesByEachParameter) {
    using Model = typename TestFixture::Model;
    int judged = 0, wanted = 0;
    for (int trial = 0; trial < trials && !this->HasFailure(); ++trial) {
        const auto p = this->parameters();
        const auto terms = this->terms();
        const auto columns = Model::columns(Model::shape_of(p), terms);
        for (int i = 0; i < Model::parameters; ++i)
            for (size_t c = 0; c < 3; ++c) {
                const bool shape = i >= 3 * Model::basis;
                if (!shape && size_t(i % 3) != c) continue;
                const auto value = [&](double h) {
                    auto moved = p;
                    moved[size_t(i)] += h;
                    return Model::value(moved, terms)[c];
                };
                const size_t lobe = size_t(3 * (Model::basis - 1)) + c;
                const double derivative =
                    shape ? p[lobe] * columns[size_t(Model::basis + i - 3 * Model::basis)] : columns[size_t(i / 3)];
                judged += this->expect_slope(derivative, this->difference(value, step), 1e-3, "by a parameter");
                ++wanted;
            }
    }
    EXPECT_GT(judged, 0.8 * wanted) << "of " << wanted;
}

TYPED_TEST(TexelDerivatives, BendIsFirstAndSecondDerivativeAlongADirection) {
    using Model = typename TestFixture::Model;
    int judged = 0, wanted = 0;
    for (int trial = 0; trial < trials && !this->HasFailure(); ++trial) {
        const auto p = this->parameters(), d = this->direction();
        const auto terms = this->terms();
        const auto moved = [&](double h) {
            auto out = p;
            for (size_t i = 0; i < out.size(); ++i) out[i] += h * d[i];
            return out;
        };
        const auto bend = Model::bend(p, d, terms);
        for (size_t c = 0; c < 3; ++c) {
            const auto value = [&](double h) { return Model::value(moved(h), terms)[c]; };
            const auto slope = [&](double h) { return Model::bend(moved(h), d, terms).first[c]; };
            judged += this->expect_slope(bend.first[c], this->difference(value, step), 1e-3, "first derivative");
            judged += this->expect_slope(bend.second[c], this->difference(slope, step), 1e-2, "second derivative");
            wanted += 2;
        }
    }
    EXPECT_GT(judged, 0.8 * wanted) << "of " << wanted;
}

/// A cut may lie elsewhere in another gauge: what one of the two cuts is not compared.
TYPED_TEST(TexelDerivatives, TheGaugeChangesNoValue) {
    using Model = typename TestFixture::Model;
    int judged = 0;
    for (int trial = 0; trial < trials && !this->HasFailure(); ++trial) {
        const auto p = this->parameters_in_any_gauge(), canonical = Model::canonical(p);
        const auto terms = this->terms();
        const auto again = Model::canonical(canonical);
        for (size_t i = 0; i < again.size(); ++i) EXPECT_NEAR(again[i], canonical[i], 1e-12 * (1 + std::abs(again[i])));
        if (this->cut(p, terms) || this->cut(canonical, terms)) continue;
        const auto before = Model::value(p, terms), after = Model::value(canonical, terms);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(before[c], after[c], 1e-9 * (1e-3 + std::abs(before[c])));
        ++judged;
    }
    EXPECT_GT(judged, trials / 2);
}

}  // namespace
}  // namespace radiafit
