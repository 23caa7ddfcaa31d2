#include "fragment/texel_plan.h"

#include <fmt/format.h>

#include "fragment/problem_numbers.h"
#include "fragment/texel_passes.h"

namespace radiafit {

std::vector<PlannedArray> plan_texel_engine(const Dataset& dataset, const Atlas& atlas, std::span<const uint32_t> views,
                                            const TexelOptions& options, const FragmentOptions& fragment_options,
                                            const Room& room) {
    const TexelShape shape(atlas, *options.model);
    const auto* triangles = dynamic_cast<const TriangleAtlas*>(&atlas);
    const bool combined = fragment_options.passes == Passes::combined, r300 = fragment_options.passes == Passes::r300;
    const int bits = ImageStream(dataset, StreamSource::disk, TargetSpace::linear).bits();
    constexpr uint64_t float4 = 16, half4 = 8;
    const uint64_t stored = fragment_options.storage == Storage::fp32 ? float4 : half4;
    const uint64_t summed = fragment_options.sums == Sums::fp32 ? float4 : half4;

    std::vector<PlannedArray> plan;
    const auto layers = [&](const char* array, int count, uint64_t bytes_each) {
        const uint64_t texels = uint64_t(count) * uint64_t(shape.width()) * uint64_t(shape.height());
        plan.push_back(
            {array, fmt::format("{} x {} x {}", count, shape.width(), shape.height()), texels, texels * bytes_each});
    };
    for (const char* name : {"p", "trial", "g", "trial g", "P", "fresh P", "d"}) layers(name, shape.maps(), stored);
    layers("gradient sums", shape.maps(), summed);
    layers("diagonal sums", shape.diagonal_layers(), summed);
    layers("sums along d", 1, summed);
    layers("samples and albedo", 2, float4);
    layers("positions and normals", 2, float4);
    if (room.vectors > 0) layers("vectors of the optimizer", room.vectors * shape.maps(), stored);
    if (r300) layers("spares that updates write", most_written * shape.maps(), stored);
    layers("state of problems", (r300 ? 2 : 1) * ProblemNumbers::layers(room), float4);
    const uint64_t summaries = ProblemNumbers::summary_texels(shape.width(), shape.height(), r300);
    plan.push_back({"summary of problems", "levels", summaries, summaries * 16});
    layers("dot products, 1 / samples, penalty", room.product_count() + 2, 4);
    if (!combined) layers("residuals", 1, float4);

    const int images_per_pass =
        combined ? combined_texel_images(atlas, views.size(), bits, fragment_options.images_per_pass) : 1;
    if (combined)
        plan.push_back(
            {"numbers of views", fmt::format("3 x {}", views.size()), 3 * views.size(), 3 * views.size() * float4});
    if (!triangles) {
        const uint64_t turns = (views.size() + uint64_t(images_per_pass) - 1) / uint64_t(images_per_pass),
                       each = ImageStack::bytes(shape.width(), shape.height(), bits) * uint64_t(images_per_pass);
        const auto stacks = [&](const char* array, uint64_t count) {
            plan.push_back({array,
                            fmt::format("{} x {} x {} x {}", count, images_per_pass, shape.width(), shape.height()),
                            count * each, count * each});
        };
        stacks("stacks of images", fragment_options.keep_on_device ? turns : std::min<uint64_t>(2, turns));
        if (!fragment_options.keep_on_device) stacks(on_their_way, 2);
        return plan;
    }
    plan_images(plan, dataset, views, 1, bits, fragment_options.keep_on_device);
    if (combined) layers("pixels that texels take", images_per_pass, uint64_t(bits / 2));
    const auto [width, height] = largest_image(dataset, views);
    const uint64_t pixels = uint64_t(width) * uint64_t(height);
    for (const char* array : {"item buffer", "depth"})
        plan.push_back({array, fmt::format("{} x {}", width, height), pixels, 4 * pixels});
    uint64_t drawn = 0;
    for (uint32_t t = 0; t < triangles->tile_count(); ++t) drawn += !triangles->degenerate(t);
    const uint64_t bytes = drawn * 3 * (3 * 12 + 4 + 12 + 4);
    plan.push_back({"mesh", fmt::format("{} triangles, attributes and indices", drawn), bytes, bytes});
    return plan;
}

}  // namespace radiafit
