// Texel-local models over a dataset: samples by texel from memory and disk, what counts, the CPU's engine against its
// definition, and solvers against each other and the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "bench/loss_oracle.h"
#include "cpu/texel_batches_impl.h"
#include "cpu/texel_fit_impl.h"
#include "cpu/texel_models.h"
#include "cpu/texel_solver.h"
#include "dataset/truth.h"
#include "model/coefficient_solver.h"
#include "samples/block_file.h"
#include "samples/grid_distributor.h"
#include "samples/raster_distributor.h"
#include "synthetic/synthetic.h"
#include "temporary_folder.h"
#include "texel_scene.h"

#define RADIAFIT_TEXEL_MODEL several_shapes
#define RADIAFIT_TEXEL_FILE "several_shapes.glsl"
#include "model/define_texel_text.h"

namespace radiafit {
using namespace harness;
namespace {

using namespace testing;
namespace fs = std::filesystem;

// --- the engine against its definition ---

template <template <class> class Text>
void check_engine(Mode mode, uint64_t seed, const Loss& loss = {}) {
    using Texels = TexelBatches<Text<Pack>>;
    using Model = TexelLocal<Text<double>>;
    constexpr size_t N = Texels::N, texels = 21;
    Rng rng(seed);
    std::vector<typename Texels::Batch> batches((texels + 7) / 8);
    std::vector<std::vector<TexelSample<Text<double>::term_count>>> samples(texels);
    std::vector<float> p, d;
    for (size_t t = 0; t < texels; ++t) {
        const size_t count = t == 5 ? 0 : 1 + size_t(rng.uniform() * 200);
        for (size_t i = 0; i < count; ++i) {
            const auto terms = Text<double>::sample_terms(random_direction(rng, 0.01), random_direction(rng, 0.01));
            TexelSample<Text<double>::term_count> s;
            for (int k = 0; k < Text<double>::term_count; ++k) s.term[size_t(k)] = float(terms.x[k]);
            for (float& x : s.target) x = rng.uniform();
            if (loss.weighted()) s.weight = rng.uniform(0.05f, 1);
            samples[t].push_back(s);
            batches[t / 8].push(int(t % 8), s);
        }
        for (int i = 0; i < int(N); ++i) {  // some of them beyond their bounds
            auto [low, high] = Model::bounds(i);
            if (!Model::bounded(i)) low = -1, high = 1;
            if (i >= 3 * Model::basis) low = std::max(low, -1.0);  // D^n must stay a float
            if (i >= 3 * Model::basis && high < 2) high = std::min(high, 0.9);
            const double beyond = 0.1;
            p.push_back(rng.uniform(float(low - beyond), float(high + beyond)));
            d.push_back(rng.uniform(-1, 1));
        }
    }
    TexelOptions options;
    options.mode = mode;
    options.mu = 0.3f;
    options.loss = loss;
    Texels problem(batches, texels, options);
    const ProblemStatistics statistics = problem.count();
    std::vector<Pack> x(problem.begin(batches.size()), Pack{}), along = x, g = x, preconditioner = x;
    problem.set(p, x.data());
    problem.set(d, along.data());
    std::vector<std::array<double, Texels::lanes>> errors(batches.size());
    std::vector<typename Texels::Sums> lines(batches.size());
    for (size_t b = 0; b < batches.size(); ++b) {
        const size_t at = problem.begin(b);
        problem.direction(b, &x[at], &g[at], &preconditioner[at], errors[b].data());
        problem.line(b, &x[at], &along[at], lines[b]);
    }
    std::vector<float> gradients(texels * N), diagonals(texels * N);
    problem.get(g.data(), gradients);
    problem.get(preconditioner.data(), diagonals);
    for (size_t t = 0; t < texels; ++t) {
        ASSERT_EQ(statistics.samples[t], samples[t].size());
        if (samples[t].empty()) continue;
        typename Model::Parameters at, along;
        for (size_t i = 0; i < N; ++i) at[i] = double(p[t * N + i]), along[i] = double(d[t * N + i]);
        // sums, and sums of their terms' magnitudes
        double error = 0, first = 0, whole = 0, error_size = 0, whole_size = 0;
        std::array<double, N> gradient{}, gradient_size{}, diagonal{};
        const double count = double(samples[t].size());
        for (const auto& s : samples[t]) {
            typename Model::Terms terms;
            for (int k = 0; k < Text<double>::term_count; ++k) terms.x[k] = double(s.term[size_t(k)]);
            const auto value = Model::value(at, terms);
            const auto q = Model::columns(Model::shape_of(at), terms);
            const auto bend = Model::bend(at, along, terms);
            double squared = 0, squared_size = 0;
            for (size_t c = 0; c < 3; ++c) {
                squared += std::pow(value[c] - double(s.target[c]), 2);
                squared_size += std::pow(std::abs(value[c]) + std::abs(double(s.target[c])), 2);
            }
            const auto weight = double(s.weight);
            const LossOracle cost(loss, std::sqrt(weight * squared), std::sqrt(weight * squared_size));
            error += cost.value / count, error_size += weight * squared_size / 2 / count;
            const double scale = weight * cost.weight / count, sure = 1 + cost.sensitivity;
            for (size_t c = 0; c < 3; ++c) {
                const double r = value[c] - double(s.target[c]);
                const double r_size = sure * (std::abs(value[c]) + std::abs(double(s.target[c])));
                const auto add = [&](size_t i, double slope) {
                    gradient[i] += scale * slope * r, gradient_size[i] += scale * std::abs(slope) * r_size;
                    diagonal[i] += scale * slope * slope;
                };
                for (size_t k = 0; k < size_t(Model::basis); ++k) add(3 * k + c, q[k]);
                std::array<double, size_t(Model::shape)> by_shape{};
                for (int i = 0; i < Model::slopes; ++i)
                    by_shape[size_t(Model::slope_shape(i))] +=
                        at[3 * size_t(Model::slope_basis(i)) + c] * q[size_t(Model::basis + i)];
                for (size_t i = 0; i < by_shape.size(); ++i) add(3 * size_t(Model::basis) + i, by_shape[i]);
                first += scale * bend.first[c] * bend.first[c];
                whole += scale * (bend.first[c] * bend.first[c] + r * bend.second[c]);
                whole_size += scale * (bend.first[c] * bend.first[c] + r_size * std::abs(bend.second[c]));
            }
        }
        double largest = 0;
        for (const double x : diagonal) largest = std::max(largest, x);
        for (int i = 0; i < int(N); ++i) {
            const auto [low, high] = Model::bounds(i);
            const double x = at[size_t(i)], mu = 0.3f, squared = along[size_t(i)] * along[size_t(i)];
            if (!Model::bounded(i) || (x >= low && x <= high)) continue;
            const double beyond = x < low ? x - low : x - high;
            const bool paper = mode == Mode::paper;
            error += mu * (paper ? (x - low) * (x - high) : beyond * beyond / 2);
            gradient[size_t(i)] += mu * (paper ? 2 * x - low - high : beyond);
            first += mu * squared * (paper ? 2 : 1), whole += mu * squared * (paper ? 2 : 1);
        }
        for (int i = 0; i < int(N); ++i)
            if (Model::held(i)) gradient[size_t(i)] = gradient_size[size_t(i)] = 0;
        // a lobe multiplies the rounding of its cosine by n, up to 200
        const double tolerance = 1e-5;
        EXPECT_NEAR(errors[t / 8][t % 8], error, tolerance * (error_size + error)) << "texel " << t;
        for (size_t i = 0; i < N; ++i) {
            EXPECT_NEAR(double(gradients[t * N + i]), gradient[i],
                        tolerance * (gradient_size[i] + std::abs(gradient[i]) + 1e-6))
                << "texel " << t << ", parameter " << i;
            const double floored = std::max(diagonal[i], 1e-4 * largest);
            EXPECT_NEAR(double(diagonals[t * N + i]), floored, 3 * tolerance * (floored + 1e-4 * largest)) << i;
        }
        const auto& line = lines[t / 8];
        const int lane = int(t % 8);
        EXPECT_NEAR(double(line.gauss_newton[lane]), first, tolerance * (first + whole_size)) << "texel " << t;
        EXPECT_NEAR(double(line.curvature[lane]), whole, tolerance * (first + whole_size)) << "texel " << t;
        EXPECT_EQ(line.third[lane], 0);
        EXPECT_EQ(line.fourth[lane], 0);
    }
}

TEST(TexelEngine, EvaluatesLafortuneAsDefined) {
    for (const Mode mode : {Mode::modern, Mode::paper})
        for (uint64_t seed = 1; seed < 4; ++seed) check_engine<texel_text::lafortune>(mode, seed);
}
TEST(TexelEngine, EvaluatesRobustLossesAsDefined) {
    for (const LossKind kind : {LossKind::huber, LossKind::cauchy})
        check_engine<texel_text::lafortune>(Mode::modern, 7, {kind, 0.3f});
}
TEST(TexelEngine, EvaluatesWeightsAsDefined) {
    for (const LossKind kind : {LossKind::square, LossKind::huber, LossKind::cauchy})
        check_engine<texel_text::lafortune>(Mode::modern, 7, {kind, 0.3f, SampleWeights::facing});
}

TEST(TexelEngine, EvaluatesLambertAsDefined) { check_engine<texel_text::lambert>(Mode::modern, 9); }
TEST(TexelEngine, EvaluatesSeveralShapesAsDefined) { check_engine<texel_text::several_shapes>(Mode::modern, 11); }

/// Of functions that are nearly the same: no coefficient within its bounds has a slope, none at a bound one inwards.
TEST(CoefficientSolver, FindsTheLeastWithinBounds) {
    using Model = TexelLocal<texel_text::several_shapes<double>>;
    constexpr size_t B = size_t(Model::basis);
    Rng rng(3);
    int at_bounds = 0;
    for (int trial = 0; trial < 300; ++trial) {
        SmallMatrix<double, int(B)> a{};
        SmallVector<double, int(B)> at_zero{};
        for (int sample = 0; sample < 30; ++sample) {
            const double common = rng.uniform();
            std::array<double, B> row;
            for (double& x : row) x = common + 0.1 * rng.uniform();
            const double target = 3 * row[0] - row[1] + row[2] + rng.uniform();
            for (size_t k = 0; k < B; ++k) {
                for (size_t j = 0; j <= k; ++j) a[k][j] += row[k] * row[j];
                at_zero[k] -= row[k] * target;
            }
        }
        const CoefficientSolver<Model, double> solver(a, 1e-9, SmallPivots::raised);
        for (size_t c = 0; c < 3; ++c) {
            const auto found = solver.from_zero(c, at_zero);
            double error = 0;
            for (size_t k = 0; k < B; ++k) {
                double slope = at_zero[k];
                for (size_t j = 0; j < B; ++j) slope += a[std::max(j, k)][std::min(j, k)] * found.coefficients[j];
                const auto& [low, high] = Model::channel_bounds(c)[k];
                const double at = found.coefficients[k];
                ASSERT_TRUE(at >= low - 1e-12 && at <= high + 1e-12) << k;
                error += 0.5 * at * (at_zero[k] + slope);
                if (Model::held(int(3 * k + c))) continue;
                at_bounds += at <= low || at >= high;
                EXPECT_TRUE(slope >= -1e-6 || at >= high - 1e-9) << trial << " " << k << ": " << slope << " at " << at;
                EXPECT_TRUE(slope <= 1e-6 || at <= low + 1e-9) << trial << " " << k << ": " << slope << " at " << at;
            }
            EXPECT_NEAR(found.change, error, 1e-9 * std::abs(error));
        }
    }
    EXPECT_GT(at_bounds, 100);
}

/// Where several basis functions depend on the shape, of which some are one channel's or held.
TEST(TexelFit, RecoversSeveralShapes) {
    using Model = TexelLocal<texel_text::several_shapes<double>>;
    using Fit = TexelFit<texel_text::several_shapes<Pack>>;
    Rng rng(12);
    int recovered = 0;
    for (int batches = 0; batches < 4; ++batches) {
        Fit::Batch batch;
        std::vector<Model::Parameters> truth;
        for (int lane = 0; lane < Pack::size; ++lane) {
            Model::Parameters p{};
            for (int i = 0; i < Model::parameters; ++i) {
                const auto [low, high] = Model::bounds(i);
                p[size_t(i)] = low == high ? low : low + (0.5 + 0.4 * rng.uniform()) * (high - low);
            }
            truth.push_back(p);
            for (int i = 0; i < 300; ++i) {
                const auto terms = texel_text::several_shapes<double>::sample_terms(random_direction(rng, 0.1),
                                                                                    random_direction(rng, 0.1));
                const auto value = Model::value(p, terms);
                TexelSample<3> s;
                for (size_t k = 0; k < 3; ++k) s.term[k] = float(terms.x[k]), s.target[k] = float(value[k]);
                batch.push(lane, s);
            }
        }
        const auto outcomes = Fit().solve(batch);
        for (size_t lane = 0; lane < outcomes.size(); ++lane) {
            double worst = 0;
            for (int i = 0; i < Model::parameters; ++i) {
                const double error = std::abs(double(outcomes[lane].parameters[size_t(i)]) - truth[lane][size_t(i)]);
                worst = std::max(worst, error);
                EXPECT_TRUE(!Model::held(i) || error == 0) << "lane " << lane << ", parameter " << i;
            }
            recovered += outcomes[lane].status == Status::stationary && worst < 5e-3;
        }
        // a texel whose samples are two alone, many times
        Fit::Batch few;
        for (int i = 0; i < 30; ++i) few.push(0, {{0.5f, -0.1f, i % 2 ? 0.9f : 0.8f}, {0.5f, 0.5f, 0.5f}});
        EXPECT_EQ(Fit().solve(few)[0].status, Status::underdetermined);
    }
    EXPECT_GE(recovered, 29) << "of 32: some end in another minimum";
}

// --- over a dataset ---

/// The ornament at smoke scale, made once.
Dataset ornament() {
    struct Made : TemporaryFolder {
        Made() {
            OrnamentOptions options;
            options.sensor.encoding = Encoding::f32_linear;
            generate_synthetic({.shape = "ornament", .scale = "smoke", .seed = 3, .ornament = options}, path() / "set");
        }
    };
    static const Made folder;
    return open_dataset(folder.path() / "set");
}

class TexelDataset : public ::testing::Test {
protected:
    TexelDataset() {
        set_quiet(true);
        dataset_ = ornament();
        views_ = dataset_.split(false);
        atlas_ = std::make_unique<TriangleAtlas>(reflectance_atlas(dataset_, dataset_.normal_map.side));
        distributors_ = raster_distributors(*atlas_);
        options_.model = find_texel_model("lafortune");
        options_.surface_side = dataset_.normal_map.side;
    }
    ~TexelDataset() override { set_thread_count(0); }

    std::unique_ptr<TexelSource> gather() {
        return gather_texels(dataset_, *atlas_, views_, worker_pointers(distributors_));
    }
    RecordStatistics write(const std::string& name, uint64_t memory) {
        fs::create_directory(folder_.path() / name);
        return write_texel_records(folder_.path() / name, dataset_, *atlas_, views_, worker_pointers(distributors_),
                                   memory, "key");
    }
    static std::string bytes_of(const fs::path& file) {
        std::ostringstream text;
        text << std::ifstream(file, std::ios::binary).rdbuf();
        return text.str();
    }
    /// Share of gold and green texels whose worst parameter is within `limit` of the truth.
    double recovered(const TexelResult& result, double limit) const {
        const ReflectanceTruth truth = read_truth(dataset_.folder);
        size_t near = 0, all = 0;
        for (size_t t = 0; t < result.status.size(); ++t) {
            if (truth.materials[truth.material[t]].model != "lafortune" || result.samples[t] < 20) continue;
            ++all;
            double worst = 0;
            for (size_t i = 0; i < 9; ++i) {
                const double found = double(result.parameters[9 * t + i]), expected = double(truth.parameters[t][i]);
                worst = std::max(worst, std::abs((i == 8 ? std::exp(found) : found) - expected) / std::abs(expected));
            }
            near += worst < limit;
        }
        EXPECT_GT(all, 1000u);
        return double(near) / double(all);
    }

    TemporaryFolder folder_;
    Dataset dataset_;
    std::vector<uint32_t> views_;
    std::unique_ptr<TriangleAtlas> atlas_;
    std::vector<std::unique_ptr<Distributor>> distributors_;
    TexelOptions options_;
};

TEST_F(TexelDataset, SamplesAreThePixelsThatTexelsTake) {
    const auto source = gather();
    ASSERT_EQ(source->texel_count(), atlas_->texel_count());
    std::vector<std::vector<TexelRadiance>> expected(atlas_->texel_count());
    ImageStream stream(dataset_, StreamSource::disk, TargetSpace::linear);
    RasterDistributor distributor(*atlas_);
    for (uint32_t k = 0; k < views_.size(); ++k) {
        TargetImage image;
        std::vector<float> values;
        Distribution distribution;
        stream.load(views_[k], image);
        stream.load_values(views_[k], values);
        distributor.distribute(dataset_.views[views_[k]].camera, image, distribution);
        for (uint32_t t = 0; t < expected.size(); ++t)
            if (const uint32_t pixel = distribution.texel_pixel[t]; pixel != no_pixel)
                expected[t].push_back({{values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]}, k});
    }
    TexelSamples block;
    for (uint32_t begin = 0; begin < source->texel_count(); begin += TexelSource::block) {
        source->read(begin, block);
        for (size_t t = 0; t + 1 < block.first.size(); ++t) {
            ASSERT_EQ(block.of(t).size(), expected[begin + t].size()) << "texel " << begin + t;
            for (size_t i = 0; i < block.of(t).size(); ++i) {
                EXPECT_EQ(block.of(t)[i].image, expected[begin + t][i].image);
                for (int c = 0; c < 3; ++c) EXPECT_EQ(block.of(t)[i].value[c], expected[begin + t][i].value[c]);
            }
        }
    }
}

TEST_F(TexelDataset, RecordsOnDiskAreTheSameInAnyMemory) {
    const RecordStatistics large = write("large", uint64_t(1) << 30), small = write("small", 20000);
    EXPECT_EQ(large.waiting_parts, 0u);
    EXPECT_GT(small.bytes_read, 0u);
    EXPECT_FALSE(fs::exists(folder_.path() / "small/waiting.bin"));
    for (const char* name : {"records.bin", "index.bin", "records.json"})
        EXPECT_EQ(bytes_of(folder_.path() / "large" / name), bytes_of(folder_.path() / "small" / name)) << name;
    const auto memory = gather(),
               disk = open_texel_records(folder_.path() / "small", "key", atlas_->texel_count(), views_);
    ASSERT_EQ(memory->sample_count(), disk->sample_count());
    TexelSamples a, b;
    for (uint32_t begin = 0; begin < memory->texel_count(); begin += TexelSource::block) {
        memory->read(begin, a);
        disk->read(begin, b);
        ASSERT_EQ(a.first, b.first);
        ASSERT_EQ(0, std::memcmp(a.samples.data(), b.samples.data(), a.samples.size() * sizeof(TexelRadiance)));
    }
}

TEST_F(TexelDataset, DamagedOrForeignRecordsAreRefused) {
    write("records", uint64_t(1) << 30);
    const fs::path folder = folder_.path() / "records";
    EXPECT_THROW(open_texel_records(folder, "another key", atlas_->texel_count(), views_), UserError);
    EXPECT_THROW(open_texel_records(folder_.path() / "none", "key", atlas_->texel_count(), views_), UserError);
    std::fstream file(folder / "records.bin", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(5000);
    file.put('x');
    file.put('y');
    file.close();
    const auto source = open_texel_records(folder, "key", atlas_->texel_count(), views_);
    TexelSamples block;
    EXPECT_THROW(
        for (uint32_t begin = 0; begin < source->texel_count(); begin += TexelSource::block) source->read(begin, block),
        UserError);
    fs::resize_file(folder / "records.bin", 4096);
    EXPECT_THROW(open_texel_records(folder, "key", atlas_->texel_count(), views_), UserError);
}

// With the checksum that fits them, so that nothing else is wrong.
TEST_F(TexelDataset, RecordsOfOtherTypesAndCountsAreRefused) {
    write("records", uint64_t(1) << 30);
    const fs::path folder = folder_.path() / "records", file = folder / "records.json";
    std::ifstream stream(file);
    const auto whole = nlohmann::ordered_json::parse(stream);
    const auto refused = [&](const char* field, const nlohmann::ordered_json& value) {
        auto changed = whole;
        changed[field] = value;
        write_description(file, changed.dump());
        EXPECT_THROW(open_texel_records(folder, "key", atlas_->texel_count(), views_), UserError)
            << field << " " << value;
    };
    refused("texels", "many");
    refused("texels", uint64_t(1) << 33);
    refused("texels", 4'000'000'000u);
    refused("kind", "compact");
    refused("texels", nullptr);
    refused("bytes", "all");
    refused("index_checksum", nlohmann::ordered_json::array());
    // so few more or less that blocks are as many, and of a length that fits
    for (const int more : {-2, 2, 4}) refused("texels", int(atlas_->texel_count()) + more);
    refused("views", std::vector<uint32_t>(views_.begin(), views_.end() - 1));
    write_description(file, whole.dump());
    EXPECT_EQ(open_texel_records(folder, "key", atlas_->texel_count(), views_)->texel_count(), atlas_->texel_count());
    EXPECT_THROW(open_texel_records(folder, "key", atlas_->texel_count() + 2, views_), UserError);
}

TEST_F(TexelDataset, LoadedSamplesFollowTheRules) {
    const auto source = gather();
    const TexelLoader plain(dataset_, *atlas_, views_, options_);
    TexelOptions strict = options_;
    strict.shadow_below = 0.8f;
    const TexelLoader shadowed(dataset_, *atlas_, views_, strict);
    TexelOptions weighing = options_;
    weighing.loss.weights = SampleWeights::facing;
    const TexelLoader weighted(dataset_, *atlas_, views_, weighing);
    TexelSamples block;
    std::vector<ShadedSample> all, lit, facing;
    size_t left_out = 0, kept = 0;
    source->read(0, block);
    for (uint32_t t = 0; t + 1 < block.first.size(); ++t) {
        plain.load(t, block.of(t), all);
        shadowed.load(t, block.of(t), lit);
        weighted.load(t, block.of(t), facing);
        ASSERT_EQ(facing.size(), all.size());
        for (size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(all[i].weight, 1);
            EXPECT_EQ(facing[i].weight, all[i].v.z());
            EXPECT_EQ(facing[i].target[0], all[i].target[0]);
        }
        const Vec3f n = atlas_->normal(t);
        size_t at = 0;
        for (const TexelRadiance& s : block.of(t)) {
            const View& view = dataset_.views[views_[s.image]];
            const Vec3d x = atlas_->position(t).cast<double>();
            const Vec3d u = view.light->direction_from(x), v = view.direction_to_camera(x);
            if (u.dot(n.cast<double>()) <= 0 || v.dot(n.cast<double>()) <= 0) continue;
            ASSERT_LT(at, all.size());
            EXPECT_NEAR(double(all[at].u.z()), u.dot(n.cast<double>()), 1e-6);
            EXPECT_NEAR(double(all[at].v.z()), v.dot(n.cast<double>()), 1e-6);
            EXPECT_NEAR(double(all[at].u.dot(all[at].v)), u.dot(v), 1e-6);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(double(all[at].target[c]), double(s.value[c]) / view.light->irradiance_at(x)[c], 1e-6);
            ++at;
        }
        EXPECT_EQ(at, all.size());
        const float albedo = lambertian_albedo(all).sum();
        std::erase_if(all, [&](const ShadedSample& s) {
            return s.target[0] + s.target[1] + s.target[2] < 0.8f * albedo * s.u.z();
        });
        EXPECT_EQ(all.size(), lit.size());
        left_out += at - lit.size(), kept += lit.size();
    }
    EXPECT_GT(left_out, 0u);
    EXPECT_GT(kept, left_out);
}

TEST_F(TexelDataset, ClippedPixelsAreLeftOut) {
    Dataset bounded = dataset_;
    bounded.encoding = Encoding::u16_linear;
    bounded.views[views_[0]].gain = 2;
    TexelOptions options = options_;
    options.clip_above = 0.5f;
    const TexelLoader loader(bounded, *atlas_, views_, options), floats(dataset_, *atlas_, views_, options);
    const auto source = gather();
    TexelSamples block;
    source->read(0, block);
    std::vector<ShadedSample> all, kept;
    const TexelLoader plain(dataset_, *atlas_, views_, options_);
    size_t texel = 0;
    while (plain.load(uint32_t(texel), block.of(texel), all), all.empty()) ++texel;
    // the brightest channel decides; view 0's gain of 2 moves its limit from 0.5 to 1
    for (const auto& [value, image, counts] : {std::tuple(0.49f, 1u, true), std::tuple(0.5f, 1u, false),
                                               std::tuple(0.99f, 0u, true), std::tuple(1.0f, 0u, false)}) {
        std::vector<TexelRadiance> one(1);
        for (const TexelRadiance& s : block.of(texel)) one[0] = s;
        for (uint32_t k = 0; k < views_.size(); ++k) {  // a view that sees and lights the texel, in this one's place
            bounded.views[views_[image]].camera = bounded.views[views_[k]].camera;
            bounded.views[views_[image]].light = bounded.views[views_[k]].light;
            one[0] = {{0.1f, value, 0.1f}, image};
            floats.load(uint32_t(texel), one, all);
            loader.load(uint32_t(texel), one, kept);
            if (!kept.empty()) break;
        }
        EXPECT_EQ(!kept.empty(), counts) << value << " in view " << image;
    }
}

TEST_F(TexelDataset, SolversRecoverTheTruth) {
    const auto source = gather();
    const TexelLoader loader(dataset_, *atlas_, views_, options_);
    const TexelProblem problem{*source, loader, options_};
    const TexelSolvers& solvers = texel_solvers(*options_.model);
    const TexelResult lm = solvers.solve_lm(problem, {}, {});
    OptimizerOptions cg;
    cg.iterations = 40;
    const TexelResult streamed = solvers.stream(problem, cg, {});
    EXPECT_GT(recovered(lm, 1e-3), 0.9);
    EXPECT_GT(recovered(streamed, 1e-3), 0.75);
    EXPECT_LT(streamed.trace.rows.back().error, streamed.trace.rows.front().error);
    // what a result says of its error is what its parameters leave
    for (const TexelResult* result : {&lm, &streamed}) {
        const std::vector<float> errors = solvers.errors(problem, result->parameters);
        for (size_t t = 0; t < errors.size(); ++t) EXPECT_EQ(errors[t], result->error[t]) << "texel " << t;
    }
}

TEST_F(TexelDataset, TexelByTexelIsAllAtOnceBitByBit) {
    const auto source = gather();
    const TexelLoader loader(dataset_, *atlas_, views_, options_);
    const TexelProblem problem{*source, loader, options_};
    const TexelSolvers& solvers = texel_solvers(*options_.model);
    for (const Rule rule : all_rules()) {
        OptimizerOptions optimizer;
        optimizer.rule = rule;
        optimizer.iterations = 7;
        set_thread_count(1);
        const TexelResult one = solvers.stream(problem, optimizer, {});
        set_thread_count(2);
        const TexelResult two = solvers.stream(problem, optimizer, {});
        const TexelResult steps = solvers.solve(problem, optimizer, {});
        EXPECT_EQ(one.parameters, two.parameters);
        EXPECT_EQ(one.parameters, steps.parameters);
        EXPECT_EQ(one.error, steps.error);
        EXPECT_EQ(one.status, steps.status);
        EXPECT_EQ(one.iterations, steps.iterations);
        ASSERT_EQ(one.trace.rows.size(), steps.trace.rows.size());
        for (size_t k = 0; k < one.trace.rows.size(); ++k) {
            EXPECT_NEAR(one.trace.rows[k].error, steps.trace.rows[k].error, 1e-9 * one.trace.rows[k].error);
            EXPECT_EQ(one.trace.rows[k].active, steps.trace.rows[k].active);
        }
    }
}

}  // namespace
}  // namespace radiafit
