#include "fragment/gathers.h"

#include <algorithm>

namespace radiafit {
namespace {

constexpr uint32_t no_place = 0xffffffffu;
constexpr size_t entries_per_node = Gathers::ring_entries;

Defines with(Defines defines, Gather gather) {
    if (gather == Gather::squares) defines.push_back({"SQUARE", ""});
    if (gather == Gather::maximum) defines.push_back({"MAXIMUM", ""});
    return defines;
}

constexpr Gather all_gathers[] = {Gather::sum, Gather::squares, Gather::maximum};

uint32_t packed(int x, int y, int layer) { return uint32_t(x) | uint32_t(y) << 14 | uint32_t(layer) << 28; }

}  // namespace

std::vector<int> Gathers::tile_bands(int texels, int entries) {
    std::vector<int> levels;
    for (int bands = (texels + entries - 1) / entries; bands > 1; bands = (bands + 15) / 16) levels.push_back(bands);
    return levels;
}

Gathers::Gathers(const MapShape& shape, Storage storage, bool constant_loops)
    : constant_loops_(constant_loops),
      marks_(TilePlaces(*shape.atlas)),
      tile_sums_(GL_RGBA32F, marks_.places().columns, marks_.places().rows, 3) {
    for (int corner = 0; corner < 3; ++corner) tile_targets_.push_back(Framebuffer({{&tile_sums_, corner}}));
    const Defines defines = shape.defines(storage), product = defines + Defines{{"PRODUCT", ""}};
    tile_gather_ = make_tile_gather(shape, tile_entries,
                                    {defines, with(defines, Gather::squares), with(defines, Gather::maximum)});
    product_gather_ = make_tile_gather(shape, product_entries, {product, product + Defines{{"DIAGONAL", ""}}});
    make_ring_levels(shape);
    for (Gather gather : all_gathers)
        ring_programs_[int(gather)] =
            Program::draw("common/whole.vert", "gather/ring_sum.frag",
                          with({}, gather == Gather::maximum ? Gather::maximum : Gather::sum));
    make_view_levels(shape);
}

Gathers::TileGather Gathers::make_tile_gather(const MapShape& shape, int entries,
                                              const std::vector<Defines>& variants) {
    const int columns = marks_.places().columns, rows = marks_.places().rows;
    const Defines band_rows{{"ROWS", std::to_string(rows)}};
    TileGather gather;
    for (size_t i = 0; i < variants.size(); ++i)
        gather.first[i] = Program::draw(
            "common/whole.vert", "gather/tile_texels.frag",
            variants[i] + band_rows + Defines{{constant_loops_ ? "TURNS" : "ENTRIES", std::to_string(entries)}});
    for (int bands : tile_bands(int(shape.atlas->texels_per_tile()), entries)) {
        Bands level;
        level.sums = Texture(GL_RGBA32F, columns, rows * bands, 1);
        level.target = Framebuffer({{&level.sums, 0}});
        gather.levels.push_back(std::move(level));
        Defines defines = band_rows + Defines{{"BANDS", std::to_string(bands)}};
        if (constant_loops_) defines.push_back({"TURNS", std::to_string(std::min(16, bands))});
        std::array<Program, 2> programs;
        for (int maximum = 0; maximum < 2; ++maximum)
            programs[size_t(maximum)] = Program::draw("common/whole.vert", "gather/band_sum.frag",
                                                      with(defines, maximum ? Gather::maximum : Gather::sum));
        gather.further.push_back(std::move(programs));
    }
    return gather;
}

void Gathers::make_ring_levels(const MapShape& shape) {
    const size_t vertices = shape.layout->problem_count();
    const TilePlaces& places = marks_.places();
    // entries[v]: places of what the next level sums for v
    std::vector<std::vector<uint32_t>> entries(vertices);
    for (size_t v = 0; v < vertices; ++v)
        for (const Corner& c : shape.rings->ring(v)) {
            const int place = int(places.of_tile[c.triangle]);
            entries[v].push_back(packed(place % places.columns, place / places.columns, int(c.corner)));
        }
    for (bool last = false; !last;) {
        size_t longest = 0;
        for (const auto& list : entries) longest = std::max(longest, list.size());
        last = longest <= entries_per_node;
        std::vector<std::vector<uint32_t>> nodes;
        std::vector<std::vector<size_t>> of_vertex(vertices);
        for (size_t v = 0; v < vertices; ++v)
            for (size_t first = 0; first == 0 || first < entries[v].size(); first += entries_per_node) {
                of_vertex[v].push_back(nodes.size());
                const auto begin = entries[v].begin() + std::ptrdiff_t(first);
                nodes.emplace_back(begin,
                                   begin + std::ptrdiff_t(std::min(entries_per_node, entries[v].size() - first)));
            }
        const int columns = last ? shape.grid.columns : std::min<int>(1024, int(nodes.size()));
        const int rows = last ? shape.grid.rows : int((nodes.size() + size_t(columns) - 1) / size_t(columns));
        RingLevel level;
        level.table = Texture(GL_RGBA32UI, columns, rows, 3);
        for (int group = 0; group < 3; ++group) {
            std::vector<uint32_t> table(size_t(columns) * rows * 4, no_place);
            for (size_t n = 0; n < nodes.size(); ++n)
                for (size_t i = 0; i < 4; ++i)
                    if (4 * size_t(group) + i < nodes[n].size()) table[4 * n + i] = nodes[n][4 * size_t(group) + i];
            level.table.upload(GL_RGBA_INTEGER, GL_UNSIGNED_INT, table.data(), group);
        }
        if (!last) {
            level.nodes = Texture(GL_RGBA32F, columns, rows, 1);
            level.target = Framebuffer({{&level.nodes, 0}});
            for (size_t v = 0; v < vertices; ++v) {
                entries[v].clear();
                for (size_t n : of_vertex[v]) entries[v].push_back(packed(int(n) % columns, int(n) / columns, 0));
            }
        }
        ring_levels_.push_back(std::move(level));
    }
}

void Gathers::make_view_levels(const MapShape& shape) {
    for (int source = shape.grid.view_side; source > 1;) {
        ViewLevel level;
        const int side = (source + 3) / 4;
        if (side > 1) {
            level.sums = Texture(GL_RGBA32F, shape.grid.columns * side, shape.grid.rows * side, 1);
            level.target = Framebuffer({{&level.sums, 0}});
        }
        for (Gather gather : all_gathers)
            level.programs[int(gather)] = Program::draw(
                "common/whole.vert", "gather/view_sum.frag",
                with({{"SOURCE_SIDE", std::to_string(source)}, {"TARGET_SIDE", std::to_string(side)}}, gather));
        source = side;
        view_levels_.push_back(std::move(level));
    }
}

void Gathers::gather_tiles(PassRunner& run, TileGather& gather, const Program& first, int corner, bool maximum) {
    const auto target = [&](size_t level) -> const Framebuffer& {
        return level < gather.levels.size() ? gather.levels[level].target : tile_targets_[size_t(corner)];
    };
    first.bind("drawn", marks_.texture());
    first.set("corner", corner);
    run.draw_whole(target(0), first, constant_loops_ ? 0 : run.tile_texels());
    for (size_t i = 0; i < gather.levels.size(); ++i) {
        const Texture& bands = gather.levels[i].sums;
        const Program& program = gather.further[i][maximum];
        program.bind("source", bands);
        const uint64_t entries = uint64_t(bands.width()) * uint64_t(bands.height());  // a band is one once
        run.draw_whole(target(i + 1), program, constant_loops_ ? 0 : entries);
    }
}

void Gathers::tiles(PassRunner& run, const Texture& source, int corner, Gather gather) {
    const Program& program = tile_gather_.first[int(gather)];
    program.bind("source", source);
    gather_tiles(run, tile_gather_, program, corner, gather == Gather::maximum);
}

void Gathers::tile_products(PassRunner& run, const Texture& residuals, const Texture& surface, int corner, int term,
                            bool squares) {
    const Program& program = product_gather_.first[squares];
    program.bind("source", residuals);
    program.bind("surface_maps", surface);
    program.set("term", term);
    gather_tiles(run, product_gather_, program, corner, false);
}

void Gathers::rings(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather, bool blend) {
    const Texture* from = &source;
    const Program& program = ring_programs_[int(gather)];
    for (size_t i = 0; i < ring_levels_.size(); ++i) {
        RingLevel& level = ring_levels_[i];
        const bool last = i + 1 == ring_levels_.size();
        program.bind("source", *from);
        program.bind("ring_table", level.table);
        if (last && blend) run.blend(gather == Gather::maximum ? GL_MAX : GL_FUNC_ADD);
        run.draw_whole(last ? target : level.target, program);
        if (last && blend) run.no_blend();
        from = &level.nodes;
    }
}

void Gathers::views(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather) {
    const Texture* from = &source;
    for (size_t i = 0; i < view_levels_.size(); ++i) {
        ViewLevel& level = view_levels_[i];
        const bool last = i + 1 == view_levels_.size();
        const Program& program = level.programs[int(gather)];
        program.bind("source", *from);
        if (last) run.blend(gather == Gather::maximum ? GL_MAX : GL_FUNC_ADD);
        run.draw_whole(last ? target : level.target, program);
        if (last) run.no_blend();
        from = &level.sums;
    }
}

}  // namespace radiafit
