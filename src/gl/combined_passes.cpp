#include <algorithm>

#include "gl/image_passes.h"

namespace radiafit {
namespace {

// Section 6.5's proposal: several render targets a pass and longer programs. One pass into SLS keeps the colours and
// blends the gradients of all corners; one fragment per tile then loops over the tile's texels; what need not be told
// apart by image is summed per tile over the whole sweep and gathered over the rings once, at its end.
class CombinedPasses final : public ImagePasses {
public:
    explicit CombinedPasses(const PassWorld& world);
    void count(const std::vector<ImageOnDevice>& images) override;
    void direction(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                   MapSums* squares) override;
    void line(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d, bool quartic) override;
    void begin_sweep(MapSums* gradient, MapSums* squares) override;
    void end_sweep() override;

private:
    // Per tile sums over a sweep, [3 corners] in the order of TileOrder::facing.
    enum TileSum { error, gauss_newton, curvature, third, fourth, target, tile_sums };
    void begin_image(const ImageOnDevice& image, const std::vector<const Program*>& programs);
    void look_up(const MapVector& x, const std::vector<Framebuffer>& targets);
    void further_terms(const MapVector& x, const std::vector<Framebuffer>& targets, MapSums& sums, bool squares,
                       int first_term);
    void ring_to_view(MapSums& sums, int term, bool squares);
    /// A pass of tile sums over some corners; at most 8 render targets allow no more than two with all quartic sums.
    struct TilePass {
        Program program;
        Framebuffer target;
    };
    static std::vector<const Program*> programs_of(const std::vector<TilePass>& passes) {
        std::vector<const Program*> programs;
        for (const TilePass& pass : passes) programs.push_back(&pass.program);
        return programs;
    }
    void make_tile_passes(std::vector<TilePass>& passes, const std::vector<TileSum>& sums, const Defines& defines);
    void tile_passes(const std::vector<TilePass>& passes);

    PassWorld w_;
    ItemBuffer items_;  // with colours
    TileMarks marks_;
    Texture taken_;      // in SLS: the colour that each texel takes in this image, alpha 1 where it does
    Texture footprint_;  // per vertex, in this image: weights of four view texels; the first of them
    Texture view_values_, view_slopes_;  // [terms] per vertex: h_k and dh_k in this image
    Texture product_;                    // per tile and corner: sum of r g_k in this image
    Texture sums_[tile_sums];
    Texture tile_vertices_;
    Framebuffer footprint_target_, product_target_, product_error_target_;
    std::vector<Framebuffer> value_targets_, slope_targets_, sum_targets_[tile_sums];
    std::vector<TilePass> line_passes_, quartic_passes_, count_passes_;
    std::vector<Framebuffer> direction_target_, term_targets_, square_targets_;  // [term]
    Program footprint_program_, look_up_program_, direction_program_, gradient_program_[2];
    Program tile_program_, tile_error_program_, tile_square_program_, scatter_program_[2];
    bool dirty_[tile_sums] = {};
};

CombinedPasses::CombinedPasses(const PassWorld& world)
    : w_(world),
      items_(world.mesh, world.max_width, world.max_height, world.bits),
      marks_(TilePlaces(*world.shape.atlas, TileOrder::facing)),
      taken_(world.bits == 8 ? GL_RGBA8UI : GL_RGBA16UI, world.shape.atlas->width(), world.shape.atlas->height()),
      footprint_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, 2),
      view_values_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, world.shape.terms()),
      view_slopes_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, world.shape.terms()),
      footprint_target_({{&footprint_, 0}, {&footprint_, 1}}) {
    const int terms = w_.shape.terms();
    const TilePlaces& places = marks_.places();
    const auto per_tile = [&] { return Texture(GL_RGBA32F, places.columns, places.rows, 3); };
    product_ = per_tile();
    for (Texture& sum : sums_) sum = per_tile();
    for (int sum = 0; sum < tile_sums; ++sum)
        for (int corner = 0; corner < 3; ++corner) sum_targets_[sum].push_back(Framebuffer({{&sums_[sum], corner}}));
    product_target_ = Framebuffer({{&product_, 0}, {&product_, 1}, {&product_, 2}});
    product_error_target_ = Framebuffer(
        {{&product_, 0}, {&product_, 1}, {&product_, 2}, {&sums_[error], 0}, {&sums_[error], 1}, {&sums_[error], 2}});
    for (int term = 0; term < terms; ++term) {
        value_targets_.push_back(Framebuffer({{&view_values_, term}}));
        slope_targets_.push_back(Framebuffer({{&view_slopes_, term}}));
    }

    const TriangleAtlas& atlas = *w_.shape.atlas;
    std::vector<uint32_t> of_tile(size_t(places.columns) * size_t(places.rows) * 4);
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        uint32_t* at = &of_tile[4 * size_t(places.of_tile[t])];
        std::copy_n(atlas.mesh().triangles[t].begin(), 3, at);
        at[3] = t;
    }
    tile_vertices_ = Texture(GL_RGBA32UI, places.columns, places.rows);
    tile_vertices_.upload(GL_RGBA_INTEGER, GL_UNSIGNED_INT, of_tile.data());

    const Defines shape = w_.shape.defines(w_.storage) + Defines{{"COLOUR", std::to_string(w_.bits)}};
    const Defines nearest = w_.lookup == ViewLookup::nearest ? Defines{{"NEAREST", ""}} : Defines{};
    const Defines square{{"DIAGONAL", ""}}, projected{{"PROJECTED", ""}};
    const auto whole = [&](const std::string& fragment, const Defines& more) {
        return Program::draw("common/whole.vert", fragment, shape + more);
    };
    footprint_program_ = whole("gather/footprint.frag", nearest);
    look_up_program_ = whole("gather/look_up.frag", {});
    direction_program_ = Program::draw("combine/map3.vert", "combine/direction.frag", shape + projected);
    tile_program_ = whole("combine/tile_direction.frag", {});
    tile_error_program_ = whole("combine/tile_direction.frag", {{"WITH_ERROR", ""}});
    tile_square_program_ = whole("combine/tile_direction.frag", square);
    make_tile_passes(line_passes_, {gauss_newton, curvature}, shape);
    make_tile_passes(quartic_passes_, {gauss_newton, curvature, third, fourth}, shape + Defines{{"QUARTIC", ""}});
    make_tile_passes(count_passes_, {target}, shape + Defines{{"COUNT", ""}});
    const int m = w_.shape.grid.view_side;
    for (int squares = 0; squares < 2; ++squares) {
        const Defines what = squares ? square : Defines{};
        gradient_program_[squares] = Program::draw("combine/map3.vert", "combine/gradient.frag", shape + what);
        scatter_program_[squares] = Program::draw("gather/scatter.vert", "gather/scatter.frag", shape + what);
        scatter_program_[squares].set2(6, float(w_.shape.grid.columns * m), float(w_.shape.grid.rows * m));
    }
    for (Program* program : {&direction_program_, &gradient_program_[0], &gradient_program_[1]})
        w_.mesh.set_layout(*program);
}

void CombinedPasses::make_tile_passes(std::vector<TilePass>& passes, const std::vector<TileSum>& sums,
                                      const Defines& defines) {
    const int most = std::min(3, 8 / int(sums.size()));
    for (int first = 0; first < 3; first += most) {
        const int corners = std::min(most, 3 - first);
        std::vector<Target> targets;
        for (TileSum sum : sums)
            for (int corner = first; corner < first + corners; ++corner) targets.push_back({&sums_[sum], corner});
        const Defines which{{"FIRST", std::to_string(first)}, {"CORNERS", std::to_string(corners)}};
        passes.push_back(
            {Program::draw("common/whole.vert", "combine/tile_line.frag", defines + which), Framebuffer(targets)});
        w_.mesh.set_layout(passes.back().program);
    }
}

void CombinedPasses::begin_sweep(MapSums* gradient, MapSums* squares) {
    for (int sum = 0; sum < tile_sums; ++sum) {
        for (Framebuffer& target : sum_targets_[sum]) w_.run.clear(target);
        dirty_[sum] = false;
    }
    const int terms = w_.shape.terms();
    const auto three = [&](MapSums& sums, int term) {
        return std::vector<Target>{
            {&sums.surface, term}, {&sums.surface, terms + term}, {&sums.surface, 2 * terms + term}};
    };
    // The engine keeps its sums where they are, so framebuffers are made in its first sweep only.
    if (gradient && term_targets_.empty()) {
        std::vector<Target> all{{&taken_}};
        for (const Target& target : three(*gradient, 0)) all.push_back(target);
        direction_target_.push_back(Framebuffer(all));
        for (int term = 0; term < terms; ++term) term_targets_.push_back(Framebuffer(three(*gradient, term)));
    }
    if (squares && square_targets_.empty())
        for (int term = 0; term < terms; ++term) square_targets_.push_back(Framebuffer(three(*squares, term)));
}

void CombinedPasses::end_sweep() {
    constexpr Sum sums[tile_sums] = {Sum::residual, Sum::gauss_newton, Sum::curvature,
                                     Sum::third,    Sum::fourth,       Sum::target};
    for (int sum = 0; sum < tile_sums; ++sum)
        if (dirty_[sum])
            w_.gathers.rings(w_.run, sums_[sum], w_.problems.sum_target(sums[sum]), Gather::sum, true,
                             TileOrder::facing);
}

void CombinedPasses::begin_image(const ImageOnDevice& image, const std::vector<const Program*>& programs) {
    for (const Program* program : programs) {
        SlsMesh::set_camera(*program, *image.camera);
        program->set(11, image.target_scale);
    }
    w_.mesh.select(image.camera);
    image.texture->bind(1);
    items_.draw(*image.camera);
    ++w_.run.counters.draws;
    ++w_.run.counters.framebuffer_switches;
    marks_.update(w_.mesh);
    set_eye(footprint_program_, *image.camera);
    w_.vertices.bind(9);
    w_.run.bind(footprint_target_, footprint_program_);
    w_.run.draw_whole();
}

void CombinedPasses::look_up(const MapVector& x, const std::vector<Framebuffer>& targets) {
    x.view().bind(2);
    footprint_.bind(10);
    for (int term = 0; term < w_.shape.terms(); ++term) {
        look_up_program_.set(10, term);
        w_.run.bind(targets[size_t(term)], look_up_program_);
        w_.run.draw_whole();
    }
}

void CombinedPasses::tile_passes(const std::vector<TilePass>& passes) {
    items_.items().bind(0);
    marks_.bind(8);
    w_.vertices.bind(9);
    tile_vertices_.bind(10);
    w_.run.blend();
    for (const TilePass& pass : passes) {
        w_.run.bind(pass.target, pass.program);
        w_.run.draw_whole();
    }
    w_.run.no_blend();
}

void CombinedPasses::count(const std::vector<ImageOnDevice>& images) {
    dirty_[target] = true;
    for (const ImageOnDevice& image : images) {
        begin_image(image, programs_of(count_passes_));
        tile_passes(count_passes_);
    }
}

void CombinedPasses::ring_to_view(MapSums& sums, int term, bool squares) {
    w_.gathers.rings(w_.run, product_, w_.problems.ring_target, Gather::sum, false, TileOrder::facing);
    w_.problems.ring.bind(7);
    footprint_.bind(10);
    w_.run.bind(sums.view_targets[size_t(term)], scatter_program_[squares]);
    w_.run.blend();
    w_.run.draw_points(w_.shape.layout->problem_count());
    w_.run.no_blend();
}

void CombinedPasses::further_terms(const MapVector& x, const std::vector<Framebuffer>& targets, MapSums& sums,
                                   bool squares, int first_term) {
    const Program& surface = gradient_program_[squares];
    const Program& tile = squares ? tile_square_program_ : tile_program_;
    for (int term = first_term; term < w_.shape.terms(); ++term) {
        taken_.bind(4);
        view_values_.bind(5);
        x.surface().bind(2);
        surface.set(10, term);
        w_.run.bind(targets[size_t(term)], surface);
        w_.run.blend();
        w_.run.draw_tiles();
        w_.run.no_blend();
        tile_vertices_.bind(10);
        marks_.bind(8);
        tile.set(10, term);
        w_.run.bind(product_target_, tile);
        w_.run.draw_whole();
        ring_to_view(sums, term, squares);
    }
}

void CombinedPasses::direction(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                               MapSums* squares) {
    dirty_[error] = true;
    for (const ImageOnDevice& image : images) {
        begin_image(image, {&direction_program_, &gradient_program_[0], &tile_program_, &tile_error_program_});
        look_up(x, value_targets_);
        items_.items().bind(0);
        x.surface().bind(2);
        view_values_.bind(5);
        w_.run.bind(direction_target_.front(), direction_program_);
        w_.run.blend_from(1, 4);
        w_.run.draw_tiles();
        w_.run.no_blend();
        taken_.bind(4);
        tile_vertices_.bind(10);
        marks_.bind(8);
        w_.run.bind(product_error_target_, tile_error_program_);
        w_.run.blend_from(3, 6);
        w_.run.draw_whole();
        w_.run.no_blend();
        ring_to_view(gradient, 0, false);
        further_terms(x, term_targets_, gradient, false, 1);
        if (squares) further_terms(x, square_targets_, *squares, true, 0);
    }
}

void CombinedPasses::line(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                          bool quartic) {
    dirty_[gauss_newton] = dirty_[curvature] = true;
    dirty_[third] = dirty_[fourth] = quartic;
    const std::vector<TilePass>& passes = quartic ? quartic_passes_ : line_passes_;
    for (const ImageOnDevice& image : images) {
        begin_image(image, programs_of(passes));
        look_up(x, value_targets_);
        look_up(d, slope_targets_);
        x.surface().bind(2);
        d.surface().bind(3);
        view_values_.bind(5);
        view_slopes_.bind(6);
        tile_passes(passes);
    }
}

}  // namespace

std::unique_ptr<ImagePasses> make_combined_passes(const PassWorld& world) {
    return std::make_unique<CombinedPasses>(world);
}

}  // namespace radiafit
