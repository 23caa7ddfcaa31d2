// The fragment engine against its oracles, and what is its own.
#include <gtest/gtest.h>

#include "failing_gl.h"
#include "fragment/fragment_plan.h"
#include "fragment/view_order.h"
#include "gl/held_bytes.h"
#include "lfm_agreement.h"

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
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Cases, FragmentAgreement, ::testing::ValuesIn(cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Cases, FragmentIterations, ::testing::ValuesIn(structural_cases(cases())), case_name);

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
        if (software) {
            EXPECT_EQ(first, run(ContextKind::osmesa, passes, Storage::fp32, noise.dataset));
        }
    }
}

TEST(Fragment, HalfStorageStaysNearSingle) {
    const NoiseDataset noise(awkward_mesh(1));
    const float single = run(ContextKind::osmesa, Passes::paper, Storage::fp32, noise.dataset).back();
    const float half = run(ContextKind::osmesa, Passes::paper, Storage::fp16, noise.dataset).back();
    const float truncated = run(ContextKind::osmesa, Passes::paper, Storage::fp16_truncate, noise.dataset).back();
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
            return run(ContextKind::osmesa, passes, Storage::fp32, noise.dataset, StreamSource::memory, sums).back();
        };
        const float single = error_with(Sums::fp32), half = error_with(Sums::fp16);
        // Up to 7 truncated additions of 2^-10 each to a vertex's sum, and as much again by way of the parameters.
        EXPECT_NEAR(half, single, 14.0f / 1024 * single);
        EXPECT_NE(half, single);
    }
}

TEST(Fragment, TermsThatAreNotFittedHaveNoGradient) {
    const NoiseDataset noise(awkward_mesh(0));
    const auto context = make_context(ContextKind::osmesa);
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
    for (Passes passes : {Passes::paper, Passes::combined})
        for (Mode mode : {Mode::paper, Mode::modern}) {
            LfmOptions options;
            options.mode = mode;
            options.lookup = mode == Mode::paper ? ViewLookup::nearest : ViewLookup::bilinear;
            FragmentEngine engine(noise.dataset, atlas, rings, all_views(), options, {.passes = passes});
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
                ASSERT_NE(tally.cost, nullptr) << label << " declares no cost";
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
            // gather.
            EXPECT_EQ(tiles, texels);
            EXPECT_EQ(passes == Passes::paper, tiles > 0);
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
    const auto context = make_context(ContextKind::osmesa);
    for (const Dataset* dataset : {&noise.dataset, &deep.dataset})
        for (Passes passes : {Passes::paper, Passes::combined})
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
    for (const Passes passes : {Passes::paper, Passes::combined})
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
    const auto context = make_context(ContextKind::osmesa);
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
