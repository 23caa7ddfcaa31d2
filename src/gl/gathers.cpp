#include "gl/gathers.h"

#include <algorithm>

namespace radiafit {
namespace {

constexpr uint32_t no_place = 0xffffffffu;
constexpr size_t entries_per_node = 12;  // and three look-ups for their places

Defines with(Defines defines, Gather gather) {
    if (gather == Gather::squares) defines.push_back({"SQUARE", ""});
    if (gather == Gather::maximum) defines.push_back({"MAXIMUM", ""});
    return defines;
}

constexpr Gather all_gathers[] = {Gather::sum, Gather::squares, Gather::maximum};

uint32_t packed(int x, int y, int layer) { return uint32_t(x) | uint32_t(y) << 14 | uint32_t(layer) << 28; }

}  // namespace

Gathers::Gathers(const MapShape& shape) : marks_(TilePlaces(*shape.atlas, TileOrder::layout)) {
    make_tile_levels(shape);
    make_ring_levels(shape, TileOrder::layout);
    make_ring_levels(shape, TileOrder::facing);
    for (Gather gather : all_gathers)
        ring_programs_[int(gather)] =
            Program::draw("common/whole.vert", "gather/ring_sum.frag",
                          with({}, gather == Gather::maximum ? Gather::maximum : Gather::sum));
    make_view_levels(shape);
}

void Gathers::make_tile_levels(const MapShape& shape) {
    const int columns = shape.atlas->rectangles_per_row();
    const int rows = shape.atlas->height() / (shape.atlas->side() + 1);
    for (int source = shape.atlas->side(); source > 1;) {
        TileLevel level;
        level.source_side = source;
        level.side = source <= 5 ? 1 : (source + 3) / 4;  // a tile of side 5 has 15 texels
        level.sums = Texture(GL_RGBA32F, columns * level.side, rows * (level.side + 1), 3);
        for (int corner = 0; corner < 3; ++corner) level.targets.push_back(Framebuffer({{&level.sums, corner}}));
        for (Gather gather : all_gathers) {
            // Only the first level squares.
            const Gather own = !tile_levels_.empty() && gather == Gather::squares ? Gather::sum : gather;
            Program& program = level.programs[int(gather)];
            program = Program::draw("common/whole.vert", "gather/tile_sum.frag",
                                    with({{"SIDE", std::to_string(level.side)},
                                          {"RECTANGLES", std::to_string(columns)},
                                          {"SOURCE_SIDE", std::to_string(level.source_side)}},
                                         own));
        }
        source = level.side;
        tile_levels_.push_back(std::move(level));
    }
}

void Gathers::make_ring_levels(const MapShape& shape, TileOrder order) {
    const size_t vertices = shape.layout->problem_count();
    const TilePlaces places(*shape.atlas, order);
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
        ring_levels_[int(order)].push_back(std::move(level));
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

void Gathers::tiles(PassRunner& run, const Texture& source, int corner, Gather gather) {
    const Texture* from = &source;
    marks_.bind(8);
    for (TileLevel& level : tile_levels_) {
        const Program& program = level.programs[int(gather)];
        from->bind(7);
        program.set(8, corner);
        run.bind(level.targets[size_t(corner)], program);
        run.draw_whole();
        from = &level.sums;
    }
}

void Gathers::rings(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather, bool blend,
                    TileOrder order) {
    const Texture* from = &source;
    const Program& program = ring_programs_[int(gather)];
    std::vector<RingLevel>& levels = ring_levels_[int(order)];
    for (size_t i = 0; i < levels.size(); ++i) {
        RingLevel& level = levels[i];
        const bool last = i + 1 == levels.size();
        from->bind(7);
        level.table.bind(8);
        run.bind(last ? target : level.target, program);
        if (last && blend) run.blend(gather == Gather::maximum ? GL_MAX : GL_FUNC_ADD);
        run.draw_whole();
        if (last && blend) run.no_blend();
        from = &level.nodes;
    }
}

void Gathers::views(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather) {
    const Texture* from = &source;
    for (size_t i = 0; i < view_levels_.size(); ++i) {
        ViewLevel& level = view_levels_[i];
        const bool last = i + 1 == view_levels_.size();
        from->bind(7);
        run.bind(last ? target : level.target, level.programs[int(gather)]);
        if (last) run.blend(gather == Gather::maximum ? GL_MAX : GL_FUNC_ADD);
        run.draw_whole();
        if (last) run.no_blend();
        from = &level.sums;
    }
}

}  // namespace radiafit
