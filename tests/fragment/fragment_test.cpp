// The fragment engine against its oracles, and what is its own.
#include <gtest/gtest.h>

#include "context_kinds.h"
#include "failing_gl.h"
#include "fragment/fragment_plan.h"
#include "fragment/view_order.h"
#include "gl/held_bytes.h"
#include "lfm_agreement.h"
#include "watched_draws.h"

namespace radiafit {
using namespace harness;
namespace {

class FragmentAgreement : public ::testing::TestWithParam<Case> {};

TEST_P(FragmentAgreement, WithTheOracle) {
    const Case& c = GetParam();
    agree_with_the_oracle(c, [&](const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                                 const SampleList&, const LfmOptions& options) {
        return std::make_unique<FragmentEngine>(
            dataset, atlas, rings, all_views(), options,
            FragmentOptions{.passes = c.passes, .images_per_pass = c.images_per_pass});
    });
}

using FragmentIterations = FragmentAgreement;
TEST_P(FragmentIterations, WithTheCpuEngine) {
    const Case& c = GetParam();
    agree_with_the_cpu_engine_over_iterations(
        c, [&](const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList&,
               const LfmOptions& options) {
            return std::make_unique<FragmentEngine>(dataset, atlas, rings, all_views(), options,
                                                    FragmentOptions{.passes = c.passes});
        });
}

std::vector<Case> cases() {
    std::vector<Case> list;
    for (Passes passes : {Passes::paper, Passes::combined}) {
        const std::string prefix = to_string(passes);
        list.push_back({.name = prefix + "_plain", .passes = passes, .levels = 2});
        list.push_back({.name = prefix + "_two_terms", .terms = 2, .passes = passes});
        list.push_back({.name = prefix + "_nearest", .lookup = ViewLookup::nearest, .passes = passes});
        list.push_back({.name = prefix + "_odd_sides_16_bit",
                        .surface_side = 7,
                        .view_side = 5,
                        .passes = passes,
                        .encoding = Encoding::u16_linear});
        list.push_back(
            {.name = prefix + "_large_sides", .surface_side = 22, .view_side = 17, .passes = passes, .levels = 0});
        list.push_back({.name = prefix + "_huber", .terms = 2, .passes = passes, .loss = {LossKind::huber, 0.4f}});
        list.push_back({.name = prefix + "_cauchy", .passes = passes, .loss = {LossKind::cauchy, 0.4f}});
        list.push_back({.name = prefix + "_facing", .passes = passes, .loss = {.weights = SampleWeights::facing}});
        list.push_back({.name = prefix + "_huber_facing",
                        .terms = 2,
                        .lookup = ViewLookup::nearest,
                        .passes = passes,
                        .loss = {LossKind::huber, 0.4f, SampleWeights::facing}});
        list.push_back({.name = prefix + "_facing_many_terms",
                        .terms = 9,
                        .surface_side = 4,
                        .view_side = 3,
                        .passes = passes,
                        .loss = {.weights = SampleWeights::facing}});
        list.push_back({.name = prefix + "_small_sides_many_terms",
                        .terms = 9,
                        .surface_side = 2,
                        .view_side = 2,
                        .passes = passes});
    }
    list.push_back({.name = "combined_image_by_image", .passes = Passes::combined, .images_per_pass = 1});
    return list;
}
// With the passes of the paper's chip, which compare with the paper's.
std::vector<Case> chip_cases() {
    std::vector<Case> list = structural_cases(cases());
    std::erase_if(list, [](const Case& c) { return c.passes != Passes::paper; });
    for (Case& c : list) {
        c.passes = Passes::r300;
        c.name.replace(0, to_string(Passes::paper).size(), to_string(Passes::r300));
    }
    return list;
}
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Cases, FragmentAgreement, ::testing::ValuesIn(cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Cases, FragmentIterations, ::testing::ValuesIn(structural_cases(cases())), case_name);
INSTANTIATE_TEST_SUITE_P(OfTheChip, FragmentAgreement, ::testing::Values(chip_cases().front()), case_name);

/// One engine of each kind of passes, for the same fits.
class ChipEngines {
public:
    ChipEngines(const Case& c, Mode mode, Storage storage)
        : noise_(awkward_mesh(c.levels), c.encoding),
          atlas_(noise_.dataset.mesh, c.surface_side),
          rings_(noise_.dataset.mesh) {
        const LfmOptions options = options_of(c, mode);
        const Sums sums = storage == Storage::fp16 ? Sums::fp16 : Sums::fp32;
        for (const Passes passes : {Passes::paper, Passes::r300})
            engines_.push_back(
                std::make_unique<FragmentEngine>(noise_.dataset, atlas_, rings_, all_views(), options,
                                                 FragmentOptions{.passes = passes, .storage = storage, .sums = sums}));
        for (const auto& engine : engines_) starts_.push_back(lfm_start(engine->layout(), engine->count().mean, 3));
    }
    struct Fitted {
        std::vector<float> parameters, errors;
        Trace trace;
    };
    Fitted fit(size_t which, Rule rule) {
        FragmentEngine& engine = *engines_[which];
        engine.reset(starts_[which]);
        Fitted fitted{.parameters = std::vector<float>(engine.layout().size()),
                      .errors = std::vector<float>(engine.problem_count()),
                      .trace = optimize(engine, {.rule = rule, .iterations = 3})};
        engine.read_parameters(fitted.parameters);
        engine.read_errors(fitted.errors);
        return fitted;
    }

private:
    NoiseDataset noise_;
    TriangleAtlas atlas_;
    VertexRings rings_;
    std::vector<std::unique_ptr<FragmentEngine>> engines_;
    std::vector<std::vector<float>> starts_;
};

// What r300 does otherwise is where values are looked up, which programs write them, and zeros that are added: every
// sum has the same terms in the same order. Only the sum of all problems' errors, by blocks of another size, is rounded
// otherwise, beyond the 48 bits that it is kept in. On a chip a compiler may fuse a product and a sum in one program
// and not in another.
void expect_same_fits(const Case& c, Mode mode, Storage storage, const std::vector<Rule>& rules) {
    const bool software = SharedContext::use().software();
    ChipEngines engines(c, mode, storage);
    for (const Rule rule : rules) {
        const ChipEngines::Fitted paper = engines.fit(0, rule), r300 = engines.fit(1, rule);
        const std::string what = "rule " + std::to_string(int(rule)) + ", storage " + std::to_string(int(storage));
        ASSERT_EQ(paper.trace.rows.size(), r300.trace.rows.size());
        EXPECT_LT(r300.trace.rows.back().error, r300.trace.rows.front().error) << what;
        for (size_t i = 0; i < paper.trace.rows.size(); ++i) {
            const auto &a = paper.trace.rows[i], &b = r300.trace.rows[i];
            EXPECT_NEAR(a.error, b.error, (software ? 1e-12 : 1e-3) * a.error) << what << ", iteration " << i;
            if (!software) continue;
            EXPECT_EQ(a.accepted, b.accepted) << what;
            EXPECT_EQ(a.active, b.active) << what;
        }
        if (!software) continue;
        EXPECT_EQ(paper.parameters, r300.parameters) << what;
        EXPECT_EQ(paper.errors, r300.errors) << what;
    }
}

class FragmentOfTheChip : public ::testing::TestWithParam<Case> {};
TEST_P(FragmentOfTheChip, FitsTheBitsOfThePaperPasses) {
    const Case& c = GetParam();
    const bool plain = c.name.ends_with("plain");  // of the others, rules are the same
    const std::vector<Rule> modern{Rule::cg_modern, Rule::lbfgs, Rule::adam};
    expect_same_fits(c, Mode::modern, Storage::fp32, plain ? modern : std::vector{Rule::cg_modern});
    if (!plain) return;
    expect_same_fits(c, Mode::paper, Storage::fp32, {Rule::steepest_descent, Rule::cg_paper});
    for (const Storage storage : {Storage::fp16, Storage::fp16_truncate})
        expect_same_fits(c, Mode::paper, storage, {Rule::cg_paper});
}
INSTANTIATE_TEST_SUITE_P(Cases, FragmentOfTheChip, ::testing::ValuesIn(chip_cases()), case_name);

TEST(Fragment, PassesOfTheChipBindWhatItCould) {
    const NoiseDataset noise(awkward_mesh(0));
    SharedContext::use();
    const TriangleAtlas atlas(noise.dataset.mesh, 8);
    const VertexRings rings(noise.dataset.mesh);
    for (const Passes passes : {Passes::paper, Passes::r300})
        for (const Mode mode : {Mode::paper, Mode::modern}) {
            const WatchedDraws watched;
            LfmOptions options;
            options.mode = mode;
            options.lookup = mode == Mode::paper ? ViewLookup::nearest : ViewLookup::bilinear;
            FragmentEngine engine(noise.dataset, atlas, rings, all_views(), options, {.passes = passes});
            const std::vector<float> start = lfm_start(engine.layout(), engine.count().mean, 1);
            PassRunner& run = engine.passes();
            run.tally(true);
            for (const Rule rule : mode == Mode::paper ? std::vector{Rule::steepest_descent, Rule::cg_paper}
                                                       : std::vector{Rule::cg_modern}) {
                engine.reset(start);
                optimize(engine, {.rule = rule, .iterations = 1});
            }
            run.tally(false);
            if (mode == Mode::modern) {  // of which no costs are declared
                engine.reset(start);
                optimize(engine, {.rule = Rule::lbfgs, .iterations = 2});
            }
            const DrawCounts& counts = watched.counts();
            EXPECT_GT(counts.draws, 500);
            EXPECT_EQ(counts.unknown, 0);
            EXPECT_EQ(counts.several_targets > 0, passes == Passes::paper);
            EXPECT_EQ(counts.vertex_look_ups > 0, passes == Passes::paper);
            EXPECT_EQ(counts.own_target_read > 0, passes == Passes::paper);
            if (passes == Passes::r300) expect_costs_of_the_chip(run);
        }
}

std::vector<float> run(ContextKind kind, Passes passes, Storage storage, const Dataset& dataset,
                       StreamSource source = StreamSource::memory, Sums sums = Sums::fp32, bool resident = false) {
    const auto context = make_context(kind);
    const TriangleAtlas atlas(dataset.mesh, 8);
    const VertexRings rings(dataset.mesh);
    FragmentOptions fragment;
    fragment.passes = passes;
    fragment.storage = storage;
    fragment.source = source;
    fragment.sums = sums;
    fragment.keep_on_device = resident;
    FragmentEngine engine(dataset, atlas, rings, all_views(), {}, fragment);
    engine.reset(lfm_start(engine.layout(), engine.count().mean, 3));
    OptimizerOptions optimizer;
    optimizer.iterations = 3;
    const Trace trace = optimize(engine, optimizer);
    std::vector<float> p(engine.layout().size());
    engine.read_parameters(p);
    p.push_back(float(trace.rows.back().error));
    return p;
}

TEST(Fragment, SamplesThatAreKeptGiveTheSameBits) {
    for (const Encoding encoding : {Encoding::u8_linear, Encoding::u16_linear}) {
        const NoiseDataset noise(awkward_mesh(1), encoding);
        const TriangleAtlas atlas(noise.dataset.mesh, 8);
        const VertexRings rings(noise.dataset.mesh);
        SharedContext::use();
        std::vector<float> fitted[2];
        for (const bool keep : {false, true}) {
            const FragmentOptions fragment{.passes = Passes::paper, .keep_on_device = true, .keep_samples = keep};
            FragmentEngine engine(noise.dataset, atlas, rings, all_views(), {}, fragment);
            uint64_t planned = 0;
            for (const PlannedArray& row : plan_fragment_engine(noise.dataset, atlas, rings, all_views(), {}, fragment))
                planned += row.bytes;
            EXPECT_EQ(planned, engine.bytes());
            engine.reset(lfm_start(engine.layout(), engine.count().mean, 3));
            optimize(engine, OptimizerOptions{.iterations = 3});
            fitted[keep].resize(engine.layout().size());
            engine.read_parameters(fitted[keep]);
        }
        EXPECT_EQ(fitted[0], fitted[1]);
        EXPECT_THROW(FragmentEngine(noise.dataset, atlas, rings, all_views(), {},
                                    {.passes = Passes::combined, .keep_samples = true}),
                     std::invalid_argument);
    }
}

TEST(Fragment, SameBitsTwiceFromAnySourceAndInEveryContext) {
    const NoiseDataset noise(awkward_mesh(1));
    for (Passes passes : {Passes::paper, Passes::combined}) {
        const auto first = run(ContextKind::egl, passes, Storage::fp32, noise.dataset);
        for (StreamSource source : {StreamSource::disk, StreamSource::disk_cold})
            EXPECT_EQ(first, run(ContextKind::egl, passes, Storage::fp32, noise.dataset, source));
        EXPECT_EQ(first,
                  run(ContextKind::egl, passes, Storage::fp32, noise.dataset, StreamSource::disk, Sums::fp32, true));
        const bool software = [] { return make_context(ContextKind::egl)->software(); }();
        if (software && has_osmesa()) {
            EXPECT_EQ(first, run(second_kind(), passes, Storage::fp32, noise.dataset));
        }
    }
}

TEST(Fragment, HalfStorageStaysNearSingle) {
    const NoiseDataset noise(awkward_mesh(1));
    const float single = run(second_kind(), Passes::paper, Storage::fp32, noise.dataset).back();
    const float half = run(second_kind(), Passes::paper, Storage::fp16, noise.dataset).back();
    const float truncated = run(second_kind(), Passes::paper, Storage::fp16_truncate, noise.dataset).back();
    // Parameters of order one keep 11 bits: residuals move by up to 5e-4 of a range of one, errors by about as much.
    EXPECT_NEAR(half, single, 5e-3f * single);
    EXPECT_NEAR(truncated, single, 2e-2f * single);
    EXPECT_NE(half, single);
    EXPECT_NE(half, truncated);
}

TEST(Fragment, HalfSumsStayNearSingleInBothKindsOfPasses) {
    const NoiseDataset noise(awkward_mesh(1));
    for (Passes passes : {Passes::paper, Passes::combined}) {
        const auto error_with = [&](Sums sums) {
            return run(second_kind(), passes, Storage::fp32, noise.dataset, StreamSource::memory, sums).back();
        };
        const float single = error_with(Sums::fp32), half = error_with(Sums::fp16);
        // Up to 7 truncated additions of 2^-10 each to a vertex's sum, and as much again by way of the parameters.
        EXPECT_NEAR(half, single, 14.0f / 1024 * single);
        EXPECT_NE(half, single);
    }
}

TEST(Fragment, TermsThatAreNotFittedHaveNoGradient) {
    const NoiseDataset noise(awkward_mesh(0));
    const auto context = make_context(second_kind());
    const TriangleAtlas atlas(noise.dataset.mesh, 4);
    const VertexRings rings(noise.dataset.mesh);
    LfmOptions options;
    options.terms = 2;
    options.surface_side = 4;
    FragmentEngine engine(noise.dataset, atlas, rings, all_views(), options, {});
    engine.count();
    engine.reset(random_vector(engine.layout(), 0, 1, 1));
    engine.fit_terms(1, 2);
    engine.gradient_pass(false);
    const std::vector<float> gradient = engine.read_evaluation().gradient;
    size_t moving = 0;
    for (size_t i = 0; i < gradient.size(); ++i) {
        if (i % 8 < 4) {
            ASSERT_EQ(gradient[i], 0.0f);
        } else {
            moving += gradient[i] != 0;
        }
    }
    EXPECT_GT(moving, gradient.size() / 20);
}

// tests/check_costs.py holds the declarations to the shaders; this, the passes to the declarations.
TEST(Fragment, EveryPassDeclaresItsCostAndItsInvocationsAreCounted) {
    const NoiseDataset noise(awkward_mesh(1));
    SharedContext::use();
    const TriangleAtlas atlas(noise.dataset.mesh, 8);
    const VertexRings rings(noise.dataset.mesh);
    for (Passes passes : {Passes::paper, Passes::r300, Passes::combined})
        for (const auto& [mode, storage] :
             {std::pair{Mode::paper, Storage::fp32}, {Mode::modern, Storage::fp32}, {Mode::paper, Storage::fp16}}) {
            LfmOptions options;
            options.mode = mode;
            options.lookup = mode == Mode::paper ? ViewLookup::nearest : ViewLookup::bilinear;
            FragmentEngine engine(noise.dataset, atlas, rings, all_views(), options,
                                  {.passes = passes, .storage = storage});
            PassRunner& run = engine.passes();
            run.tally(true);
            const uint64_t draws = run.counters.draws;
            engine.reset(lfm_start(engine.layout(), engine.count().mean, 1));
            OptimizerOptions optimizer;
            optimizer.rule = mode == Mode::paper ? Rule::cg_paper : Rule::cg_modern;
            optimizer.iterations = 1;
            optimize(engine, optimizer);
            const auto tallies = run.tallies();
            uint64_t tallied = 0, tiles = 0, texels = 0;
            for (const auto& [label, tally] : tallies) {
                EXPECT_NE(tally.cost, nullptr) << label << " declares no cost";
                if (!tally.cost) continue;
                EXPECT_GT(tally.fragments, 0u) << label;
                EXPECT_GT(tally.written_bytes, tally.fragments) << label;
                EXPECT_GE(tally.written_bytes, tally.blended_bytes) << label;
                EXPECT_EQ(tally.entries > 0, tally.cost->entry.operations > 0) << label;
                tallied += tally.draws;
                if (label.starts_with("gather/surface_gradient.frag")) tiles = tally.fragments;
                if (label.starts_with("gather/tile_texels.frag PRODUCT")) texels = tally.entries;
                const uint64_t whole = uint64_t(engine.grid().columns) * engine.grid().rows;
                if (label.starts_with("gather/footprint.frag")) {  // a whole target, for every image and sweep
                    EXPECT_EQ(tally.fragments, tally.draws * whole);
                }
                if (label.starts_with("distribute/item.frag")) {
                    EXPECT_LT(tally.fragments, tally.draws * width * height);
                }
            }
            EXPECT_EQ(tallied, run.counters.draws - draws);
            // The texels of the tiles that an image draws, no more: once for each corner as fragments, and in the
            // gather, but where that looks up as many of every tile.
            if (passes != Passes::r300) {
                EXPECT_EQ(tiles, texels);
            }
            EXPECT_EQ(passes != Passes::combined, tiles > 0);
            run.tally(false);
            engine.directional_pass();
            EXPECT_EQ(run.tallies().size(), tallies.size());
        }
}

TEST(Fragment, BatchesAreNeighboursAndLoseNoView) {
    Dataset dataset;
    dataset.mesh = awkward_mesh(0);
    // Five clusters of four views, each within a degree, the clusters far apart; shuffled.
    std::mt19937 rng(3);
    std::vector<uint32_t> views;
    for (int i = 0; i < 20; ++i) {
        View view;
        view.camera = orbit_camera(i / 4, 5, width, height);
        view.camera.cam_from_world_translation += 0.02 * Vec3d(i % 4, i % 3, 0);
        dataset.views.push_back(view);
        views.push_back(uint32_t(i));
    }
    std::shuffle(views.begin(), views.end(), rng);
    for (int batch : {4, 3, 7}) {
        const std::vector<uint32_t> order = batches_of_neighbours(dataset, views, batch);
        EXPECT_TRUE(std::is_permutation(order.begin(), order.end(), views.begin(), views.end()));
        EXPECT_EQ(order, batches_of_neighbours(dataset, views, batch));
        for (size_t i = 0; i < order.size() && batch == 4; ++i)
            EXPECT_EQ(order[i] / 4, order[i / 4 * 4] / 4) << "place " << i;
    }
}

TEST(Fragment, AllocatesWhatThePlanSays) {
    const NoiseDataset noise(awkward_mesh(1)), deep(awkward_mesh(0), Encoding::u16_linear);
    const auto context = make_context(second_kind());
    for (const Dataset* dataset : {&noise.dataset, &deep.dataset})
        for (Passes passes : {Passes::paper, Passes::r300, Passes::combined})
            for (Storage storage : {Storage::fp32, Storage::fp16, Storage::fp16_truncate})
                for (const auto& [sums, resident, together] :
                     {std::tuple{Sums::fp32, false, 0}, std::tuple{Sums::fp16, false, 1},
                      std::tuple{Sums::fp32, true, 0}}) {
                    LfmOptions options;
                    options.terms = dataset == &deep.dataset ? 2 : 1;
                    options.surface_side = dataset == &deep.dataset ? 22 : 8;
                    options.view_side = dataset == &deep.dataset ? 17 : 8;
                    const FragmentOptions fragment{.passes = passes,
                                                   .storage = storage,
                                                   .sums = sums,
                                                   .keep_on_device = resident,
                                                   .images_per_pass = together};
                    const TriangleAtlas atlas(dataset->mesh, options.surface_side);
                    const VertexRings rings(dataset->mesh);
                    const Room room = room_of({.rule = resident ? Rule::lbfgs : Rule::cg_modern});
                    uint64_t planned = 0;
                    for (const PlannedArray& row :
                         plan_fragment_engine(*dataset, atlas, rings, all_views(), options, fragment, room))
                        if (row.array != on_their_way || !context->software()) planned += row.bytes;
                    FragmentEngine engine(*dataset, atlas, rings, all_views(), options, fragment);
                    engine.make_room(room);
                    EXPECT_EQ(planned, engine.bytes()) << to_string(passes) << " " << int(storage) << " sums "
                                                       << int(sums) << (resident ? " resident" : "");
                }
}

TEST(Fragment, EveryAllocationThatFailsIsTold) {
    const NoiseDataset noise(awkward_mesh(0));
    const TriangleAtlas atlas(noise.dataset.mesh, 4);
    const VertexRings rings(noise.dataset.mesh);
    SharedContext::use();
    for (const Passes passes : {Passes::paper, Passes::r300, Passes::combined})
        EXPECT_GT(fail_each_allocation([&] {
                      FragmentEngine engine(noise.dataset, atlas, rings, all_views(),
                                            {.surface_side = 4, .view_side = 4},
                                            {.passes = passes, .keep_on_device = true});
                      engine.reset(lfm_start(engine.layout(), engine.count().mean, 3));
                      optimize(engine, {.iterations = 1});
                  }),
                  20);
}

TEST(Fragment, CountsItsBytesAndReturnsThem) {
    const NoiseDataset noise(awkward_mesh(1));
    const auto context = make_context(second_kind());
    const TriangleAtlas atlas(noise.dataset.mesh, 8);
    const VertexRings rings(noise.dataset.mesh);
    {
        FragmentEngine engine(noise.dataset, atlas, rings, all_views(), {}, {});
        // Seven arrays of parameters at least, each 16 bytes a texel.
        EXPECT_GT(engine.bytes(), 7 * engine.layout().size() * 4);
        EXPECT_EQ(engine.bytes(), uint64_t(context->allocated_bytes()));
        if (context->software()) {
            EXPECT_EQ(engine.bytes(), held_bytes()) << "the driver tells of others than the program asked for";
        }
    }
    EXPECT_EQ(context->allocated_bytes(), 0);
}

}  // namespace
}  // namespace radiafit
