// The fragment engine for texel-local models: its sums against the same in double over its own distribution, its start,
// its two forms of passes against one another, and whole fits of surfaces whose reflectance is known.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/log.h"
#include "context_kinds.h"
#include "dataset/truth.h"
#include "failing_gl.h"
#include "fragment/texel_engine.h"
#include "fragment/texel_plan.h"
#include "model/coefficient_solver.h"
#include "model/small_solve.h"
#include "optim/optimizer.h"
#include "several_shapes.h"
#include "shared_context.h"
#include "synthetic/synthetic.h"
#include "texel_fragment_scene.h"
#include "watched_draws.h"

namespace radiafit {
using namespace harness;
namespace {

using namespace testing;
static_assert(Engine<TexelFragmentEngine>);

struct Case {
    std::string name, model;
    TexelScene scene = {};
    Passes passes = Passes::paper;
    Mode mode = Mode::modern;
    float clip_above = 0, shadow_below = 0;
    int images_per_pass = 0;
    Loss loss = {};
    TexelOptions options() const {
        TexelOptions options;
        options.model = find_texel_model(model);
        options.mode = mode;
        options.mu = 0.3f;
        options.clip_above = clip_above;
        options.shadow_below = shadow_below;
        options.loss = loss;
        return options;
    }
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

/// Some beyond their bounds.
std::vector<float> random_parameters(const TexelModel& model, size_t texels, unsigned seed) {
    std::mt19937 rng(seed);
    std::vector<float> values;
    for (size_t texel = 0; texel < texels; ++texel)
        for (const auto& [lowest, highest] : model.bounds) {
            const auto low = float(std::max(lowest, -2.0) - 0.1), high = float(std::min(highest, 2.0) + 0.1);
            values.push_back(std::uniform_real_distribution<float>(low, high)(rng));
        }
    return values;
}
std::vector<float> random_direction(size_t count, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<float> values(count);
    for (float& x : values) x = uniform(rng);
    return values;
}

/// Every entry within 1e-5 of the sum of its terms' magnitudes.
struct Tally {
    double worst = 0;
    void compare(double value, const ExactSum& expected, const std::string& what) {
        ASSERT_TRUE(std::isfinite(value)) << what;
        const double error = std::abs(value - expected.value);
        worst = std::max(worst, expected.magnitude > 0 ? error / expected.magnitude : error);
        ASSERT_LE(error, 1e-5 * expected.magnitude + 1e-37)
            << what << ": " << value << " instead of " << expected.value;
    }
};

class TexelFragmentAgreement : public ::testing::TestWithParam<Case> {};

/// By how much floats raise the least sum of squares 1/2 p'Ap - p'g: sums that are off by a share of the largest
/// eigenvalue move the solution p by d, A d = E p, and d'Ad is (E p)'A^-1(E p) at most. sizes: p'p.
double off_by(double least, double largest, double sizes) {
    constexpr double share = 1e-7;
    return 0.5 * share * share * largest * largest * sizes / std::max(least, 1e-12);
}

template <class Text>
void agree(const Case& c) {
    using Model = TexelLocal<Text>;
    SharedContext::use();
    const TexelDataset data(c.scene);
    const TexelOptions options = c.options();
    TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options,
                               {.passes = c.passes, .images_per_pass = c.images_per_pass});
    const auto samples = exact_samples<Text>(data, options);
    const size_t texels = data.atlas->texel_count(), each = size_t(Model::parameters);
    ASSERT_EQ(engine.problem_count(), texels);

    const ProblemStatistics statistics = engine.count();
    size_t total = 0;
    for (size_t texel = 0; texel < texels; ++texel) {
        ASSERT_EQ(statistics.samples[texel], samples[texel].size()) << texel;
        total += samples[texel].size();
        const auto albedo = exact_albedo(samples[texel]);
        for (size_t k = 0; k < 3; ++k) {
            double size = 0, squares = 0;  // u_z wrong by 5e-7
            for (const auto& sample : samples[texel]) {
                size += sample.target[k] + 2 * albedo[k] * sample.cosine;
                squares += sample.cosine * sample.cosine;
            }
            const double tolerance = squares > 0 ? 1e-5 * albedo[k] + 5e-7 * size / squares : 0;
            ASSERT_NEAR(double(statistics.mean[3 * texel + k]), albedo[k], tolerance) << texel;
        }
    }
    ASSERT_GT(total, c.scene.views == 1 ? 400u : 500u);

    const std::vector<float> p = random_parameters(*options.model, texels, 1), d = random_direction(p.size(), 2);
    engine.reset(p);
    engine.gradient_pass(true);
    const auto evaluation = engine.read_evaluation();
    engine.set_line(p, d);
    engine.directional_pass();
    const auto line = engine.read_line();
    const std::vector<float> start = engine.start();
    Tally error, gradient, diagonal, sums;
    for (size_t texel = 0; texel < texels; ++texel) {
        typename Model::Parameters at, along, first;
        for (size_t i = 0; i < each; ++i) {
            at[i] = double(p[texel * each + i]);
            along[i] = double(d[texel * each + i]);
            first[i] = double(start[texel * each + i]);
        }
        const ExactTexel<Text> exact(samples[texel], options, at, along);
        const std::string what = "texel " + std::to_string(texel);
        error.compare(double(evaluation.error[texel]), exact.error, what + " error");
        for (size_t i = 0; i < each; ++i) {
            gradient.compare(double(evaluation.gradient[texel * each + i]), exact.gradient[i], what + " gradient");
            diagonal.compare(double(evaluation.diagonal[texel * each + i]), exact.diagonal[i], what + " diagonal");
        }
        sums.compare(double(line.gauss_newton[texel]), exact.gauss_newton, what + " gauss-newton");
        sums.compare(double(line.curvature[texel]), exact.curvature, what + " d'Hd");

        // No start fits better, and it is within bounds.
        double lowest = std::numeric_limits<double>::infinity(), squares = 0, least_pivot = 1, rounding = 0;
        const auto try_shape = [&](const typename Text::Shape& shape) {
            constexpr int B = Model::basis;
            SmallMatrix<double, B> a{};
            SmallVector<double, B> g[3] = {};
            double change = 0;
            squares = 0;
            for (const auto& s : samples[texel]) {
                const auto b = Text::basis(shape, s.terms);
                const double weight = options.loss.weighted() ? s.facing : 1;
                for (size_t k = 0; k < size_t(B); ++k) {
                    for (size_t j = 0; j <= k; ++j) a[k][j] += weight * b.x[k] * b.x[j];
                    for (size_t k2 = 0; k2 < 3; ++k2) g[k2][k] -= weight * b.x[k] * s.target[k2];
                }
                for (const double t : s.target) squares += 0.5 * weight * t * t;
            }
            const SmallFactor<double, B> factor(a, 1e-6);
            least_pivot = factor.smallest();
            double sizes = 0;  // of the solutions, squared
            for (size_t c = 0; c < 3; ++c) {
                const auto found = CoefficientSolver<Model, double>(a, 1e-6, SmallPivots::raised).from_zero(c, g[c]);
                change += found.change;
                for (size_t k = 0; k < size_t(B); ++k) sizes += found.coefficients[k] * found.coefficients[k];
            }
            lowest = std::min(lowest, squares + change);
            if (Model::shape > 0) return;
            Eigen::MatrixXd products(B, B);
            for (size_t k = 0; k < size_t(B); ++k)
                for (size_t j = 0; j <= k; ++j) products(int(k), int(j)) = products(int(j), int(k)) = a[k][j];
            const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(products);
            rounding = off_by(eigenvalues[0], eigenvalues[B - 1], sizes);
        };
        if constexpr (Model::shape > 0) {
            for (const auto& candidate : Text::starts) {
                typename Text::Shape shape;
                std::copy(std::begin(candidate), std::end(candidate), shape.x);
                try_shape(shape);
            }
        } else {
            try_shape({});
        }
        double mine = 0;
        for (const auto& s : samples[texel]) {
            const auto value = Model::value(first, s.terms);
            const double weight = options.loss.weighted() ? s.facing : 1;
            for (size_t k = 0; k < 3; ++k) mine += 0.5 * weight * std::pow(value[k] - s.target[k], 2);
        }
        // Sums of 32-bit floats: of what the targets' squares and the fit nearly cancel to, 1e-6 remain.
        // And of a plain linear fit what they make of its matrix, but never a loss: no more than that where samples
        // hardly tell the coefficients apart.
        if (Model::shape == 0) lowest = least_pivot < 1e-3 ? squares : std::min(lowest + rounding, squares);
        ASSERT_LE(mine, lowest * (1 + 1e-4) + 1e-5 * squares) << what << " of " << samples[texel].size();
        for (size_t i = 0; i < each; ++i) {
            ASSERT_GE(first[i], Model::bounds(int(i))[0] - 1e-6) << what;
            ASSERT_LE(first[i], Model::bounds(int(i))[1] + 1e-6) << what;
        }
    }
    std::printf("  worst of the sums of magnitudes: error %.1e gradient %.1e diagonal %.1e line %.1e\n", error.worst,
                gradient.worst, diagonal.worst, sums.worst);
}

TEST_P(TexelFragmentAgreement, WithTheReference) {
    const Case& c = GetParam();
#define AGREE(NAME) \
    if (c.model == #NAME) return agree<texel_text::NAME<double>>(c);
    RADIAFIT_TEXEL_MODELS(AGREE)
    AGREE(several_shapes)
#undef AGREE
    FAIL() << c.model;
}

std::vector<Case> texel_cases() {
    std::vector<Case> list;
    for (const Passes passes : {Passes::paper, Passes::combined}) {
        const std::string prefix = to_string(passes);
        for (const TexelModel* model : models_up_to(most_fragment_parameters)) {
            const std::string name = prefix + "_" + model->name;
            list.push_back({.name = name + "_mesh_near",
                            .model = model->name,
                            .scene = {.light = Light::Kind::near},
                            .passes = passes,
                            .clip_above = 0.9f,
                            .shadow_below = 0.5f});
            list.push_back({.name = name + "_grid_distant",
                            .model = model->name,
                            .scene = {.grid = true},
                            .passes = passes,
                            .mode = Mode::paper,
                            .shadow_below = 0.3f});
            if (passes == Passes::combined)
                for (const bool grid : {false, true})
                    list.push_back({.name = name + (grid ? "_grid_one_eye" : "_mesh") + "_three_images_together",
                                    .model = model->name,
                                    .scene = {.grid = grid, .light = Light::Kind::near, .one_eye = true},
                                    .passes = passes,
                                    .images_per_pass = 3});
        }
        list.push_back({.name = prefix + "_several_shapes", .model = several_shapes().name, .passes = passes});
        list.push_back({.name = prefix + "_huber",
                        .model = "lafortune",
                        .scene = {.light = Light::Kind::near},
                        .passes = passes,
                        .loss = {LossKind::huber, 0.3f}});
        list.push_back({.name = prefix + "_cauchy",
                        .model = "lafortune",
                        .scene = {.grid = true},
                        .passes = passes,
                        .loss = {LossKind::cauchy, 0.3f}});
        list.push_back({.name = prefix + "_facing",
                        .model = "lafortune",
                        .scene = {.light = Light::Kind::near},
                        .passes = passes,
                        .loss = {.weights = SampleWeights::facing}});
        for (const char* linear : {"lambert", "ptm"})
            list.push_back({.name = prefix + "_facing_" + linear,
                            .model = linear,
                            .scene = {.grid = true},
                            .passes = passes,
                            .loss = {.weights = SampleWeights::facing}});
        list.push_back({.name = prefix + "_huber_facing",
                        .model = "lafortune",
                        .scene = {.grid = true, .one_eye = true},
                        .passes = passes,
                        .loss = {LossKind::huber, 0.3f, SampleWeights::facing}});
        list.push_back({.name = prefix + "_mesh_distant_8_bit",
                        .model = "lafortune",
                        .scene = {.encoding = Encoding::u8_linear, .views = 8},
                        .passes = passes,
                        .mode = Mode::paper});
        list.push_back({.name = prefix + "_grid_near_8_bit",
                        .model = "lafortune",
                        .scene = {.grid = true, .light = Light::Kind::near, .encoding = Encoding::u8_linear},
                        .passes = passes,
                        .clip_above = 0.8f,
                        .images_per_pass = 2});
        list.push_back({.name = prefix + "_mesh_one_image",
                        .model = "lafortune",
                        .scene = {.light = Light::Kind::near, .views = 1},
                        .passes = passes});
        list.push_back({.name = prefix + "_mesh_half_images",
                        .model = "lambert",
                        .scene = {.light = Light::Kind::near, .encoding = Encoding::u8_srgb, .views = 5},
                        .passes = passes,
                        .clip_above = 1});
    }
    return list;
}
INSTANTIATE_TEST_SUITE_P(Cases, TexelFragmentAgreement, ::testing::ValuesIn(texel_cases()),
                         [](const auto& info) { return info.param.name; });

struct Fitted {
    std::vector<float> parameters;
    Trace trace;
    std::vector<ProblemOutcome> outcomes;
    ProblemStatistics statistics;
};
Fitted run(TexelFragmentEngine& engine, const OptimizerOptions& optimizer) {
    Fitted out;
    out.statistics = engine.count();
    out.parameters = engine.start();
    out.trace = optimize_terms(engine, optimizer, 1, false, out.parameters);
    out.outcomes.resize(engine.problem_count());
    engine.outcomes(out.outcomes);
    return out;
}
Fitted run(ContextKind kind, const TexelDataset& data, const FragmentOptions& fragment, Rule rule = Rule::cg_modern) {
    const auto context = make_context(kind);
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options, fragment);
    OptimizerOptions optimizer;
    optimizer.rule = rule;
    optimizer.iterations = 6;
    return run(engine, optimizer);
}

TEST(TexelFragment, BothFormsOfPassesFitAlike) {
    for (const bool grid : {false, true})
        for (const Rule rule : grid ? std::vector{Rule::cg_modern} : all_rules()) {  // no rule knows of grids
            const TexelDataset data({.grid = grid, .light = Light::Kind::near});
            const Fitted a = run(ContextKind::egl, data, {.passes = Passes::paper}, rule),
                         b = run(ContextKind::egl, data, {.passes = Passes::combined}, rule);
            ASSERT_EQ(a.trace.rows.size(), b.trace.rows.size());
            EXPECT_EQ(a.statistics.samples, b.statistics.samples);
            for (size_t i = 0; i < a.trace.rows.size(); ++i) {
                // Conjugate steps amplify rounding, and a few texels may decide otherwise where a trial changes the
                // error by less than rounding.
                EXPECT_NEAR(a.trace.rows[i].error, b.trace.rows[i].error, 1e-3 * b.trace.rows[i].error) << i;
                EXPECT_NEAR(double(a.trace.rows[i].accepted), double(b.trace.rows[i].accepted),
                            0.02 * double(a.outcomes.size()));
            }
            EXPECT_LT(b.trace.rows.back().error, 0.999 * b.trace.rows.front().error);
        }
}

// Only programs with several targets differ, which r300 has once for each. On a chip: fragment_test.cpp,
// FragmentOfTheChip.
TEST(TexelFragment, PassesOfTheChipFitTheBitsOfThePaperPasses) {
    const bool software = SharedContext::use().software();
    for (const auto& [grid, storage] :
         {std::pair{false, Storage::fp32}, std::pair{false, Storage::fp16}, std::pair{true, Storage::fp32}}) {
        const TexelDataset data({.grid = grid});
        const TexelOptions options{.model = find_texel_model("lafortune"), .mode = Mode::paper, .mu = 1e-4f};
        TexelFragmentEngine paper_engine(data.dataset, *data.atlas, data.views, options,
                                         {.passes = Passes::paper, .storage = storage}),
            chip_engine(data.dataset, *data.atlas, data.views, options, {.passes = Passes::r300, .storage = storage});
        for (const Rule rule : storage == Storage::fp32 && !grid ? all_rules() : std::vector{Rule::cg_paper}) {
            const OptimizerOptions optimizer{.rule = rule, .iterations = 4};
            const Fitted paper = run(paper_engine, optimizer), r300 = run(chip_engine, optimizer);
            ASSERT_EQ(paper.trace.rows.size(), r300.trace.rows.size());
            for (size_t i = 0; i < paper.trace.rows.size(); ++i)
                EXPECT_NEAR(paper.trace.rows[i].error, r300.trace.rows[i].error,
                            (software ? 1e-12 : 1e-3) * paper.trace.rows[i].error);
            EXPECT_LT(r300.trace.rows.back().error, 0.999 * r300.trace.rows.front().error);
            if (!software) continue;
            EXPECT_EQ(paper.parameters, r300.parameters) << "rule " << int(rule);
            for (size_t i = 0; i < paper.outcomes.size(); ++i) {
                ASSERT_EQ(paper.outcomes[i].error, r300.outcomes[i].error) << i;
                ASSERT_EQ(paper.outcomes[i].status, r300.outcomes[i].status) << i;
            }
        }
    }
}

TEST(TexelFragment, PassesOfTheChipBindWhatItCould) {
    SharedContext::use();
    for (const bool grid : {false, true})
        for (const Passes passes : {Passes::paper, Passes::r300}) {
            const WatchedDraws watched;
            const TexelDataset data({.grid = grid});
            TexelFragmentEngine engine(data.dataset, *data.atlas, data.views,
                                       {.model = find_texel_model("lafortune"), .mode = Mode::paper},
                                       {.passes = passes});
            engine.passes().tally(true);
            run(engine, {.rule = Rule::cg_paper, .iterations = 2});
            const DrawCounts& counts = watched.counts();
            EXPECT_GT(counts.draws, 100);
            EXPECT_EQ(counts.unknown, 0);
            EXPECT_EQ(counts.several_targets > 0, passes == Passes::paper);
            EXPECT_EQ(counts.vertex_look_ups, 0);
            EXPECT_EQ(counts.own_target_read > 0, passes == Passes::paper);
            if (passes == Passes::r300) expect_costs_of_the_chip(engine.passes());
        }
}

TEST(TexelFragment, SameBitsTwiceFromAnySourceAndInEveryContext) {
    for (const bool grid : {false, true}) {
        const TexelDataset data({.grid = grid});
        for (const Passes passes : {Passes::paper, Passes::combined}) {
            const FragmentOptions plain{.passes = passes, .images_per_pass = 2};
            FragmentOptions disk = plain, resident = plain;
            disk.source = StreamSource::disk;
            resident.keep_on_device = true;
            const auto first = run(ContextKind::egl, data, plain).parameters;
            EXPECT_EQ(first, run(ContextKind::egl, data, disk).parameters);
            EXPECT_EQ(first, run(ContextKind::egl, data, resident).parameters);
            if (has_osmesa() && make_context(ContextKind::egl)->software()) {
                EXPECT_EQ(first, run(second_kind(), data, plain).parameters);
            }
        }
    }
}

TEST(TexelFragment, WhatWasNeverFiniteCountsAsNothing) {
    const auto context = make_context(second_kind());
    const TexelDataset data({.grid = true});
    TexelOptions options;
    options.model = find_texel_model("lambert");
    const OptimizerOptions optimizer{.iterations = 2};
    for (const Passes passes : {Passes::paper, Passes::combined}) {
        TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options, {.passes = passes});
        const ProblemStatistics statistics = engine.count();
        const auto seen = std::find_if(statistics.samples.begin(), statistics.samples.end(), [](auto n) { return n; });
        const auto bad = size_t(seen - statistics.samples.begin());
        std::vector<float> start = engine.start(), errors(engine.problem_count());
        engine.reset(start);
        const double whole = optimize(engine, optimizer).rows.back().error;
        engine.read_errors(errors);
        start[3 * bad] = 1e30f;  // its square is beyond floats
        engine.reset(start);
        const Trace trace = optimize(engine, optimizer);
        EXPECT_NEAR(trace.rows.back().error, whole - double(errors[bad]), 1e-6 * whole);
        std::vector<ProblemOutcome> outcomes(engine.problem_count());
        engine.outcomes(outcomes);
        EXPECT_EQ(outcomes[bad].status, Status::not_finite);
        EXPECT_EQ(outcomes[bad].error, 0);
    }
}

TEST(TexelFragment, HalvesStayNearSingles) {
    const TexelDataset data({});
    for (const Passes passes : {Passes::paper, Passes::combined}) {
        const auto error = [&](Storage storage, Sums sums) {
            return run(second_kind(), data, {.passes = passes, .storage = storage, .sums = sums, .images_per_pass = 2})
                .trace.rows.back()
                .error;
        };
        const double single = error(Storage::fp32, Sums::fp32);
        // Parameters keep 11 bits, but for log n, of which a step of 2^-9 moves a lobe of n = 30 by as much as 0.1.
        for (const Storage storage : {Storage::fp16, Storage::fp16_truncate})
            EXPECT_NEAR(error(storage, Sums::fp32), single, 0.05 * single);
        EXPECT_NEAR(error(Storage::fp32, Sums::fp16), single, 0.05 * single);
    }
}

TEST(TexelFragment, AllocatesWhatThePlanSaysAndReturnsIt) {
    const auto context = make_context(second_kind());
    for (const bool grid : {false, true}) {
        const TexelDataset data({.grid = grid, .encoding = grid ? Encoding::u8_linear : Encoding::u16_linear});
        for (const TexelModel* model : models_up_to(most_fragment_parameters))
            for (const Passes passes : {Passes::paper, Passes::r300, Passes::combined})
                for (const auto& [storage, sums, resident] :
                     {std::tuple{Storage::fp32, Sums::fp32, false}, std::tuple{Storage::fp16, Sums::fp16, false},
                      std::tuple{Storage::fp32, Sums::fp32, true}})
                    for (const int images_per_pass : {0, 2}) {
                        // Models differ in their number of parameters alone: one of them in every way is enough.
                        if (model->name != std::string_view("lafortune") &&
                            (storage == Storage::fp16 || images_per_pass))
                            continue;
                        TexelOptions options;
                        options.model = model;
                        const FragmentOptions fragment{.passes = passes,
                                                       .storage = storage,
                                                       .sums = sums,
                                                       .keep_on_device = resident,
                                                       .images_per_pass = images_per_pass};
                        const Room room = room_of({.rule = resident ? Rule::lbfgs : Rule::adam});
                        uint64_t planned = 0;
                        for (const PlannedArray& row :
                             plan_texel_engine(data.dataset, *data.atlas, data.views, options, fragment, room))
                            if (row.array != on_their_way || !context->software()) planned += row.bytes;
                        TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options, fragment);
                        engine.make_room(room);
                        EXPECT_EQ(planned, engine.bytes()) << model->name << " " << to_string(passes);
                        engine.count();
                        engine.reset(engine.start());
                        engine.gradient_pass(true);
                        EXPECT_EQ(engine.bytes(), uint64_t(context->allocated_bytes()));
                    }
    }
    EXPECT_EQ(context->allocated_bytes(), 0);
}

TEST(TexelFragment, EveryAllocationThatFailsIsTold) {
    const TexelDataset data({.grid = true});
    SharedContext::use();
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    for (const Passes passes : {Passes::paper, Passes::r300, Passes::combined})
        EXPECT_GT(fail_each_allocation([&] {
                      TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options,
                                                 {.passes = passes, .keep_on_device = true});
                      run(engine, {.iterations = 1});
                  }),
                  15);
}

// tests/check_costs.py holds the declarations to the shaders; this, the passes over linear images to the declarations.
TEST(TexelFragment, EveryPassDeclaresItsCost) {
    const auto context = make_context(second_kind());
    for (const auto& [grid, one_eye] : {std::pair{false, false}, std::pair{true, false}, std::pair{true, true}}) {
        const TexelDataset data({.grid = grid, .one_eye = one_eye});
        for (const char* name : {"lambert", "lafortune"})  // a model may be added without
            for (const Passes passes : {Passes::paper, Passes::r300, Passes::combined}) {
                TexelOptions options;
                options.model = find_texel_model(name);
                TexelFragmentEngine engine(data.dataset, *data.atlas, data.views, options, {.passes = passes});
                engine.passes().tally(true);
                engine.count();
                engine.reset(engine.start());
                OptimizerOptions optimizer;
                optimizer.iterations = 1;
                optimize(engine, optimizer);
                EXPECT_GT(engine.passes().tallies().size(), 8u);
                for (const auto& [label, tally] : engine.passes().tallies())
                    EXPECT_NE(tally.cost, nullptr) << label << " declares no cost";
            }
    }
}

TEST(TexelFragment, RefusesImagesWithoutLights) {
    const auto context = make_context(second_kind());
    TexelDataset data({});
    for (View& view : data.dataset.views) view.light.reset();
    TexelOptions options;
    options.model = find_texel_model("lambert");
    EXPECT_THROW(TexelFragmentEngine(data.dataset, *data.atlas, data.views, options, {}), UserError);
}

// Lafortune where the ornament is Lafortune, within what its CG needs of iterations.
TEST(TexelFragment, RecoversGoldAndGreenOfTheOrnament) {
    set_quiet(true);
    const TemporaryFolder folder;
    generate_synthetic(
        {.shape = "ornament", .scale = "smoke", .ornament = {.sensor = {.encoding = Encoding::f32_linear}}},
        folder.path() / "set");
    const Dataset dataset = open_dataset(folder.path() / "set");
    const ReflectanceTruth truth = read_truth(folder.path() / "set");
    const TriangleAtlas atlas = reflectance_atlas(dataset, truth.side);
    SharedContext::use();
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    std::vector<uint32_t> views(dataset.views.size());
    for (uint32_t i = 0; i < views.size(); ++i) views[i] = i;
    TexelFragmentEngine engine(dataset, atlas, views, options, {.passes = Passes::combined});
    OptimizerOptions optimizer;
    optimizer.iterations = 14;
    const Fitted fit = run(engine, optimizer);
    std::vector<double> errors;
    for (size_t texel = 0; texel < fit.outcomes.size(); ++texel) {
        if (truth.materials[truth.material[texel]].model != "lafortune" || fit.statistics.samples[texel] < 30) continue;
        std::vector<float> p(fit.parameters.begin() + ptrdiff_t(9 * texel),
                             fit.parameters.begin() + ptrdiff_t(9 * texel + 9));
        options.model->make_canonical(p);
        p[8] = std::exp(p[8]);
        double worst = 0;
        for (size_t i = 0; i < 9; ++i)
            worst = std::max(worst, std::abs(double(p[i]) - double(truth.parameters[texel][i])) /
                                        std::abs(double(truth.parameters[texel][i])));
        errors.push_back(worst);
    }
    ASSERT_GT(errors.size(), 1000u);
    std::sort(errors.begin(), errors.end());
    std::printf("  of %zu texels, worst of nine: median %.2e, ninth tenth %.2e; %.1f ns CPU a texel and image\n",
                errors.size(), errors[errors.size() / 2], errors[errors.size() * 9 / 10],
                1e9 * engine.times().sweep_cpu_s / double(engine.times().images) / double(atlas.texel_count()));
    EXPECT_LT(errors[errors.size() / 2], 0.02);
}

}  // namespace
}  // namespace radiafit
