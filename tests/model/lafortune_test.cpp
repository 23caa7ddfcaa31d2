// The Lafortune text: derivatives against Jets over random and extreme parameters, and against differences.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "model/texel_local.h"
#include "model/texel_texts.h"

namespace radiafit {
namespace {

template <class real>
using LafortuneText = texel_text::lafortune<real>;
using Model = TexelLocal<LafortuneText<double>>;
constexpr int count = Model::parameters;
using Jet = ceres::Jet<double, count>;
using JetModel = TexelLocal<LafortuneText<Jet>>;
using Direction = LafortuneText<double>::real3;

Direction direction(Rng& rng, double lowest) {
    const double z = lowest + (1 - lowest) * rng.uniform(), angle = 6.283185307179586 * rng.uniform();
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Case {
    Model::Parameters p, d;
    Model::Terms terms;
    double D;
};

/// n up to 200, grazing lights and views, lobes near the cut at D = 1e-4.
Case random_case(Rng& rng) {
    Case c;
    for (double& x : c.p) x = 2 * rng.uniform();
    c.p[6] = -1.5 * rng.uniform();
    c.p[7] = 1.5 * rng.uniform();
    c.p[8] = std::log(200.0) * rng.uniform();
    for (double& x : c.d) x = 2 * rng.uniform() - 1;
    const double lowest = rng.uniform() < 0.3 ? 1e-3 : 0.05;
    c.terms = LafortuneText<double>::sample_terms(direction(rng, lowest), direction(rng, lowest));
    const auto s = Model::shape_of(c.p);
    c.D = LafortuneText<double>::lobe_cosine(s, c.terms);
    return c;
}

TEST(Lafortune, DerivativesAgreeWithJets) {
    Rng rng(5);
    for (int trial = 0; trial < 20000; ++trial) {
        const Case c = random_case(rng);
        JetModel::Parameters p;
        for (int i = 0; i < count; ++i) p[size_t(i)] = Jet(c.p[size_t(i)], i);
        JetModel::Terms terms;
        for (int i = 0; i < 3; ++i) terms.x[i] = Jet(c.terms.x[i]);
        const auto jets = JetModel::value(p, terms);
        const auto value = Model::value(c.p, c.terms);
        const auto q = Model::columns(Model::shape_of(c.p), c.terms);
        const auto bend = Model::bend(c.p, c.d, c.terms);
        for (int channel = 0; channel < 3; ++channel) {
            const Jet& m = jets[size_t(channel)];
            ASSERT_EQ(value[size_t(channel)], m.a);
            double along = 0;
            for (int i = 0; i < count; ++i) {
                double expected = 0;
                if (i >= 6)
                    expected = c.p[size_t(3 + channel)] * q[size_t(2 + i - 6)];
                else if (i % 3 == channel)
                    expected = q[size_t(i / 3)];
                ASSERT_NEAR(m.v[i], expected, 1e-9 * (1e-3 + std::abs(expected))) << "D " << c.D << ", parameter " << i;
                along += m.v[i] * c.d[size_t(i)];
            }
            ASSERT_NEAR(bend.first[size_t(channel)], along, 1e-9 * (1 + std::abs(along)));
        }
    }
}

// d'Hd: the derivative, by a Jet in t, of the first derivative along d at p + t d.
TEST(Lafortune, SecondDerivativeAgreesWithJets) {
    using Line = ceres::Jet<double, 1>;
    using LineModel = TexelLocal<LafortuneText<Line>>;
    Rng rng(8);
    for (int trial = 0; trial < 20000; ++trial) {
        const Case c = random_case(rng);
        LineModel::Parameters p, d;
        for (size_t i = 0; i < p.size(); ++i) {
            p[i] = Line(c.p[i]);
            p[i].v[0] = c.d[i];
            d[i] = Line(c.d[i]);
        }
        LineModel::Terms terms;
        for (int i = 0; i < 3; ++i) terms.x[i] = Line(c.terms.x[i]);
        const auto jets = LineModel::bend(p, d, terms).first;
        const auto bend = Model::bend(c.p, c.d, c.terms);
        for (size_t channel = 0; channel < 3; ++channel) {
            ASSERT_NEAR(bend.first[channel], jets[channel].a, 1e-12 * (1 + std::abs(bend.first[channel])));
            // terms of either sign, some hundred times their sum
            ASSERT_NEAR(bend.second[channel], jets[channel].v[0], 1e-9 * (1 + std::abs(bend.second[channel]))) << c.D;
        }
    }
}

TEST(Lafortune, SecondDerivativeAgreesWithDifferencesOfTheFirst) {
    Rng rng(6);
    int judged = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const Case c = random_case(rng);
        if (c.D < 1e-2) continue;                        // differences must not cross the cut
        const double h = 2e-4 * c.D / std::exp(c.p[8]);  // small against the width of D^n
        const auto first = [&](double t) {
            Model::Parameters p = c.p;
            for (size_t i = 0; i < p.size(); ++i) p[i] += t * c.d[i];
            return Model::bend(p, c.d, c.terms).first;
        };
        const auto ahead = first(h), behind = first(-h), further = first(2 * h), before = first(-2 * h);
        const auto bend = Model::bend(c.p, c.d, c.terms);
        for (size_t channel = 0; channel < 3; ++channel) {
            const double expected =  // of fourth order
                (8 * (ahead[channel] - behind[channel]) - (further[channel] - before[channel])) / (12 * h);
            // rounding of the four values, over h
            const double floor = 1e-15 * (std::abs(bend.first[channel]) + 1) / h;
            ASSERT_NEAR(bend.second[channel], expected, 1e-6 * std::abs(expected) + floor) << "D " << c.D;
        }
        ++judged;
    }
    EXPECT_GT(judged, 5000);
}

TEST(Lafortune, TheLobeEndsAtItsCut) {
    Model::Parameters p{0.5, 0.5, 0.5, 1, 1, 1, -1, 1, std::log(10.0)};
    const Direction up{0, 0, 1}, grazing{std::sqrt(1 - 1e-10), 0, 1e-5};
    const auto terms = LafortuneText<double>::sample_terms(up, grazing);
    const auto value = Model::value(p, terms);  // D = 1e-5
    EXPECT_EQ(value[0], 0.5);
    const auto q = Model::columns(Model::shape_of(p), terms);
    for (size_t i = 1; i < q.size(); ++i) EXPECT_EQ(q[i], 0) << i;
}

// J'J and J'r of 9 parameters are put together from 15 + 9 + 1 sums.
TEST(Lafortune, NormalEquationsAgreeWithJets) {
    Rng rng(9);
    for (int trial = 0; trial < 300; ++trial) {
        const Case first = random_case(rng);
        double shared[5][5] = {}, linear[5][3] = {}, magnitude[count][count] = {};
        Eigen::Matrix<double, count, count> expected = decltype(expected)::Zero();
        Eigen::Matrix<double, count, 1> gradient = decltype(gradient)::Zero();
        JetModel::Parameters p;
        for (int i = 0; i < count; ++i) p[size_t(i)] = Jet(first.p[size_t(i)], i);
        for (int sample = 0; sample < 50; ++sample) {
            const Case c = random_case(rng);
            const double weight = rng.uniform();
            JetModel::Terms terms;
            for (int i = 0; i < 3; ++i) terms.x[i] = Jet(c.terms.x[i]);
            const auto jets = JetModel::value(p, terms);
            const auto q = Model::columns(Model::shape_of(first.p), c.terms);
            for (size_t channel = 0; channel < 3; ++channel) {
                const double r = jets[channel].a - double(rng.uniform());
                expected += weight * jets[channel].v * jets[channel].v.transpose();
                gradient += weight * r * jets[channel].v;
                for (size_t i = 0; i < 5; ++i) linear[i][channel] += weight * r * q[i];
                for (int i = 0; i < count; ++i)
                    for (int j = 0; j < count; ++j)
                        magnitude[i][j] += std::abs(weight * jets[channel].v[i] * jets[channel].v[j]);
            }
            for (size_t i = 0; i < 5; ++i)
                for (size_t j = 0; j < 5; ++j) shared[i][j] += weight * q[i] * q[j];
        }
        Eigen::Matrix<double, count, count> matrix = decltype(matrix)::Zero();
        Eigen::Matrix<double, count, 1> sums = decltype(sums)::Zero();
        for (int c = 0; c < 3; ++c) {
            const auto place = [&](int i) { return i < 2 ? 3 * i + c : 4 + i; };
            const auto factor = [&](int i) { return i < 2 ? 1 : first.p[size_t(3 + c)]; };
            for (int i = 0; i < 5; ++i) {
                sums[place(i)] += factor(i) * linear[i][c];
                for (int j = 0; j < 5; ++j) matrix(place(i), place(j)) += factor(i) * factor(j) * shared[i][j];
            }
        }
        for (int i = 0; i < count; ++i) {
            ASSERT_NEAR(sums[i], gradient[i], 1e-6 * std::abs(gradient[i]) + 1e-9);
            for (int j = 0; j < count; ++j) ASSERT_NEAR(matrix(i, j), expected(i, j), 1e-9 * (1e-6 + magnitude[i][j]));
        }
    }
}

// (rho_s, Cx, Cz) -> (rho_s s^-n, s Cx, s Cz) changes nothing.
TEST(Lafortune, GaugeLeavesTheValue) {
    Rng rng(7);
    for (int trial = 0; trial < 1000; ++trial) {
        Case c = random_case(rng);
        c.p[7] = std::max(c.p[7], 0.1);
        c.p[8] = std::log(1 + 30 * rng.uniform());
        const double s = 0.8 + 0.4 * rng.uniform();
        if (c.D < 1e-3) continue;
        Model::Parameters scaled = c.p;
        for (size_t i : {3, 4, 5}) scaled[i] *= std::pow(s, -std::exp(c.p[8]));
        for (size_t i : {6, 7}) scaled[i] *= s;
        const auto a = Model::value(c.p, c.terms), b = Model::value(scaled, c.terms);
        for (size_t channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(a[channel], b[channel], 1e-12 * (1 + std::abs(a[channel])));
        const auto one = Model::canonical(c.p), other = Model::canonical(scaled);
        ASSERT_NEAR(std::max(-one[6], one[7]), 1, 1e-12);
        for (size_t i = 0; i < one.size(); ++i) ASSERT_NEAR(one[i], other[i], 1e-9 * (1 + std::abs(one[i]))) << i;
    }
}

}  // namespace
}  // namespace radiafit
