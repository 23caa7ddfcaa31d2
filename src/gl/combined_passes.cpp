#include "gl/image_passes.h"

namespace radiafit {
namespace {

Defines operator+(Defines a, const Defines& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// Section 6.5's proposal: several render targets a pass and longer programs. One pass into SLS keeps the targets and
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
    // Per tile sums over a sweep, [3 corners] in the layout of tiles of side 1.
    enum TileSum { error, gauss_newton, curvature, third, fourth, target, tile_sums };
    void begin_image(const ImageOnDevice& image, const Program& program);
    void look_up(const MapVector& x, const std::vector<Framebuffer>& targets);
    void further_terms(const MapVector& x, const std::vector<Framebuffer>& targets, MapSums& sums, bool squares,
                       int first_term);
    void ring_to_view(MapSums& sums, int term, bool squares);
    void tile_pass(const ImageOnDevice& image, const Program& program, const std::vector<Framebuffer>& targets);

    PassWorld w_;
    ItemBuffer items_;
    Texture taken_;                      // in SLS: the target of each texel in this image, alpha 1 where there is one
    Texture footprint_;                  // per vertex, in this image: weights of four view texels; the first of them
    Texture view_values_, view_slopes_;  // [terms] per vertex: h_k and dh_k in this image
    Texture product_;                    // per tile and corner: sum of r g_k in this image
    Texture sums_[tile_sums];
    Texture tile_vertices_;
    Framebuffer footprint_target_, product_target_, product_error_target_;
    std::vector<Framebuffer> value_targets_, slope_targets_, sum_targets_[tile_sums];
    std::vector<Framebuffer> line_targets_, quartic_targets_;                    // [corner]
    std::vector<Framebuffer> direction_target_, term_targets_, square_targets_;  // [term]
    Program footprint_program_, look_up_program_, direction_program_, gradient_program_[2];
    Program tile_program_, tile_error_program_, tile_square_program_, scatter_program_[2];
    Program line_program_, quartic_program_, count_program_;
    bool dirty_[tile_sums] = {};
};

CombinedPasses::CombinedPasses(const PassWorld& world)
    : w_(world),
      items_(world.mesh, world.max_width, world.max_height),
      taken_(GL_RGBA32F, world.shape.atlas->width(), world.shape.atlas->height()),
      footprint_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, 2),
      view_values_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, world.shape.terms()),
      view_slopes_(GL_RGBA32F, world.shape.grid.columns, world.shape.grid.rows, world.shape.terms()),
      footprint_target_({{&footprint_, 0}, {&footprint_, 1}}) {
    const int terms = w_.shape.terms();
    const Texture& drawn = w_.gathers.drawn();
    const auto per_tile = [&] { return Texture(GL_RGBA32F, drawn.width(), drawn.height(), 3); };
    product_ = per_tile();
    for (Texture& sum : sums_) sum = per_tile();
    for (int sum = 0; sum < tile_sums; ++sum)
        for (int corner = 0; corner < 3; ++corner) sum_targets_[sum].push_back(Framebuffer({{&sums_[sum], corner}}));
    product_target_ = Framebuffer({{&product_, 0}, {&product_, 1}, {&product_, 2}});
    product_error_target_ = Framebuffer(
        {{&product_, 0}, {&product_, 1}, {&product_, 2}, {&sums_[error], 0}, {&sums_[error], 1}, {&sums_[error], 2}});
    for (int corner = 0; corner < 3; ++corner) {
        line_targets_.push_back(Framebuffer({{&sums_[gauss_newton], corner}, {&sums_[curvature], corner}}));
        quartic_targets_.push_back(Framebuffer({{&sums_[gauss_newton], corner},
                                                {&sums_[curvature], corner},
                                                {&sums_[third], corner},
                                                {&sums_[fourth], corner}}));
    }
    for (int term = 0; term < terms; ++term) {
        value_targets_.push_back(Framebuffer({{&view_values_, term}}));
        slope_targets_.push_back(Framebuffer({{&view_slopes_, term}}));
    }

    const TriangleAtlas& atlas = *w_.shape.atlas;
    std::vector<uint32_t> of_tile(size_t(drawn.width()) * drawn.height() * 4);
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        const uint32_t rectangle = t / 2, columns = uint32_t(drawn.width());
        const size_t at = (2 * (rectangle / columns) + t % 2) * size_t(columns) + rectangle % columns;
        for (size_t c = 0; c < 3; ++c) of_tile[4 * at + c] = atlas.mesh().triangles[t][c];
    }
    tile_vertices_ = Texture(GL_RGBA32UI, drawn.width(), drawn.height());
    tile_vertices_.upload(GL_RGBA_INTEGER, GL_UNSIGNED_INT, of_tile.data());

    const Defines shape = w_.shape.defines(w_.storage);
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
    line_program_ = whole("combine/tile_line.frag", {});
    quartic_program_ = whole("combine/tile_line.frag", {{"QUARTIC", ""}});
    count_program_ = whole("combine/tile_line.frag", {{"COUNT", ""}});
    const int m = w_.shape.grid.view_side;
    for (int squares = 0; squares < 2; ++squares) {
        const Defines what = squares ? square : Defines{};
        gradient_program_[squares] = Program::draw("combine/map3.vert", "combine/gradient.frag", shape + what);
        scatter_program_[squares] = Program::draw("gather/scatter.vert", "gather/scatter.frag", shape + what);
        scatter_program_[squares].set2(6, float(w_.shape.grid.columns * m), float(w_.shape.grid.rows * m));
    }
    for (Program* program : {&direction_program_, &gradient_program_[0], &gradient_program_[1], &line_program_,
                             &quartic_program_, &count_program_})
        w_.mesh.set_layout(*program);
    for (Program* program : {&direction_program_, &gradient_program_[0], &gradient_program_[1], &line_program_,
                             &quartic_program_, &count_program_, &scatter_program_[0], &scatter_program_[1],
                             &tile_program_, &tile_error_program_, &tile_square_program_})
        program->set(9, w_.shape.grid.columns);
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
        if (dirty_[sum]) w_.gathers.rings(w_.run, sums_[sum], w_.problems.sum_target(sums[sum]), Gather::sum, true);
}

void CombinedPasses::begin_image(const ImageOnDevice& image, const Program& program) {
    SlsMesh::set_camera(program, *image.camera);
    program.set(11, image.target_scale);
    program.set(12, image.bits == 8 ? 257 : 1);
    w_.mesh.select(image.camera);
    items_.draw(*image.camera);
    ++w_.run.counters.draws;
    ++w_.run.counters.framebuffer_switches;
    w_.gathers.mark_tiles(w_.run);
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

void CombinedPasses::tile_pass(const ImageOnDevice& image, const Program& program,
                               const std::vector<Framebuffer>& targets) {
    items_.items().bind(0);
    image.texture->bind(1);
    w_.gathers.drawn().bind(8);
    w_.vertices.bind(9);
    tile_vertices_.bind(10);
    w_.run.blend();
    for (int corner = 0; corner < 3; ++corner) {
        program.set(8, corner);
        w_.run.bind(targets[size_t(corner)], program);
        w_.run.draw_whole();
    }
    w_.run.no_blend();
}

void CombinedPasses::count(const std::vector<ImageOnDevice>& images) {
    dirty_[target] = true;
    for (const ImageOnDevice& image : images) {
        begin_image(image, count_program_);
        tile_pass(image, count_program_, sum_targets_[target]);
    }
}

void CombinedPasses::ring_to_view(MapSums& sums, int term, bool squares) {
    w_.gathers.rings(w_.run, product_, w_.problems.ring_target, Gather::sum, false);
    w_.problems.ring.bind(7);
    footprint_.bind(10);
    w_.run.bind(sums.view_targets[size_t(term)], scatter_program_[squares]);
    w_.run.blend();
    w_.run.draw_quads(w_.shape.layout->problem_count());
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
        w_.gathers.drawn().bind(8);
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
        begin_image(image, direction_program_);
        look_up(x, value_targets_);
        items_.items().bind(0);
        image.texture->bind(1);
        x.surface().bind(2);
        view_values_.bind(5);
        w_.run.bind(direction_target_.front(), direction_program_);
        w_.run.blend_from(1, 4);
        w_.run.draw_tiles();
        w_.run.no_blend();
        taken_.bind(4);
        tile_vertices_.bind(10);
        w_.gathers.drawn().bind(8);
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
    const Program& program = quartic ? quartic_program_ : line_program_;
    for (const ImageOnDevice& image : images) {
        begin_image(image, program);
        look_up(x, value_targets_);
        look_up(d, slope_targets_);
        x.surface().bind(2);
        d.surface().bind(3);
        view_values_.bind(5);
        view_slopes_.bind(6);
        tile_pass(image, program, quartic ? quartic_targets_ : line_targets_);
    }
}

}  // namespace

std::unique_ptr<ImagePasses> make_combined_passes(const PassWorld& world) {
    return std::make_unique<CombinedPasses>(world);
}

}  // namespace radiafit
