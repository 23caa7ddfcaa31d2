// The CPU baseline: records on disk against the sample list they must hold, and vertex after vertex against all at
// once.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "cpu/lfm_engine.h"
#include "cpu/two_step_solver.h"
#include "model/lfm_start.h"
#include "samples/block_file.h"
#include "samples/interpolated_samples.h"
#include "samples/raster_distributor.h"
#include "scenes.h"
#include "synthetic/synthetic.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {
namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The star at smoke scale on disk, made once.
struct Star {
    TemporaryFolder folder;
    Dataset dataset;
    VertexRings rings;
    Star() : dataset(make(folder.path() / "star")), rings(dataset.mesh) {}
    static Dataset make(const fs::path& path) {
        generate_synthetic({.shape = "star", .scale = "smoke"}, path);
        return open_dataset(path);
    }
};
Star& star() {
    static Star scene;
    return scene;
}

struct Written {
    TemporaryFolder folder;
    RecordStatistics statistics;
    Written(const TriangleAtlas& atlas, const RecordOptions& options, bool interpolated = false) {
        if (interpolated) {
            InterpolatedSampler sampler(star().dataset, atlas, options.space);
            statistics = write_records(folder.path(), star().dataset, atlas, star().rings, star().dataset.split(false),
                                       sampler, options);
            return;
        }
        const auto owned = raster_distributors(atlas);
        statistics = write_records(folder.path(), star().dataset, atlas, star().rings, star().dataset.split(false),
                                   worker_pointers(owned), options);
    }
    DiskRecords records(const std::string& key = "") const { return {folder.path(), key}; }
};

SampleList list_of(const TriangleAtlas& atlas, TargetSpace space = TargetSpace::stored, bool interpolated = false) {
    if (interpolated) return interpolated_samples(star().dataset, atlas, star().dataset.split(false), space);
    const auto owned = raster_distributors(atlas);
    return build_sample_list(star().dataset, atlas, star().dataset.split(false), worker_pointers(owned), space,
                             nullptr);
}

LfmOptions model(int terms = 1, int surface_side = 8) {
    LfmOptions o;
    o.terms = terms;
    o.surface_side = surface_side;
    o.view_side = 6;
    return o;
}

TEST(DiskRecords, DoNotDependOnMemoryOrThreads) {
    const TriangleAtlas atlas(star().dataset.mesh, 8);
    for (const RecordKind kind : {RecordKind::compact, RecordKind::full}) {
        const Written all(atlas, {.kind = kind});
        const Written little(atlas, {.kind = kind, .memory = 50'000});
        set_thread_count(1);
        const Written alone(atlas, {.kind = kind, .memory = 200'000});
        set_thread_count(0);
        EXPECT_EQ(all.statistics.waiting_parts, 0u);
        EXPECT_GT(little.statistics.waiting_parts, 3u);
        EXPECT_GT(little.statistics.bytes_read, 0u);
        for (const char* name : {"records.bin", "index.bin", "records.json"}) {
            const std::string expected = contents(all.folder.path() / name);
            ASSERT_GT(expected.size(), 100u);
            EXPECT_EQ(contents(little.folder.path() / name), expected) << name;
            EXPECT_EQ(contents(alone.folder.path() / name), expected) << name;
        }
        // nothing that waited stays
        EXPECT_EQ(std::distance(fs::directory_iterator(little.folder.path()), fs::directory_iterator()), 3);
    }
}

/// Direction and line sums of every vertex from its record, against the list in double.
void against_list(const RecordOptions& records, const LfmOptions& options, bool interpolated = false) {
    const TriangleAtlas atlas = surface_atlas(star().dataset.mesh, options);
    const Written written(atlas, records, interpolated);
    const DiskRecords on_disk = written.records();
    const SampleList list = list_of(atlas, records.space, interpolated);
    LfmProblem<double> oracle(star().dataset, atlas, star().rings, list, options);
    VertexProblem problem(star().dataset, atlas, star().rings, on_disk.views(), options);
    const ProblemStatistics expected = oracle.count();
    const LfmLayout& layout = oracle.layout();
    Rng rng(3);
    std::vector<uint8_t> block;
    size_t checked = 0;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        on_disk.read(v, v + 1, block);
        problem.load(v, on_disk, block.data());
        const size_t size = layout.block_size(v) / 4;
        ASSERT_EQ(4 * problem.begin(1), layout.block_size(v));
        ASSERT_EQ(problem.count().samples[0], expected.samples[v]);
        std::vector<Lanes<float>> p(size), d(size), g(size), diagonal(size);
        std::vector<Lanes<double>> p2(size), d2(size), g2(size), diagonal2(size);
        for (size_t i = 0; i < size; ++i)
            for (int c = 0; c < 3; ++c) {
                p2[i][c] = p[i][c] = rng.uniform(0.2f, 1.2f);
                d2[i][c] = d[i][c] = rng.uniform(-1.0f, 1.0f);
            }
        double e[3], e2[3];
        problem.direction(0, p.data(), g.data(), diagonal.data(), e);
        oracle.direction(v, p2.data(), g2.data(), diagonal2.data(), e2);
        LineLanes line, line2;
        problem.line(0, p.data(), d.data(), line);
        oracle.line(v, p2.data(), d2.data(), line2);
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(problem.count().mean[size_t(c)], expected.mean[3 * v + size_t(c)], 1e-6);
            ASSERT_NEAR(e[c], e2[c], 2e-6 * e2[c]);
            ASSERT_NEAR(line.gauss_newton[c], line2.gauss_newton[c], 2e-6 * line2.gauss_newton[c]);
            // sums with both signs: against the sum of magnitudes, which a^2 and b^2 bound
            const double scale = line2.gauss_newton[c] + line2.fourth[c] + 2 * e2[c];
            ASSERT_NEAR(line.curvature[c], line2.curvature[c], 2e-6 * scale);
            ASSERT_NEAR(line.third[c], line2.third[c], 2e-6 * scale);
            ASSERT_NEAR(line.fourth[c], line2.fourth[c], 2e-6 * scale);
            double largest = 0;
            for (size_t i = 0; i < size; ++i) largest = std::max(largest, std::abs(g2[i][c]));
            for (size_t i = 0; i < size; ++i) {
                ASSERT_NEAR(g[i][c], g2[i][c], 2e-6 * largest + 1e-9);
                // a full record's view coordinates are floats, and so are the small weights they leave
                ASSERT_NEAR(diagonal[i][c], diagonal2[i][c], 2e-5 * diagonal2[i][c]);
                ++checked;
            }
        }
    }
    EXPECT_GT(checked, 10'000u);
}

TEST(VertexProblem, AgreesWithTheListFromCompactRecords) {
    against_list({}, model());
    against_list({.memory = 60'000}, model(2));
    against_list({.space = TargetSpace::linear}, model(1, 5));  // 16-bit channels
    for (const RecordKind kind : {RecordKind::compact, RecordKind::full})
        against_list({.kind = kind}, testing::with_own_sides(model(2, 12), star().dataset.mesh));
    against_list({}, model(5, 16));  // places of two bytes, terms in a loop
    LfmOptions facing = model(2);
    facing.loss.weights = SampleWeights::facing;
    against_list({}, facing);
    against_list({.kind = RecordKind::full}, facing);
    against_list({.memory = 60'000}, model(2), true);
    against_list({.kind = RecordKind::full}, model(2), true);
}
TEST(VertexProblem, AgreesWithTheListFromFullRecords) {
    against_list({.kind = RecordKind::full}, model());
    LfmOptions nearest = model(1, 7);
    nearest.lookup = ViewLookup::nearest;
    against_list({.kind = RecordKind::full, .space = TargetSpace::linear}, nearest);
}

TEST(TwoStep, EndsWhereTheStreamEngineDoes) {
    const TriangleAtlas atlas(star().dataset.mesh, 8);
    const Written written(atlas, {});
    const DiskRecords on_disk = written.records();
    const SampleList list = list_of(atlas);
    for (const Rule rule : all_rules()) {
        const bool paper = rule == Rule::cg_paper || rule == Rule::steepest_descent;
        LfmOptions options = model();
        options.mode = paper ? Mode::paper : Mode::modern;
        options.mu = paper ? 1e-4f : 1.0f;
        const VertexSolverOptions two_step{.optimizer = {.rule = rule, .iterations = 25}};
        const TwoStepResult result = solve_two_step(star().dataset, atlas, star().rings, on_disk, options, two_step);
        LfmProblem<float> problem(star().dataset, atlas, star().rings, list, options);
        StreamEngine<float> engine(problem);
        const ProblemStatistics statistics = engine.count();
        engine.reset(lfm_start(problem.layout(), statistics.mean, 1));
        const Trace trace = optimize(engine, two_step.optimizer);
        std::vector<ProblemOutcome> expected(engine.problem_count());
        engine.outcomes(expected);
        size_t close = 0, problems = 0;
        for (size_t i = 0; i < expected.size(); ++i) {
            if (expected[i].status == Status::no_samples) {
                EXPECT_EQ(result.outcomes[i].status, Status::no_samples);
                continue;
            }
            ++problems;
            close += std::abs(result.outcomes[i].error - expected[i].error) <= 1e-4f * expected[i].error;
        }
        // Rounding grows from step to step where a problem has few samples, as many have at this scale; and with Adam,
        // whose steps are as long where the gradient is all rounding.
        EXPECT_GE(double(close), (rule == Rule::adam ? 0.85 : 0.97) * double(problems)) << "rule " << int(rule);
        ASSERT_EQ(result.trace.rows.size(), trace.rows.size());
        for (size_t k = 0; k < trace.rows.size(); ++k) {
            EXPECT_NEAR(result.trace.rows[k].error, trace.rows[k].error, 1e-4 * trace.rows[k].error);
            EXPECT_EQ(result.trace.rows[k].iteration, int(k));
        }
        uint64_t bytes = 0;
        for (size_t v = 0; v < on_disk.vertex_count(); ++v) bytes += on_disk.block_bytes(v);
        EXPECT_EQ(result.bytes_read, bytes);
    }
}

TEST(VertexProblem, SameBitsFromTheListAsFromItsRecord) {
    for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear}) {
        const TriangleAtlas atlas(star().dataset.mesh, 8);
        const Written written(atlas, {.space = space});
        const DiskRecords on_disk = written.records();
        const SampleList list = list_of(atlas, space);
        VertexProblem from_list(star().dataset, atlas, star().rings, list.views, model(2)), from_record = from_list;
        std::vector<uint8_t> block;
        for (size_t v = 0; v < on_disk.vertex_count(); ++v) {
            on_disk.read(v, v + 1, block);
            from_record.load(v, on_disk, block.data());
            from_list.load(v, list, on_disk.vertex(v).mean);
            const size_t size = from_record.begin(1);
            ASSERT_EQ(from_list.begin(1), size);
            ASSERT_EQ(from_list.count().samples, from_record.count().samples);
            std::vector<Lanes<float>> p(size, broadcast3(0.6f)), g(size), g2(size), diagonal(size), diagonal2(size);
            double error[3], error2[3];
            from_record.direction(0, p.data(), g.data(), diagonal.data(), error);
            from_list.direction(0, p.data(), g2.data(), diagonal2.data(), error2);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(error[c], error2[c]);
            EXPECT_EQ(std::memcmp(g.data(), g2.data(), size * sizeof g[0]), 0);
            EXPECT_EQ(std::memcmp(diagonal.data(), diagonal2.data(), size * sizeof g[0]), 0);
        }
    }
}

TEST(VertexSolver, EndsWhereTwoStepDoesForAnyThreads) {
    const TriangleAtlas atlas(star().dataset.mesh, 8);
    const Written written(atlas, {});
    const DiskRecords on_disk = written.records();
    const SampleList list = list_of(atlas);
    for (const bool deflate : {false, true}) {
        const VertexSolverOptions options{.optimizer = {.iterations = 6}, .deflate = deflate, .seed = 4};
        const TwoStepResult two_step = solve_two_step(star().dataset, atlas, star().rings, on_disk, model(2), options);
        std::vector<VertexSolution> solutions;
        for (const int threads : {1, 3}) {
            set_thread_count(threads);
            solutions.push_back(solve_vertices(star().dataset, atlas, star().rings, list, model(2), options));
        }
        set_thread_count(0);
        EXPECT_EQ(solutions[0].parameters, solutions[1].parameters);
        EXPECT_EQ(solutions[0].sample_iterations, two_step.sample_iterations);
        ASSERT_EQ(solutions[0].trace.rows.size(), two_step.trace.rows.size());
        for (size_t k = 0; k < two_step.trace.rows.size(); ++k)
            EXPECT_NEAR(solutions[0].trace.rows[k].error, two_step.trace.rows[k].error,
                        1e-5 * two_step.trace.rows[k].error);
    }
}

TEST(TwoStep, DoesNotDependOnThreads) {
    const TriangleAtlas atlas(star().dataset.mesh, 8);
    const Written written(atlas, {});
    const DiskRecords on_disk = written.records();
    const VertexSolverOptions options{.optimizer = {.iterations = 6}, .deflate = true, .seed = 4};
    set_thread_count(1);
    const TwoStepResult one = solve_two_step(star().dataset, atlas, star().rings, on_disk, model(2), options);
    set_thread_count(3);
    const TwoStepResult three = solve_two_step(star().dataset, atlas, star().rings, on_disk, model(2), options);
    set_thread_count(0);
    EXPECT_EQ(one.parameters, three.parameters);
    ASSERT_EQ(one.trace.rows.size(), three.trace.rows.size());
    for (size_t k = 0; k < one.trace.rows.size(); ++k) EXPECT_EQ(one.trace.rows[k].error, three.trace.rows[k].error);
    EXPECT_LT(one.trace.rows.back().error, 0.5 * one.trace.rows.front().error);
}

TEST(DiskRecords, RefuseWhatIsNotWholeOrNotTheirs) {
    const TriangleAtlas atlas(star().dataset.mesh, 4);
    const Written written(atlas, {.key = "star"});
    EXPECT_NO_THROW(written.records("star"));
    EXPECT_THROW(written.records("bust"), UserError);
    fs::resize_file(written.folder.path() / "index.bin", 100);
    EXPECT_THROW(written.records("star"), UserError);
    fs::remove(written.folder.path() / "records.json");
    EXPECT_THROW(written.records("star"), UserError);
    EXPECT_THROW(DiskRecords("/nowhere", ""), UserError);
}

// With the checksum that fits them, so that nothing else is wrong.
TEST(DiskRecords, RefuseDescriptionsOfOtherTypesAndCounts) {
    const TriangleAtlas atlas(star().dataset.mesh, 4);
    const Written written(atlas, {.key = "star"});
    const fs::path file = written.folder.path() / "records.json";
    const auto whole = nlohmann::ordered_json::parse(contents(file));
    const auto refused = [&](const char* field, const nlohmann::ordered_json& value) {
        auto changed = whole;
        changed[field] = value;
        write_description(file, changed.dump());
        EXPECT_THROW(written.records("star"), UserError) << field << " " << value;
    };
    refused("kind", "other");
    refused("kind", 1);
    refused("bits", 7);
    refused("bits", "8");
    refused("scale", "much");
    refused("views", 3);
    refused("views", {"a"});
    refused("bytes", -1);
    refused("index_checksum", "none");
    auto without = whole;
    without.erase("bits");
    write_description(file, without.dump());
    EXPECT_THROW(written.records("star"), UserError);
    std::ofstream(file) << std::string(100'000, '[');
    EXPECT_THROW(written.records("star"), UserError);
    write_description(file, whole.dump());
    const DiskRecords records = written.records("star");
    const auto views = star().dataset.split(false);
    EXPECT_NO_THROW(records.require(star().rings.vertex_count(), views));
    EXPECT_THROW(records.require(star().rings.vertex_count() + 1, views), UserError);
    EXPECT_THROW(records.require(star().rings.vertex_count(), {0, 99'999}), UserError);
}

}  // namespace
}  // namespace radiafit
