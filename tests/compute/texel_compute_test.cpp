// The compute engine for texel-local models: its sums against the same in double over its own distribution, and whole
// fits against the CPU's.
#include <gtest/gtest.h>

#include "compute/texel_compute_engine.h"
#include "context_kinds.h"
#include "cpu/texel_solver.h"
#include "failing_gl.h"
#include "optim/optimizer.h"
#include "samples/grid_distributor.h"
#include "several_shapes.h"
#include "shared_context.h"
#include "texel_fragment_scene.h"

namespace radiafit {
using namespace harness;
namespace {

using namespace testing;
static_assert(Engine<TexelComputeEngine>);

struct Case {
    std::string name, model = "lafortune";
    TexelScene scene = {};
    Mode mode = Mode::modern;
    float clip_above = 0, shadow_below = 0;
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

std::unique_ptr<TexelSource> gather(const TexelDataset& data) {
    std::unique_ptr<Distributor> distributor;
    if (const auto* triangles = dynamic_cast<const TriangleAtlas*>(data.atlas.get()))
        distributor = std::make_unique<GlDistributor>(*triangles);
    else
        distributor = std::make_unique<GridDistributor>(dynamic_cast<const GridAtlas&>(*data.atlas));
    return gather_texels(data.dataset, *data.atlas, data.views, {distributor.get()});
}

struct Tally {
    double worst = 0;
    void compare(double value, const ExactSum& expected, const std::string& what) {
        ASSERT_TRUE(std::isfinite(value)) << what;
        const double error = std::abs(value - expected.value);
        worst = std::max(worst, expected.magnitude > 0 ? error / expected.magnitude : error);
        ASSERT_LE(error, 1e-5 * expected.magnitude + 1e-37) << what << ": " << value << " for " << expected.value;
    }
};

class TexelComputeAgreement : public ::testing::TestWithParam<Case> {};

template <class Text>
void agree(const Case& c) {
    using Model = TexelLocal<Text>;
    SharedContext::use();
    const TexelDataset data(c.scene);
    const TexelOptions options = c.options();
    const auto source = gather(data);
    TexelComputeEngine engine(data.dataset, *data.atlas, data.views, options, *source);
    const auto samples = exact_samples<Text>(data, options);
    const size_t texels = data.atlas->texel_count(), each = size_t(Model::parameters);
    const ProblemStatistics statistics = engine.count();
    size_t total = 0;
    std::mt19937 rng(1);
    std::vector<float> p, d;
    for (size_t texel = 0; texel < texels; ++texel) {
        ASSERT_EQ(statistics.samples[texel], samples[texel].size()) << texel;
        total += samples[texel].size();
        for (const auto& [lowest, highest] : options.model->bounds) {  // some beyond their bounds
            const auto low = float(std::max(lowest, -2.0) - 0.1), high = float(std::min(highest, 2.0) + 0.1);
            p.push_back(std::uniform_real_distribution<float>(low, high)(rng));
            d.push_back(std::uniform_real_distribution<float>(-1, 1)(rng));
        }
    }
    ASSERT_GT(total, 400u);
    engine.reset(p);
    engine.gradient_pass(true);
    const auto evaluation = engine.read_evaluation();
    engine.set_line(p, d);
    engine.directional_pass();
    const auto line = engine.read_line();
    Tally error, gradient, diagonal, sums;
    for (size_t texel = 0; texel < texels; ++texel) {
        if (samples[texel].empty()) continue;  // these stay as they are
        typename Model::Parameters at, along;
        for (size_t i = 0; i < each; ++i) {
            at[i] = double(p[texel * each + i]);
            along[i] = double(d[texel * each + i]);
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
    }
    std::printf("  worst of the sums of magnitudes: error %.1e gradient %.1e diagonal %.1e line %.1e\n", error.worst,
                gradient.worst, diagonal.worst, sums.worst);
}

TEST_P(TexelComputeAgreement, WithTheReference) {
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
    for (const TexelModel* model : models_up_to(27))
        for (const bool grid : {false, true})
            list.push_back({.name = model->name + std::string(grid ? "_grid" : "_mesh"),
                            .model = model->name,
                            .scene = {.grid = grid, .light = grid ? Light::Kind::distant : Light::Kind::near},
                            .mode = grid ? Mode::paper : Mode::modern,
                            .clip_above = 0.9f,
                            .shadow_below = 0.4f});
    list.push_back({.name = "several_shapes", .model = several_shapes().name});
    list.push_back({.name = "huber", .scene = {.light = Light::Kind::near}, .loss = {LossKind::huber, 0.3f}});
    list.push_back({.name = "cauchy", .scene = {.grid = true}, .loss = {LossKind::cauchy, 0.3f}});
    list.push_back({.name = "facing", .loss = {.weights = SampleWeights::facing}});
    list.push_back({.name = "huber_facing_one_eye",
                    .scene = {.grid = true, .one_eye = true},
                    .loss = {LossKind::huber, 0.3f, SampleWeights::facing}});
    list.push_back({.name = "eight_bits", .scene = {.encoding = Encoding::u8_linear, .views = 8}});
    return list;
}
INSTANTIATE_TEST_SUITE_P(Cases, TexelComputeAgreement, ::testing::ValuesIn(texel_cases()),
                         [](const auto& info) { return info.param.name; });

struct FittedTexels {
    std::vector<float> parameters;
    Trace trace;
};
FittedTexels run(ContextKind kind, const TexelDataset& data, const TexelOptions& options,
                 const OptimizerOptions& optimizer, const std::vector<float>& start) {
    const auto context = make_context(kind);
    const auto source = gather(data);
    TexelComputeEngine engine(data.dataset, *data.atlas, data.views, options, *source);
    FittedTexels out{start, {}};
    engine.count();
    out.trace = optimize_terms(engine, optimizer, 1, false, out.parameters);
    return out;
}

/// The start of every texel, as the CPU has it.
std::vector<float> start_of(const TexelDataset& data, const TexelOptions& options) {
    SharedContext::use();
    const auto source = gather(data);
    const TexelLoader loader(data.dataset, *data.atlas, data.views, options);
    const auto fit =
        texel_solvers(*options.model).stream({*source, loader, options}, OptimizerOptions{.iterations = 0}, {});
    return fit.parameters;
}

// Parameters that the start leaves in the canonical gauge; so the fits begin alike.
TEST(TexelCompute, FitsAsTheCpuDoes) {
    for (const bool grid : {false, true})
        for (const Rule rule : all_rules()) {
            const TexelDataset data({.grid = grid, .light = Light::Kind::near});
            TexelOptions options;
            options.model = find_texel_model("lafortune");
            OptimizerOptions optimizer;
            optimizer.rule = rule;
            optimizer.iterations = 5;
            const std::vector<float> start = start_of(data, options);
            const FittedTexels a = run(ContextKind::egl, data, options, optimizer, start);
            Trace b;
            {
                SharedContext::use();
                const auto source = gather(data);
                const TexelLoader loader(data.dataset, *data.atlas, data.views, options);
                b = texel_solvers(*options.model).stream({*source, loader, options}, optimizer, {}).trace;
            }
            ASSERT_EQ(a.trace.rows.size(), b.rows.size());
            for (size_t i = 0; i < b.rows.size(); ++i)
                // Conjugate steps amplify rounding, and a few texels may decide otherwise where a trial changes the
                // error by less than rounding.
                EXPECT_NEAR(a.trace.rows[i].error, b.rows[i].error, 2e-3 * b.rows[i].error) << int(rule) << " " << i;
            EXPECT_LT(a.trace.rows.back().error, 0.999 * a.trace.rows.front().error);
        }
}

TEST(TexelCompute, SameBitsTwiceAndInEveryContext) {
    const TexelDataset data({.grid = true});
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    const std::vector<float> start = start_of(data, options);
    const OptimizerOptions optimizer{.iterations = 4};
    const auto first = run(ContextKind::egl, data, options, optimizer, start).parameters;
    EXPECT_EQ(first, run(ContextKind::egl, data, options, optimizer, start).parameters);
    if (has_osmesa() && make_context(ContextKind::egl)->software()) {
        EXPECT_EQ(first, run(second_kind(), data, options, optimizer, start).parameters);
    }
}

TEST(TexelCompute, GroupsOfEverySizeFitAlikeAndGiveTheSameBitsTwice) {
    const TexelDataset data({.grid = true});
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    const std::vector<float> start = start_of(data, options);
    const OptimizerOptions optimizer{.iterations = 2};
    const auto fit = [&] { return run(ContextKind::egl, data, options, optimizer, start).parameters; };
    const std::vector<float> usual = fit();
    for (const char* size : {"8", "32", "64", "128"}) {
        ::setenv("RADIAFIT_GROUP_SIZE", size, 1);
        const std::vector<float> parameters = fit();
        EXPECT_EQ(parameters, fit()) << size;
        ::unsetenv("RADIAFIT_GROUP_SIZE");
        for (size_t i = 0; i < usual.size(); ++i)  // a texel's sums are its own invocation's, whatever the group
            ASSERT_NEAR(parameters[i], usual[i], 1e-5f * (1 + std::abs(usual[i]))) << size << ", " << i;
    }
}

TEST(TexelCompute, EveryAllocationThatFailsIsTold) {
    const TexelDataset data({.grid = true});
    TexelOptions options;
    options.model = find_texel_model("lafortune");
    const std::vector<float> start = start_of(data, options);
    SharedContext::use();
    const auto source = gather(data);
    EXPECT_GT(fail_each_allocation([&] {
                  TexelComputeEngine engine(data.dataset, *data.atlas, data.views, options, *source);
                  engine.count();
                  std::vector<float> parameters = start;
                  optimize_terms(engine, {.iterations = 1}, 1, false, parameters);
              }),
              10);
}

}  // namespace
}  // namespace radiafit
