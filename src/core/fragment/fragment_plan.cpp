#include "fragment/fragment_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "fragment/gathers.h"
#include "fragment/image_passes.h"
#include "fragment/image_sweep.h"
#include "fragment/problem_numbers.h"

namespace radiafit {
namespace {

constexpr uint64_t float4 = 16, half4 = 8;

class Plan {
public:
    void add(std::string array, std::string shape, uint64_t count, uint64_t bytes_each) {
        arrays.push_back({std::move(array), std::move(shape), count, count * bytes_each});
    }
    std::vector<PlannedArray> arrays;
};

// Look-up tables of the gather over rings, three look-ups of four places for each node, and its nodes but for the last.
void add_ring_levels(Plan& plan, const VertexRings& rings, uint64_t problems) {
    constexpr size_t entries_per_node = Gathers::ring_entries;
    std::vector<size_t> entries(rings.vertex_count());
    for (size_t v = 0; v < entries.size(); ++v) entries[v] = rings.ring(v).size();
    uint64_t tables = 0, inner = 0;
    for (bool last = false; !last;) {
        last = std::all_of(entries.begin(), entries.end(), [](size_t n) { return n <= entries_per_node; });
        uint64_t nodes = 0;
        for (size_t& n : entries) nodes += n = std::max<size_t>(1, (n + entries_per_node - 1) / entries_per_node);
        const uint64_t columns = std::min<uint64_t>(1024, nodes);
        const uint64_t texels = last ? problems : columns * ((nodes + columns - 1) / columns);
        tables += 3 * texels;
        if (!last) inner += texels;
    }
    plan.add("ring tables", "3 look-ups per node", tables, 16);
    plan.add("ring nodes", "", inner, float4);
}

}  // namespace

void plan_images(std::vector<PlannedArray>& plan, const Dataset& dataset, std::span<const uint32_t> views,
                 uint64_t batch, int bits, bool keep_on_device) {
    const uint64_t each = bits == 8 ? 4 : half4;
    if (keep_on_device) {
        uint64_t pixels = 0;
        for (uint32_t view : views)
            pixels += uint64_t(dataset.views[view].camera.width) * dataset.views[view].camera.height;
        plan.push_back({"images", fmt::format("{}, of their own sizes", views.size()), pixels, pixels * each});
        return;
    }
    const auto [width, height] = largest_image(dataset, views);
    const auto add = [&, width = width, height = height](const char* array, uint64_t images) {
        const uint64_t pixels = images * uint64_t(width) * uint64_t(height);
        plan.push_back({array, fmt::format("{} x {} x {}", images, width, height), pixels, pixels * each});
    };
    add("image slots", 2 * batch);
    add(on_their_way, 2);
}

std::vector<PlannedArray> plan_fragment_engine(const Dataset& dataset, const TriangleAtlas& atlas,
                                               const VertexRings& rings, std::span<const uint32_t> views,
                                               const LfmOptions& options, const FragmentOptions& fragment_options,
                                               const Room& room) {
    const uint64_t terms = uint64_t(options.terms);
    const ProblemGrid grid(rings.vertex_count(), options.view_side);
    const uint64_t problems = uint64_t(grid.columns) * grid.rows;
    const uint64_t layout = uint64_t(atlas.width()) * atlas.height();
    const uint64_t map_texels = problems * options.view_side * options.view_side;
    const TilePlaces places(atlas);
    const uint64_t tiles = uint64_t(places.columns) * places.rows;
    const auto [width, height] = largest_image(dataset, views);
    const uint64_t pixels = uint64_t(width) * uint64_t(height);
    const int bits = ImageStream(dataset, StreamSource::disk, fragment_options.space).bits();
    const uint64_t stored = fragment_options.storage == Storage::fp32 ? float4 : half4;
    const uint64_t summed = fragment_options.sums == Sums::fp32 ? float4 : half4;
    const bool combined = fragment_options.passes == Passes::combined, r300 = fragment_options.passes == Passes::r300;
    constexpr int usual_varyings = 124;  // components; what today's devices have at least
    const int together = combined_batch(options.terms, bits, usual_varyings, fragment_options.images_per_pass);
    const uint64_t batch = combined ? uint64_t(together) : 1;

    Plan plan;
    const std::string maps = fmt::format("{} x 3 x {} x {} + {} x {} x {}", terms, atlas.width(), atlas.height(), terms,
                                         problems, options.view_side * options.view_side);
    for (const char* name : {"p", "trial", "g", "trial g", "P", "fresh P", "d"})
        plan.add(name, maps, terms * (3 * layout + map_texels), stored);
    if (room.vectors > 0)
        plan.add("vectors of the optimizer", fmt::format("{} x as many", room.vectors),
                 uint64_t(room.vectors) * terms * (3 * layout + map_texels), stored);
    if (r300)
        plan.add("spares that updates write", fmt::format("{} x as many", most_written),
                 uint64_t(most_written) * terms * (3 * layout + map_texels), stored);
    for (const char* name : {"gradient sums", "diagonal sums"})
        plan.add(name, maps, terms * (3 * layout + map_texels), summed);
    plan.add("L p, products", fmt::format("2 x (3 x {} x {} + view maps)", atlas.width(), atlas.height()),
             2 * (3 * layout + map_texels), float4);

    uint64_t triangles = 0;
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) triangles += !atlas.degenerate(t);
    plan.add("mesh", fmt::format("{} triangles, attributes and indices", triangles),
             triangles * 3 * (3 * 12 + 4 + 12 + 4), 1);
    plan.add("vertex frames", fmt::format("4 x {} x {}", grid.columns, grid.rows), 4 * problems, float4);
    const int state_layers = (r300 ? 2 : 1) * ProblemNumbers::layers(room);  // of three problems a vertex
    plan.add("state of problems", fmt::format("(4 + 3 x {}) x {} x {}", state_layers, grid.columns, grid.rows),
             (4 + 3 * uint64_t(state_layers)) * problems, float4);
    plan.add("summary of problems", "levels", ProblemNumbers::summary_texels(3 * grid.columns, grid.rows, r300), 16);
    plan.add("dot products", fmt::format("{} x {} x {}", room.product_count(), grid.columns, grid.rows),
             uint64_t(room.product_count()) * problems, float4);
    plan.add("sums of problems over samples", fmt::format("5 x {} x {}", grid.columns, grid.rows), 5 * problems,
             summed);
    plan.add("sums of problems over maps", fmt::format("3 x {} x {}", grid.columns, grid.rows), 3 * problems, float4);
    plan.add("tiles drawn", "2 sets", 2 * tiles, 4);
    uint64_t bands = 0;
    for (int entries : {Gathers::tile_entries, Gathers::product_entries})
        for (int of_level : Gathers::tile_bands(int(atlas.texels_per_tile()), entries)) bands += uint64_t(of_level);
    plan.add("sums of tiles", "3 corners, and levels below", tiles * (3 + bands), float4);
    uint64_t view_sums = 0;
    for (int side = (options.view_side + 3) / 4; side > 1; side = (side + 3) / 4) view_sums += problems * side * side;
    plan.add("sums of view maps", "levels", view_sums, float4);
    add_ring_levels(plan, rings, problems);

    plan_images(plan.arrays, dataset, views, batch, bits, fragment_options.keep_on_device);
    const uint64_t item = !combined ? 4 : bits == 8 ? 8 : 16;
    plan.add("item buffer", fmt::format("{} x {} x {}", batch, width, height), batch * pixels, item);
    plan.add("depth", fmt::format("{} x {}", width, height), pixels, 4);
    plan.add("footprints and view values", fmt::format("{} x {} per vertex", batch, 2 + 2 * terms),
             batch * (2 + 2 * terms) * problems, float4);
    if (!combined) {
        if (fragment_options.keep_samples)
            plan.add("samples kept", fmt::format("{} x {} x {}", views.size(), atlas.width(), atlas.height()),
                     views.size() * layout, bits == 8 ? 4 : 8);
        plan.add("residuals, products", fmt::format("6 x {} x {}", atlas.width(), atlas.height()), 6 * layout, float4);
        return plan.arrays;
    }
    plan.add("colours of texels", fmt::format("{} x {}", atlas.width(), atlas.height()), layout,
             4 * (batch * uint64_t(bits) / 8 <= 2 ? batch * uint64_t(bits) / 8 : 4));
    plan.add("tile sums over a sweep", "5 x 3 corners", 15 * tiles, summed);
    plan.add("tile sums of targets", "3 corners", 3 * tiles, float4);
    plan.add("tile sums of images", fmt::format("{} x 3 corners", batch), 3 * batch * tiles, float4);
    plan.add("vertices of tiles", "", tiles, 16);
    return plan.arrays;
}

}  // namespace radiafit
