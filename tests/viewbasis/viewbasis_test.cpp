#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "base/parallel.h"
#include "basis/basis_texels.h"
#include "eval/pixel_areas.h"
#include "failing_gl.h"
#include "fit_scene.h"
#include "geometry/ray_cast.h"
#include "samples/interpolated_samples.h"
#include "shared_context.h"
#include "viewbasis/learn_view_basis.h"
#include "viewbasis/solve_view_basis.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit::testing {
using namespace fits;
namespace {

TEST(ViewPolynomials, AreChebyshevProducts) {
    Rng rng(1);
    for (int trial = 0; trial < 50; ++trial) {
        const double s = rng.uniform(0, 3.14f), t = rng.uniform(0, 3.14f);
        const ViewTerms b = view_polynomials({float(std::cos(s)), float(std::cos(t)), 0});
        int at = 0;
        for (int degree = 0; degree <= view_degree; ++degree)
            for (int j = 0; j <= degree; ++j)
                ASSERT_NEAR(b[at++], std::cos((degree - j) * s) * std::cos(j * t), 1e-4);  // T_n(cos a) = cos(n a)
        ASSERT_EQ(at, view_terms);
    }
}

TEST(ViewFrame, HasItsSecondAxisUp) {
    Rng rng(2);
    const Vec3f up = Vec3f::UnitY();
    for (int trial = 0; trial < 50; ++trial) {
        const Vec3f n = Vec3f(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized();
        const Frame f = view_frame(n, up);
        EXPECT_NEAR(f.tangent.cross(f.bitangent).dot(f.normal), 1, 1e-5);
        EXPECT_NEAR(f.tangent.dot(up), 0, 1e-6);
        EXPECT_GE(f.bitangent.dot(up), 0);
    }
    const Frame pole = view_frame(up, up);  // no direction across is nearer to up
    EXPECT_NEAR(pole.tangent.cross(pole.bitangent).dot(up), 1, 1e-5);
}

/// A surface whose texels' colours are functions of the view direction, drawn from a few that all have in common.
class Surface {
public:
    static constexpr int rank = 3;
    explicit Surface(int images, float share = 0.7f)
        : dataset(sheet_dataset(troubled_mesh(4, 6, 5), images, 32, 3)), atlas(dataset.mesh, 6) {
        samples = random_samples(atlas, size_t(images), share, 4);
        up = mean_up(dataset);
        Rng rng(5);
        mean = Eigen::MatrixXf::Zero(view_terms, 3);
        mean.row(0) << 0.5f, 0.45f, 0.4f;
        mean.row(2).setConstant(0.05f);
        u = Eigen::MatrixXf(view_terms, rank);
        for (float& x : u.reshaped()) x = 0.02f * rng.uniform(-1, 1);
        u(0, 0) = 0.1f;
        z = Eigen::MatrixXf(rank, 3 * atlas.texel_count());
        for (float& x : z.reshaped()) x = rng.uniform(-1.7f, 1.7f);  // variance 1
        for (uint32_t t = 0; t < samples.tile_count(); ++t)
            for (uint32_t g = samples.tile_groups[t]; g < samples.tile_groups[t + 1]; ++g) {
                const Vec3f eye = dataset.views[samples.views[samples.groups[g].image]].camera.center().cast<float>();
                for (uint64_t i = samples.groups[g].first; i < samples.groups[g + 1].first; ++i) {
                    Sample& s = samples.samples[i];
                    const Vec3f colour = at(t * atlas.texels_per_tile() + s.local, eye);
                    for (int c = 0; c < 3; ++c)
                        s.rgb[c] = uint16_t(std::clamp(65535 * colour[c] + 0.5f, 0.0f, 65535.0f));
                }
            }
    }

    Vec3f at(uint32_t texel, const Vec3f& eye) const {
        const ViewTerms b = terms(texel, eye);
        return mean.transpose() * b + z.middleCols(3 * texel, 3).transpose() * (u.transpose() * b);
    }
    ViewTerms terms(uint32_t texel, const Vec3f& eye) const {
        return view_polynomials(view_direction(view_frame(atlas.normal(texel), up), atlas.position(texel), eye));
    }

    Dataset dataset;
    TriangleAtlas atlas;
    SampleList samples;
    Vec3f up;
    Eigen::MatrixXf mean, u, z;
};

Vec3f predicted(const ViewBasis& basis, const ViewBasisSolution& solution, const Surface& surface, uint32_t texel,
                const Vec3f& eye) {
    const auto block = basis.block(basis.block_at(surface.atlas.position(texel)));
    const ViewTerms b = surface.terms(texel, eye);
    Vec3f colour = block.leftCols<3>().transpose() * b;
    for (int k = 0; k < basis.rank; ++k)
        for (int c = 0; c < 3; ++c)
            colour[c] +=
                solution.parameters[(texel * size_t(basis.rank) + size_t(k)) * 3 + size_t(c)] * block.col(3 + k).dot(b);
    return colour;
}

/// Root mean square error from cameras amid those of the samples, over texels with samples.
double error_from_elsewhere(const ViewBasis& basis, const ViewBasisSolution& solution, const Surface& surface) {
    double sum = 0;
    int count = 0;
    for (uint32_t texel = 0; texel < surface.atlas.texel_count(); ++texel) {
        if (solution.samples[texel] < 4) continue;
        for (size_t i = 0; i + 1 < surface.dataset.views.size(); i += 2) {
            const Vec3f eye =
                (0.5 * (surface.dataset.views[i].camera.center() + surface.dataset.views[i + 1].camera.center()))
                    .cast<float>();
            sum += (predicted(basis, solution, surface, texel, eye) - surface.at(texel, eye)).squaredNorm();
            count += 3;
        }
    }
    return std::sqrt(sum / count);
}

// Few samples a texel: the basis that the surface has in common is found, and fills the gaps.
TEST(ViewBasis, FindsWhatTexelsHaveInCommon) {
    const Surface surface(14);
    ViewBasisOptions options;
    options.rank = Surface::rank;
    options.noise = 1e-6;
    options.blocks = 1;
    options.rounds = 40;
    const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples, options);
    const auto solution = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis);
    const double learned = error_from_elsewhere(basis, solution, surface);
    EXPECT_LT(learned, 0.01);       // of colours whose standard deviation is 0.1
    ViewBasis polynomials = basis;  // as many functions, of the lowest degrees
    BlockBasis::Map(polynomials.numbers.data(), view_terms, 3 + options.rank).rightCols(options.rank) =
        0.1f * Eigen::MatrixXf::Identity(view_terms, options.rank);
    const auto other = solve_view_basis(surface.dataset, surface.atlas, surface.samples, polynomials);
    EXPECT_GT(error_from_elsewhere(polynomials, other, surface), 3 * learned);
}

// At the solution the gradient of the objective, formed sample by sample, is zero.
TEST(ViewBasis, SolvesTheNormalEquations) {
    const Surface surface(9);
    for (const int rank : {1, 8, 10, 28}) {
        ViewBasisOptions options;
        options.rank = rank;
        options.noise = 1e-3;
        options.blocks = 5;
        const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples, options);
        ASSERT_GT(basis.cubes.size(), 1u);
        const auto solution = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis);
        const TexelViewReader reader(surface.dataset, surface.atlas, surface.samples, basis.up);
        std::vector<TexelView> views;
        int looked_at = 0;
        for (uint32_t texel = 0; texel < surface.atlas.texel_count(); texel += 7) {
            const uint32_t tile = texel / surface.atlas.texels_per_tile(),
                           local = texel % surface.atlas.texels_per_tile();
            reader.read(tile, local, views);
            ASSERT_EQ(views.size(), solution.samples[texel]);
            if (views.empty()) continue;
            ++looked_at;
            const auto block = basis.block(basis.block_at(surface.atlas.position(texel))).cast<double>();
            Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(rank, 3), z(rank, 3);
            for (int k = 0; k < rank; ++k)
                for (int c = 0; c < 3; ++c)
                    z(k, c) = double(solution.parameters[(texel * size_t(rank) + size_t(k)) * 3 + size_t(c)]);
            gradient += options.noise * z;
            double size = 0, error = 0;
            for (const auto& [direction, colour] : views) {
                const Eigen::VectorXd b = view_polynomials(direction).cast<double>(),
                                      phi = block.rightCols(rank).transpose() * b;
                const Eigen::Vector3d r =
                    block.leftCols<3>().transpose() * b + z.transpose() * phi - colour.cast<double>();
                const auto weight = double(view_sample_weight(direction));
                gradient += weight * phi * r.transpose();
                size += weight * phi.norm();
                error += 0.5 * r.squaredNorm();
            }
            EXPECT_LT(gradient.norm(), 1e-4 * size);
            EXPECT_NEAR(solution.error[texel], error, 1e-4 * error + 1e-7);
        }
        EXPECT_GT(looked_at, 50);
    }
}

// The same equations by either engine, of texels with few samples and with several times what a work group looks at at
// once; sums of floats in another order.
TEST(ViewBasis, IsSolvedOnTheDeviceAsOnTheCpu) {
    SharedContext::use();
    for (const auto& [images, share] : {std::pair(5, 0.4f), {90, 0.9f}}) {
        const Surface surface(images, share);
        for (const int rank : {1, 10, 28}) {
            const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples,
                                                     {.rank = rank, .noise = 1e-3, .blocks = 5, .rounds = 2});
            const auto here = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis),
                       there = solve_on_device(surface.dataset, surface.atlas, surface.samples, basis);
            EXPECT_EQ(there.samples, here.samples);
            EXPECT_GT(std::ranges::max(here.samples), images / 2);
            double off = 0, size = 0;
            for (size_t i = 0; i < here.parameters.size(); ++i) {
                ASSERT_TRUE(std::isfinite(there.parameters[i]));
                off = std::max(off, std::abs(double(there.parameters[i]) - double(here.parameters[i])));
                size = std::max(size, std::abs(double(here.parameters[i])));
            }
            EXPECT_LT(off, 1e-4 * size) << rank;
            for (size_t t = 0; t < here.error.size(); ++t)
                ASSERT_NEAR(there.error[t], here.error[t], 1e-4 * double(here.error[t]) + 1e-7) << rank;
        }
    }
}

TEST(ViewBasis, GroupsOfEverySizeSolveAlikeAndGiveTheSameBitsTwice) {
    SharedContext::use();
    const Surface surface(20, 0.6f);
    const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples,
                                             {.rank = 10, .noise = 1e-3, .blocks = 5, .rounds = 2});
    const auto here = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis);
    double size = 0;
    for (const float x : here.parameters) size = std::max(size, std::abs(double(x)));
    for (const char* invocations : {"8", "32", "64", "128"}) {
        ::setenv("RADIAFIT_GROUP_SIZE", invocations, 1);
        const auto there = solve_on_device(surface.dataset, surface.atlas, surface.samples, basis),
                   again = solve_on_device(surface.dataset, surface.atlas, surface.samples, basis);
        ::unsetenv("RADIAFIT_GROUP_SIZE");
        EXPECT_EQ(there.parameters, again.parameters) << invocations;
        for (size_t i = 0; i < here.parameters.size(); ++i)
            ASSERT_NEAR(there.parameters[i], here.parameters[i], 1e-4 * size) << invocations;
    }
}

TEST(ViewBasis, EveryAllocationThatFailsIsTold) {
    SharedContext::use();
    const Surface surface(5, 0.4f);
    const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples,
                                             {.rank = 4, .noise = 1e-3, .blocks = 2, .rounds = 1});
    EXPECT_GE(fail_each_allocation([&] { solve_on_device(surface.dataset, surface.atlas, surface.samples, basis); }),
              4);
}

TEST(ViewBasis, IsTheSameByAnyNumberOfThreads) {
    const Surface surface(7);
    const auto fitted = [&](int threads) {
        set_thread_count(threads);
        const ViewBasis basis =
            learn_view_basis(surface.dataset, surface.atlas, surface.samples, {.rank = 6, .blocks = 7});
        auto solution = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis);
        set_thread_count(0);
        return solution.parameters;
    };
    EXPECT_EQ(fitted(1), fitted(3));
}

// Samples of the texels that it says alone give the same basis.
TEST(ViewBasis, IsLearnedFromFewTexels) {
    Surface surface(9);
    const ViewBasisOptions options{.rank = 5, .blocks = 4, .texels = 70};
    const ViewBasis all = learn_view_basis(surface.dataset, surface.atlas, surface.samples, options);
    const std::vector<bool> mask = learned_from(surface.atlas, options);
    const auto looked_at = uint64_t(std::ranges::count(mask, true));
    EXPECT_GT(looked_at, 70u);
    EXPECT_LT(looked_at, surface.atlas.used_texels());
    SampleList few = surface.samples;
    few.samples.clear();
    for (uint32_t tile = 0; tile < few.tile_count(); ++tile)
        for (uint32_t g = few.tile_groups[tile]; g < few.tile_groups[tile + 1]; ++g) {
            few.groups[g].first = few.samples.size();
            for (const Sample& s : surface.samples.of_group(g))
                if (mask[tile * surface.atlas.texels_per_tile() + s.local]) few.samples.push_back(s);
        }
    few.groups.back().first = few.samples.size();
    ASSERT_LT(few.samples.size(), surface.samples.samples.size());
    const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, few, options);
    EXPECT_EQ(basis.numbers, all.numbers);
    EXPECT_EQ(description_of(basis), description_of(all));
}

// All usable texels are in their blocks, once each, where there are few; else they are drawn from all of the surface.
TEST(ViewBasis, DrawsTexelsEvenly) {
    const Mesh mesh = troubled_mesh(4, 6, 5);
    const TriangleAtlas whole(mesh, 6);
    const SurfaceExtent extent = extent_of(mesh);
    const BasisTexels all = draw_basis_texels(whole, extent, 1'000'000, 30, 200);
    const auto& cubes = all.blocks.cubes;
    std::set<uint32_t> seen;
    ASSERT_EQ(all.of_block.size(), cubes.size());
    ASSERT_GT(cubes.size(), 5u);
    EXPECT_TRUE(std::ranges::is_sorted(cubes));
    for (size_t b = 0; b < cubes.size(); ++b)
        for (const uint32_t texel : all.of_block[b]) {
            EXPECT_EQ(cube_at(whole.position(texel), all.blocks.origin, all.blocks.cube), cubes[b]);
            EXPECT_TRUE(whole.usable(texel));
            EXPECT_TRUE(seen.insert(texel).second);
        }
    size_t usable = 0;
    for (uint32_t t = 0; t < whole.texel_count(); ++t) usable += whole.usable(t);
    EXPECT_EQ(seen.size(), usable);
    EXPECT_EQ(all.everywhere.size(), usable);

    constexpr size_t few = 400;
    const BasisTexels some = draw_basis_texels(whole, extent, few, 30, 200);
    std::map<uint32_t, int> of_tile;
    std::set<uint32_t> once;
    for (const uint32_t texel : some.everywhere) {
        ++of_tile[texel / whole.texels_per_tile()];
        EXPECT_TRUE(once.insert(texel).second);
    }
    EXPECT_EQ(once.size(), few);
    const size_t tiles = usable / TriangleTile::texels_of(6);
    EXPECT_GT(of_tile.size(), tiles * 9 / 10);  // 10 or so of each
    EXPECT_TRUE(draw_basis_texels(whole, extent, few, 1, 200).of_block.empty());
}

TEST(ViewBasis, TexelsThatNobodySeesHaveTheMean) {
    Surface surface(5);
    surface.samples = random_samples(surface.atlas, 5, 0.0f, 4);
    const ViewBasis basis = learn_view_basis(surface.dataset, surface.atlas, surface.samples, {.rank = 4, .blocks = 3});
    const auto solution = solve_view_basis(surface.dataset, surface.atlas, surface.samples, basis);
    EXPECT_TRUE(std::ranges::all_of(solution.parameters, [](float z) { return z == 0; }));
    EXPECT_TRUE(std::ranges::all_of(basis.numbers, [](float x) { return std::isfinite(x); }));
}

// Of images whose colours are linear over the picture, interpolation gives what stands at the texel's projection; and
// it gives it for every texel in sight, and none that something hides.
TEST(InterpolatedSamples, AreTheImageAtTexelsCentres) {
    const TemporaryFolder folder;
    const Dataset dataset = write_dataset(folder.path() / "data", sheet_dataset(troubled_mesh(3, 7, 1), 5, 48, 2),
                                          [](size_t, int x, int y, int c) { return uint8_t(5 * (c == 1 ? y : x)); });
    const TriangleAtlas atlas(dataset.mesh, 6);
    const std::vector<uint32_t> views = {0, 1, 3};
    const SampleList list = interpolated_samples(dataset, atlas, views);
    const RayCaster rays(dataset.mesh);
    for (uint32_t k = 0; k < views.size(); ++k) {
        const Camera& camera = dataset.views[views[k]].camera;
        size_t right = 0, wrong = 0, exact = 0, rim = 0;
        for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
            std::vector<const Sample*> of_texel(atlas.texels_per_tile());
            for (uint32_t g = list.tile_groups[tile]; g < list.tile_groups[tile + 1]; ++g)
                for (const Sample& sample : list.of_group(g))
                    if (list.groups[g].image == k) of_texel[sample.local] = &sample;
            for (uint32_t local = 0; local < atlas.tile(tile).texels() && !atlas.degenerate(tile); ++local) {
                const Vec3d place = atlas.position(tile, local).cast<double>(), p = camera.project(place);
                const bool inside = p.z() > 0 && p.x() > 1 && p.x() < 47 && p.y() > 1 && p.y() < 47;
                if (!inside) continue;
                const Vec3d eye = camera.center(), ray = place - eye;
                const bool seen = rays.closest(eye, ray, 2, RayCaster::Faces::front).triangle == tile;
                ++(seen == (of_texel[local] != nullptr) ? right : wrong);
                if (!of_texel[local] || !seen) continue;
                const double off = std::max(std::abs(of_texel[local]->rgb[0] / 257.0 - 5 * (p.x() - 0.5)),
                                            std::abs(of_texel[local]->rgb[1] / 257.0 - 5 * (p.y() - 0.5)));
                EXPECT_LT(off, 5) << "within a pixel, where the sheet's edge leaves some of the four out";
                ++(off < 0.1 ? exact : rim);
            }
        }
        EXPECT_GT(right, 100u);
        EXPECT_LT(wrong, right / 20);
        EXPECT_GT(exact, 3 * rim);
    }
}

TEST(ViewBasisFit, ReadsBackAsWritten) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data");
    const TriangleAtlas atlas(dataset.mesh, 5);
    const SampleList samples = random_samples(atlas, dataset.views.size(), 0.5f, 4);
    ViewBasisFit fit;
    fit.surface_side = 5;
    fit.surface = SurfaceLookup::linear;
    fit.basis = learn_view_basis(dataset, atlas, samples, {.rank = 3, .blocks = 4});
    auto solution = solve_view_basis(dataset, atlas, samples, fit.basis);
    fit.parameters = solution.parameters;
    fit.samples = solution.samples;
    fit.error = solution.error;
    fit.iterations.assign(fit.samples.size(), 0);
    for (const uint32_t seen : fit.samples) fit.status.push_back(seen ? Status::stationary : Status::no_samples);
    set_dataset(fit, dataset);
    const auto place = folder.path() / "fit";
    write_fit(place, fit, atlas);
    EXPECT_EQ(fitted_model(place), view_basis_name);
    const StoredViewBasis back = read_view_basis(place);
    EXPECT_EQ(back.fit.parameters, fit.parameters);
    EXPECT_EQ(back.fit.samples, fit.samples);
    EXPECT_EQ(back.fit.basis.cubes, fit.basis.cubes);
    EXPECT_EQ(back.fit.basis.cube, fit.basis.cube);
    EXPECT_EQ(back.fit.basis.origin, fit.basis.origin);
    EXPECT_EQ(back.fit.basis.noise, fit.basis.noise);
    EXPECT_EQ(back.fit.basis.numbers, fit.basis.numbers);
    std::vector<float> one, two;
    const View& view = dataset.views[0];
    Rasterizer rasterizer;
    const auto seen = seen_pixels(dataset, view, rasterizer);
    contestant_of(fit, atlas).shade(view, seen, one, 0);
    contestant_of(back.fit, *back.atlas).shade(view, seen, two, 0);
    EXPECT_EQ(one, two);
    EXPECT_EQ(back.fit.surface, fit.surface);
    fit.surface = SurfaceLookup::nearest;
    contestant_of(fit, atlas).shade(view, seen, two, 0);
    EXPECT_NE(one, two);
    std::filesystem::remove(place / "basis.exr");
    EXPECT_NE(user_error([&] { read_view_basis(place); }).find("basis.exr"), std::string::npos);
}

}  // namespace
}  // namespace radiafit::testing
