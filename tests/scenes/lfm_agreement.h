#pragma once
#include <gtest/gtest.h>

#include "bench/lfm_oracle.h"
#include "cpu/lfm_engine.h"
#include "fragment/fragment_engine.h"
#include "fragment/gl_distributor.h"
#include "model/lfm_start.h"
#include "optim/optimizer.h"
#include "shared_context.h"
#include "temporary_folder.h"

/// OpenGL's engines of light field maps against the naive oracle in double and against the CPU engine, on one shared
/// sample list that the GL distributor made: the samples are identical, so only rounding may differ.
namespace radiafit {
using namespace harness;

inline constexpr int width = 150, height = 130, views = 7;

/// A packed dataset of noise, removed at the end.
class NoiseDataset {
public:
    explicit NoiseDataset(Mesh mesh, Encoding encoding = Encoding::u8_linear) {
        {
            DatasetWriter writer(folder_.path() / "noise");
            writer.set_encoding(encoding);
            std::mt19937 rng(5);
            for (int i = 0; i < views; ++i) {
                View view;
                view.name = "view" + std::to_string(i);
                view.camera = orbit_camera(i, views, width + i % 3, height - i % 2);
                const size_t pixels = size_t(view.camera.width) * view.camera.height;
                std::vector<uint8_t> data(pixels * 3 * size_t(bytes_per_channel(encoding))), mask(pixels);
                for (auto& byte : data) byte = uint8_t(rng());
                for (auto& byte : mask) byte = rng() % 10 != 0;
                writer.add(view, data.data(), mask);
            }
            Dataset header;
            header.name = "noise";
            header.mesh = std::move(mesh);
            header.encoding = encoding;
            writer.finish(header);
        }
        dataset = open_dataset(folder_.path() / "noise");
    }
    Dataset dataset;

private:
    TemporaryFolder folder_;
};

inline std::vector<uint32_t> all_views() {
    std::vector<uint32_t> list(views);
    for (uint32_t i = 0; i < views; ++i) list[i] = i;
    return list;
}

/// Random values in Parameters order; padding stays zero.
inline std::vector<float> random_vector(const LfmLayout& layout, float low, float high, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> uniform(low, high);
    std::vector<float> values(layout.size());
    for (size_t i = 0; i < values.size(); ++i) values[i] = i % 4 == 3 ? 0 : uniform(rng);
    return values;
}

/// What a light field map is fitted with. `passes`, images_per_pass: of the fragment engine.
struct Case {
    std::string name;
    int terms = 1, surface_side = 8, view_side = 8;
    ViewLookup lookup = ViewLookup::bilinear;
    Passes passes = Passes::paper;
    Encoding encoding = Encoding::u8_linear;
    int levels = 1;
    Loss loss = {};
    int images_per_pass = 0;
};

inline std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

/// Every entry within 1e-5 of the sum of its terms' magnitudes: some 80 units in the last place.
struct Tally {
    double worst = 0;
    void compare(double value, double expected, double magnitude, const std::string& what) {
        ASSERT_TRUE(std::isfinite(value)) << what;
        const double error = std::abs(value - expected);
        worst = std::max(worst, magnitude > 0 ? error / magnitude : error);
        ASSERT_LE(error, 1e-5 * magnitude) << what << ": " << value << " instead of " << expected;
    }
};

/// make(dataset, atlas, rings, list, options): an engine whose samples are the list's.
template <class Make>
void agree_with_the_oracle(const Case& c, const Make& make) {
    SharedContext::use();
    const NoiseDataset noise(awkward_mesh(c.levels), c.encoding);
    const Dataset& dataset = noise.dataset;
    const TriangleAtlas atlas(dataset.mesh, c.surface_side);
    const VertexRings rings(dataset.mesh);
    LfmOptions options;
    options.terms = c.terms;
    options.surface_side = c.surface_side;
    options.view_side = c.view_side;
    options.lookup = c.lookup;
    options.loss = c.loss;
    options.lambda_surface = options.lambda_view = options.mu = 0;  // the oracle has no penalties
    GlDistributor distributor(atlas);
    const SampleList list =
        build_sample_list(dataset, atlas, all_views(), {&distributor}, TargetSpace::stored, nullptr);
    const auto made = make(dataset, atlas, rings, list, options);
    auto& engine = *made;
    const LfmLayout& layout = engine.layout();
    ASSERT_GT(list.samples.size(), 500u);
    ASSERT_GT(rings.max_valence(), 16u);

    const std::vector<float> p = random_vector(layout, -0.5f, 1.5f, 1), d = random_vector(layout, -1, 1, 2);
    const auto oracle =
        lfm_oracle(dataset, atlas, rings, layout, options, list, {p.begin(), p.end()}, {d.begin(), d.end()});
    const ProblemStatistics statistics = engine.count();
    EXPECT_EQ(statistics.samples, oracle.samples);

    engine.reset(p);
    engine.gradient_pass(true);
    const auto evaluation = engine.read_evaluation();
    engine.set_line(p, d);
    engine.directional_pass();
    const auto line = engine.read_line();

    Tally error, gradient, diagonal, sums;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        const double texels = double(layout.surface_texels(v));
        const double scale = oracle.samples[v] ? texels / oracle.samples[v] : 1;
        const std::string vertex = "vertex " + std::to_string(v);
        double largest[3] = {0, 0, 0};
        for (size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
            const auto& g = oracle.gradient[i];
            gradient.compare(evaluation.gradient[i], scale * g.value, scale * g.magnitude, vertex + " gradient");
            if (i % 4 < 3) largest[i % 4] = std::max(largest[i % 4], scale * oracle.diagonal[i].value);
        }
        for (size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
            if (i % 4 == 3 || oracle.samples[v] == 0) continue;  // an engine may leave vertices without samples alone
            const double expected = std::max(scale * oracle.diagonal[i].value, 1e-4 * largest[i % 4] + 1e-30);
            diagonal.compare(evaluation.diagonal[i], expected, std::max(scale * oracle.diagonal[i].magnitude, expected),
                             vertex + " diagonal");
        }
        for (size_t i = 3 * v; i < 3 * v + 3; ++i) {
            error.compare(evaluation.error[i], scale * oracle.error[i].value, scale * oracle.error[i].magnitude,
                          vertex + " error");
            const auto compare = [&](float value, const ExactSum& sum, const char* name) {
                sums.compare(value, scale * sum.value, scale * sum.magnitude, vertex + name);
            };
            compare(line.gauss_newton[i], oracle.gauss_newton[i], " gauss-newton");
            compare(line.curvature[i], oracle.curvature[i], " d'Hd");
            compare(line.third[i], oracle.third[i], " third");
            compare(line.fourth[i], oracle.fourth[i], " fourth");
        }
    }
    std::printf("  worst of the sums of magnitudes: error %.1e gradient %.1e diagonal %.1e line %.1e\n", error.worst,
                gradient.worst, diagonal.worst, sums.worst);
}

/// Those that differ in more than the constants of a program.
inline std::vector<Case> structural_cases(std::vector<Case> cases) {
    std::erase_if(cases, [](const Case& c) {
        const auto is = [&](const char* kind) { return c.name.ends_with(kind); };
        return !is("plain") && !is("two_terms") && !is("16_bit") && !is("large_sides") && !is("huber_facing") &&
               !is("small_sides_many_terms") && !is("image_by_image");
    });
    return cases;
}

/// All rules for the plain cases and those of two terms. The others differ from them in what no rule knows of: they
/// take conjugate gradients and one rule more, which their names' lengths choose, so that each rule meets several.
inline std::vector<Rule> rules_of(const Case& c) {
    std::vector<Rule> rules = all_rules();
    if (c.name.ends_with("plain") || c.name.ends_with("two_terms")) return rules;
    std::erase(rules, Rule::cg_modern);
    return {Rule::cg_modern, rules[c.name.size() % rules.size()]};
}

/// Of fits, with penalties.
inline LfmOptions options_of(const Case& c, Mode mode) {
    LfmOptions options;
    options.terms = c.terms;
    options.surface_side = c.surface_side;
    options.view_side = c.view_side;
    options.lookup = c.lookup;
    options.loss = c.loss;
    options.lambda_surface = 0.01f;
    options.lambda_view = 0.02f;
    options.upper = 0.5f;  // so that bounds matter
    options.mode = mode;
    return options;
}

/// Some iterations of every verb, penalties included, against the CPU engine in double.
template <class Make>
void agree_with_the_cpu_engine_over_iterations(const Case& c, const Make& make) {
    SharedContext::use();
    const NoiseDataset noise(awkward_mesh(c.levels), c.encoding);
    const Dataset& dataset = noise.dataset;
    const TriangleAtlas atlas(dataset.mesh, c.surface_side);
    const VertexRings rings(dataset.mesh);
    GlDistributor distributor(atlas);
    const SampleList list =
        build_sample_list(dataset, atlas, all_views(), {&distributor}, TargetSpace::stored, nullptr);
    for (const Rule rule : rules_of(c)) {
        const bool paper = rule == Rule::cg_paper || rule == Rule::steepest_descent;
        const LfmOptions options = options_of(c, paper ? Mode::paper : Mode::modern);
        const auto made = make(dataset, atlas, rings, list, options);
        auto& engine = *made;
        LfmProblem<double> problem(dataset, atlas, rings, list, options);
        StreamEngine<double> oracle(problem);
        const ProblemStatistics of_engine = engine.count(), of_oracle = oracle.count();
        ASSERT_EQ(of_engine.samples, of_oracle.samples);
        for (size_t i = 0; i < of_oracle.mean.size(); ++i)
            ASSERT_NEAR(of_engine.mean[i], of_oracle.mean[i], 1e-5f * std::abs(of_oracle.mean[i]));
        const std::vector<float> start = lfm_start(engine.layout(), of_oracle.mean, 3);
        engine.reset(start);
        oracle.reset(start);
        OptimizerOptions optimizer;
        optimizer.rule = rule;
        optimizer.iterations = 4;
        const Trace a = optimize(engine, optimizer), b = optimize(oracle, optimizer);
        // Adam steps as far along an entry whose gradient is all rounding as along any other.
        const double error_tolerance = rule == Rule::adam ? 3e-4 : 2e-5, tolerance = rule == Rule::adam ? 2e-2 : 2e-3;
        ASSERT_EQ(a.rows.size(), b.rows.size());
        for (size_t i = 0; i < a.rows.size(); ++i) {
            // Four conjugate steps amplify rounding, and a few of the problems may decide otherwise where a trial
            // changes the error by less than rounding; none of it may show in the sum.
            EXPECT_NEAR(a.rows[i].error, b.rows[i].error, error_tolerance * b.rows[i].error) << "iteration " << i;
            EXPECT_NEAR(double(a.rows[i].accepted), double(b.rows[i].accepted), 0.01 * double(engine.problem_count()));
        }
        EXPECT_LT(b.rows.back().error, b.rows.front().error);
        std::vector<float> p(engine.layout().size()), q(p.size());
        engine.read_parameters(p);
        oracle.read_parameters(q);
        double difference = 0, norm = 0;
        for (size_t i = 0; i < p.size(); ++i) {
            difference += std::pow(double(p[i]) - q[i], 2);
            norm += std::pow(double(q[i]), 2);
        }
        EXPECT_LT(std::sqrt(difference / norm), tolerance) << "rule " << int(rule);
    }
}

}  // namespace radiafit
