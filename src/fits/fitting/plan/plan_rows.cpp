#include "fitting/plan/plan_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "fitting/solvers/solver.h"
#include "geometry/mesh_part.h"
#include "samples/interpolated_samples.h"

namespace radiafit::fits {

uint64_t total_bytes(const std::vector<PlanRow>& rows) {
    uint64_t most = 0;
    for (const unsigned stage :
         {PlanRow::while_distributing, PlanRow::while_learning, PlanRow::while_solving, PlanRow::while_writing}) {
        uint64_t sum = 0;
        for (const PlanRow& row : rows) sum += row.stages & stage ? row.bytes : 0;
        most = std::max(most, sum);
    }
    return most;
}

std::vector<PlanRow> rows_of(const std::vector<PlannedArray>& arrays) {
    std::vector<PlanRow> rows;
    for (const PlannedArray& a : arrays) rows.push_back({a.array, a.shape, a.count, a.bytes});
    return rows;
}

namespace {

/// Every eighth view is looked at, but of few more: eight at least.
size_t step_between(size_t views, size_t most_views) {
    return std::max({size_t(1), std::min<size_t>(8, views / 8), (views + most_views - 1) / most_views});
}

}  // namespace

SampleEstimate estimate_samples(const Dataset& dataset, const Atlas& atlas, const FitRequest& request,
                                size_t most_views, std::vector<uint64_t>* tiles) {
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    FitRequest on_cpu = request;
    on_cpu.distributor = DistributorKind::cpu;
    const Distributors distributors = make_distributors(atlas, on_cpu);
    const size_t step = step_between(views.size(), most_views);
    const size_t looked_at = (views.size() + step - 1) / step;
    const auto scaled = [&](uint64_t count) { return looked_at ? count * views.size() / looked_at : 0; };
    std::vector<SampleEstimate> seen(looked_at);
    std::vector<std::vector<uint64_t>> parts(size_t(thread_count()), std::vector<uint64_t>(tiles ? tiles->size() : 0));
    std::vector<std::unique_ptr<ImageStream>> streams{size_t(thread_count())};
    parallel_for(looked_at, 1, [&](size_t i, int worker) {
        auto& stream = streams[size_t(worker)];
        if (!stream) stream = std::make_unique<ImageStream>(dataset, StreamSource::disk, TargetSpace::linear);
        TargetImage image;
        Distribution distribution;
        const uint32_t view = views[i * step];
        stream->load_mask(view, image);
        distributors.owned[size_t(worker)]->distribute(dataset.views[view].camera, image, distribution);
        seen[i].samples = distribution.kept_pixels;
        const auto taken = [](uint32_t pixel) { return pixel != no_pixel; };
        for (auto tile = distribution.texel_pixel.begin(); tile != distribution.texel_pixel.end();
             tile += atlas.texels_per_tile())
            seen[i].groups += std::any_of(tile, tile + atlas.texels_per_tile(), taken);
        for (size_t t = 0; tiles && t < distribution.texel_pixel.size(); ++t)
            parts[size_t(worker)][t * tiles->size() / distribution.texel_pixel.size()] +=
                distribution.texel_pixel[t] != no_pixel;
    });
    for (size_t t = 0; tiles && t < tiles->size(); ++t) {
        uint64_t taken = 0;
        for (const auto& part : parts) taken += part[t];
        (*tiles)[t] = scaled(taken);
    }
    SampleEstimate sum;
    for (const SampleEstimate& of_view : seen) sum.samples += of_view.samples, sum.groups += of_view.groups;
    return {scaled(sum.samples), scaled(sum.groups)};
}

SampleEstimate estimate_interpolated(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                                     size_t most_views, std::vector<uint64_t>* tiles) {
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const size_t step = step_between(views.size(), most_views);
    std::vector<uint32_t> some;
    for (size_t i = 0; i < views.size(); i += step) some.push_back(views[i]);
    if (some.empty()) return {};
    const InterpolatedCounts seen = count_interpolated(dataset, atlas, some, tiles);
    const auto scaled = [&](uint64_t count) { return count * views.size() / some.size(); };
    if (tiles) std::ranges::transform(*tiles, tiles->begin(), scaled);
    return {scaled(seen.samples), scaled(seen.groups)};
}

void add_host_images(const Dataset& dataset, const FitRequest& request, std::vector<PlanRow>& rows) {
    if (request.source != ImageSource::memory) return;
    rows.push_back({"images in host memory", fmt::format("{} views", dataset.views.size()), dataset.views.size(),
                    dataset.image_bytes()});
}

PlanRow prior_row(const TexelModel& model, uint64_t texels) {
    constexpr uint64_t fewest_of_block = 64, figures = 4, places = 3;
    const uint64_t n = uint64_t(model.parameters);
    const uint64_t numbers = 2 * texels * n / fewest_of_block + texels * (n + figures + places);
    return {"prior", "blocks' means, texels' places, and results of poorly seen texels at most", numbers,
            numbers * sizeof(float)};
}

PlanRow held_samples(const FitRequest& request, uint64_t bytes) {
    return {"samples held in step 1, at most", "--sort-memory, beside an image per thread", 0,
            std::min(request.sort_memory, bytes)};
}

void add_distributors(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                      std::vector<PlanRow>& rows) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels =
            std::max(pixels, uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height));
    const uint64_t threads = std::min(uint64_t(thread_count()), uint64_t(views.size()));
    const uint64_t vertices = visible_mesh(dataset.mesh).vertex_count();
    constexpr uint64_t pixel_bytes = 8 + 12 + 4 + 4, vertex_bytes = 24, texel_bytes = 4, tile_bytes = 1;
    const uint64_t bytes = pixels * pixel_bytes + vertices * vertex_bytes + atlas.texel_count() * texel_bytes +
                           atlas.tile_count() * tile_bytes;
    rows.push_back({"images on their way to texels", fmt::format("{} threads x {} bytes", threads, bytes), threads,
                    threads * bytes, PlanRow::while_distributing});
}

void add_samples(const SampleEstimate& seen, uint64_t tiles, unsigned stages, std::vector<PlanRow>& rows) {
    const uint64_t list = seen.samples * sizeof(Sample) + seen.groups * sizeof(SampleGroup) + 4 * tiles;
    const auto shape = [&](size_t group) {
        return fmt::format("pixels x {} bytes, {} groups x {} bytes", sizeof(Sample), seen.groups, group);
    };
    rows.push_back({"samples, about", shape(sizeof(SampleGroup)), seen.samples, list, stages});
    rows.push_back({"samples by image, about", shape(8), seen.samples, seen.samples * sizeof(Sample) + seen.groups * 8,
                    PlanRow::while_distributing});
}

void add_mesh(const Dataset& dataset, std::vector<PlanRow>& rows) {
    const uint64_t triangles = dataset.mesh.triangle_count(), vertices = dataset.mesh.vertex_count();
    constexpr uint64_t of_triangle = 12 + 24 + 2, of_vertex = 12 + 12 + 4;  // mesh, rings, atlas
    rows.push_back({"mesh and its rings", fmt::format("{} triangles, {} vertices", triangles, vertices), triangles,
                    of_triangle * triangles + of_vertex * vertices, PlanRow::while_all});
}

}  // namespace radiafit::fits
