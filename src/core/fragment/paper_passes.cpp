#include <bit>
#include <memory>

#include "fragment/image_passes.h"
#include "gl/context.h"

namespace radiafit {

MapSums::MapSums(const MapShape& shape, Sums sums)
    : surface_(sums_format(sums), shape.atlas->width(), shape.atlas->height(), shape.surface_layers()),
      view_(sums_format(sums), shape.grid.columns * shape.grid.view_side, shape.grid.rows * shape.grid.view_side,
            shape.terms()) {
    for (int layer = 0; layer < surface_.layers(); ++layer)
        surface_targets.push_back(Framebuffer({{&surface_, layer}}));
    for (int layer = 0; layer < view_.layers(); ++layer) view_targets.push_back(Framebuffer({{&view_, layer}}));
}

void MapSums::clear(PassRunner& run) const {
    for (const Framebuffer& target : surface_targets) run.clear(target);
    for (const Framebuffer& target : view_targets) run.clear(target);
}

void set_camera_centre(const Program& program, const Camera& camera) {
    const Vec3d camera_centre = camera.center();
    float parts[8] = {};
    for (int i = 0; i < 3; ++i) {
        // The upper 24 bits by masking: GCC 12 -O3 vectorizes a rounding to float and back away.
        const double upper = std::bit_cast<double>(std::bit_cast<uint64_t>(camera_centre[i]) & ~uint64_t(0x1fffffff));
        parts[i] = float(upper);
        parts[4 + i] = float(camera_centre[i] - upper);
    }
    program.set("camera_centre", parts);
}

namespace {

// Terms whose view maps' values, and slopes, fit into the varyings of gather/map.vert; of more, fragments fetch them.
int most_varying_terms() {
    constexpr int terms = 8, locations = 14 + terms;
    return Context::current().limits().varying_components >= 4 * locations ? terms : 0;
}

class PaperPasses final : public ImagePasses {
public:
    explicit PaperPasses(const PassResources& resources);
    void count(const std::vector<ImageOnDevice>& images) override;
    void gradient_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                       MapSums* squares) override;
    void directional_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                          bool quartic) override;

private:
    bool r300() const { return w_.passes == Passes::r300; }
    void begin_image(const ImageOnDevice& image, bool distribute);
    void look_up(const MapVector& x, const std::vector<Framebuffer>& targets);
    void keep(const ImageOnDevice& image);
    const Texture& taken_from(const ImageOnDevice& image) const {
        return kept_.empty() ? *image.texture : kept_[image.position];
    }
    void residuals(const ImageOnDevice& image, const Texture& texture, const Program& program);
    void gradient_of(const MapVector& x, MapSums& sums, bool squares);

    PassResources w_;
    ItemBuffer items_;
    Texture residual_, product_;         // [3 corners] in SLS: rgb, alpha 1 where a sample is
    std::vector<Texture> kept_;          // [image] in SLS: what each texel takes, if that is to stay
    Texture footprint_;                  // per vertex, in this image: weights of four view texels; the first of them
    Texture view_values_, view_slopes_;  // [terms] per vertex: h_k and dh_k in this image
    std::vector<Framebuffer> residual_targets_, product_targets_, value_targets_, slope_targets_;
    std::vector<Framebuffer> footprint_targets_;
    std::vector<Program> footprint_programs_;
    Program look_up_program_, target_program_, residual_program_, keep_program_;
    std::vector<const Program*> taking_programs_{&target_program_};  // that find the pixels of texels
    Program surface_program_[2], view_program_[2];                   // [1]: squares for diag(J'J)
    Program line_program_[4];
};

PaperPasses::PaperPasses(const PassResources& resources)
    : w_(resources),
      items_(resources.mesh, resources.max_width, resources.max_height),
      residual_(GL_RGBA32F, resources.shape.atlas->width(), resources.shape.atlas->height(), 3),
      product_(GL_RGBA32F, resources.shape.atlas->width(), resources.shape.atlas->height(), 3),
      footprint_(GL_RGBA32F, resources.shape.grid.columns, resources.shape.grid.rows, 2),
      view_values_(GL_RGBA32F, resources.shape.grid.columns, resources.shape.grid.rows, resources.shape.terms()),
      view_slopes_(GL_RGBA32F, resources.shape.grid.columns, resources.shape.grid.rows, resources.shape.terms()),
      footprint_targets_(result_targets({{&footprint_, 0}, {&footprint_, 1}}, r300())) {
    const int terms = w_.shape.terms();
    for (int corner = 0; corner < 3; ++corner) {
        residual_targets_.push_back(Framebuffer({{&residual_, corner}}));
        product_targets_.push_back(Framebuffer({{&product_, corner}}));
    }
    for (int term = 0; term < terms; ++term) {
        value_targets_.push_back(Framebuffer({{&view_values_, term}}));
        slope_targets_.push_back(Framebuffer({{&view_slopes_, term}}));
    }
    const Defines shape = w_.shape.defines(w_.storage);
    const Defines all{{"VALUES", std::to_string(!r300() && terms <= most_varying_terms() ? terms : 0)}},
        one{{"VALUES", r300() ? "0" : "1"}};
    const Defines nearest = w_.lookup == ViewLookup::nearest ? Defines{{"NEAREST", ""}} : Defines{};
    for (const Defines& which : result_defines(2, r300()))
        footprint_programs_.push_back(
            Program::draw("common/whole.vert", "gather/footprint.frag", shape + nearest + which));
    look_up_program_ = Program::draw("common/whole.vert", "gather/look_up.frag", shape);
    target_program_ = Program::draw("gather/map.vert", "gather/residual.frag",
                                    shape + Defines{{"TARGET_ONLY", ""}, {"PROJECTED", ""}});
    const bool keep = w_.kept_images > 0;
    residual_program_ = Program::draw("gather/map.vert", "gather/residual.frag",
                                      shape + all + Defines{{keep ? "CACHED" : "PROJECTED", ""}});
    if (keep) {
        keep_program_ = Program::draw("distribute/tile.vert", "distribute/keep.frag",
                                      w_.mesh.defines() + Defines{{"PROJECTED", ""}});
        w_.mesh.set_layout(keep_program_);
        taking_programs_.push_back(&keep_program_);
        for (size_t i = 0; i < w_.kept_images; ++i)
            kept_.emplace_back(w_.bits == 8 ? GL_RGBA8UI : GL_RGBA16UI, w_.shape.atlas->width(),
                               w_.shape.atlas->height());
    } else {
        taking_programs_.push_back(&residual_program_);
    }
    for (int squares = 0; squares < 2; ++squares) {
        const Defines what = shape + (squares ? Defines{{"DIAGONAL", ""}} : Defines{});
        surface_program_[squares] = Program::draw("gather/map.vert", "gather/surface_gradient.frag", what + one);
        view_program_[squares] =
            r300() ? Program::draw("common/whole.vert", "gather/scatter.frag", what + Defines{{"GATHERED", ""}})
                   : Program::draw("gather/scatter.vert", "gather/scatter.frag", what);
        const int m = w_.shape.grid.view_side;
        view_program_[squares].set_if_used("layout_size", float(w_.shape.grid.columns * m),
                                           float(w_.shape.grid.rows * m));
        view_program_[squares].bind("ring_sums", w_.problems.ring);
        view_program_[squares].bind("footprints", footprint_);
    }
    for (int quantity = 0; quantity < 4; ++quantity)
        line_program_[quantity] =
            Program::draw("gather/map.vert", "gather/line_term.frag",
                          shape + all + Defines{{"ALONG", ""}, {"QUANTITY", std::to_string(quantity)}});
    for (Program* program : {&target_program_, &residual_program_, &surface_program_[0], &surface_program_[1],
                             &line_program_[0], &line_program_[1], &line_program_[2], &line_program_[3]}) {
        w_.mesh.set_layout(*program);
        program->set_if_used("term", 0);  // but for the surface gradient's
        program->bind_if_used("view_values", view_values_);
        program->bind_if_used("view_slopes", view_slopes_);
        program->bind_if_used("residuals", residual_);
    }
    for (const Program& program : footprint_programs_) program.bind("vertex_frames", w_.vertices);
    look_up_program_.bind("footprints", footprint_);
    for (const Program* program : taking_programs_) program->bind("items", items_.items());
}

void PaperPasses::begin_image(const ImageOnDevice& image, bool distribute) {
    w_.mesh.select({{image.camera}});
    if (distribute) {
        for (const Program* program : taking_programs_) SlsMesh::set_camera(*program, *image.camera);
        w_.run.draw_items(items_, *image.camera);
    }
    for (size_t i = 0; i < footprint_programs_.size(); ++i) {
        set_camera_centre(footprint_programs_[i], *image.camera);
        w_.run.draw_whole(footprint_targets_[i], footprint_programs_[i]);
    }
    w_.gathers.mark_tiles(w_.mesh);
}

// h_k of every vertex, one pass per term.
void PaperPasses::look_up(const MapVector& x, const std::vector<Framebuffer>& targets) {
    look_up_program_.bind("view_maps", x.view());
    for (int term = 0; term < w_.shape.terms(); ++term) {
        look_up_program_.set("term", term);
        w_.run.draw_whole(targets[size_t(term)], look_up_program_);
    }
}

void PaperPasses::keep(const ImageOnDevice& image) {
    const Framebuffer target({{&kept_[image.position]}});
    w_.run.clear(target);
    keep_program_.bind("image", *image.texture);
    w_.run.draw_tiles(target, keep_program_);
}

// texture: the image, or what was kept of it.
void PaperPasses::residuals(const ImageOnDevice& image, const Texture& texture, const Program& program) {
    program.bind("image", texture);
    program.set("target_scale", image.target_scale);
    program.set("to_16_bit", image.bits == 8 ? 257 : 1);
    for (int corner = 0; corner < 3; ++corner) {
        program.set("corner", corner);
        w_.run.draw_tiles(residual_targets_[size_t(corner)], program);
    }
}

void PaperPasses::count(const std::vector<ImageOnDevice>& images) {
    for (const ImageOnDevice& image : images) {
        begin_image(image, true);
        if (!kept_.empty()) keep(image);
        residuals(image, *image.texture, target_program_);
        for (int corner = 0; corner < 3; ++corner) w_.gathers.tiles(w_.run, residual_, corner, Gather::sum);
        w_.gathers.rings(w_.run, w_.gathers.tile_sums(), w_.problems.sum_target(Sum::target), Gather::sum, true);
    }
}

// Figure 5: surface maps by blending, view maps by gathers and a scatter of one value per vertex, or of r300 another
// gather.
void PaperPasses::gradient_of(const MapVector& x, MapSums& sums, bool squares) {
    const int terms = w_.shape.terms();
    const Program& surface = surface_program_[squares];
    const Program& view = view_program_[squares];
    for (int term = 0; term < terms; ++term) {
        surface.set("term", term);
        w_.run.blend();
        for (int corner = 0; corner < 3; ++corner) {
            surface.set("corner", corner);
            w_.run.draw_tiles(sums.surface_targets[size_t(corner * terms + term)], surface);
        }
        w_.run.no_blend();
        for (int corner = 0; corner < 3; ++corner)
            w_.gathers.tile_products(w_.run, residual_, x.surface(), corner, term, squares);
        w_.gathers.rings(w_.run, w_.gathers.tile_sums(), w_.problems.ring_target, Gather::sum, false);
        w_.run.blend();
        const Framebuffer& view_target = sums.view_targets[size_t(term)];
        if (r300())
            w_.run.draw_whole(view_target, view);
        else
            w_.run.draw_points(view_target, view, w_.shape.layout->problem_count());
        w_.run.no_blend();
    }
}

void PaperPasses::gradient_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                                MapSums* squares) {
    for (const ImageOnDevice& image : images) {
        begin_image(image, kept_.empty());
        look_up(x, value_targets_);
        residual_program_.bind("surface_maps", x.surface());
        residuals(image, taken_from(image), residual_program_);
        for (int corner = 0; corner < 3; ++corner) w_.gathers.tiles(w_.run, residual_, corner, Gather::squares);
        w_.gathers.rings(w_.run, w_.gathers.tile_sums(), w_.problems.sum_target(Sum::residual), Gather::sum, true);
        gradient_of(x, gradient, false);
        if (squares) gradient_of(x, *squares, true);
    }
}

void PaperPasses::directional_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                                   bool quartic) {
    constexpr Sum sums[4] = {Sum::gauss_newton, Sum::curvature, Sum::third, Sum::fourth};
    for (const ImageOnDevice& image : images) {
        begin_image(image, kept_.empty());
        look_up(x, value_targets_);
        look_up(d, slope_targets_);
        residual_program_.bind("surface_maps", x.surface());
        residuals(image, taken_from(image), residual_program_);
        for (int quantity = 0; quantity < (quartic ? 4 : 2); ++quantity) {
            const Program& program = line_program_[quantity];
            program.bind_if_used("surface_maps", x.surface());
            program.bind("surface_direction", d.surface());
            for (int corner = 0; corner < 3; ++corner) {
                program.set("corner", corner);
                w_.run.draw_tiles(product_targets_[size_t(corner)], program);
                w_.gathers.tiles(w_.run, product_, corner, Gather::sum);
            }
            const auto add = [&](Sum sum) {
                w_.gathers.rings(w_.run, w_.gathers.tile_sums(), w_.problems.sum_target(sum), Gather::sum, true);
            };
            add(sums[quantity]);
            if (quantity == 0) add(Sum::curvature);  // a^2, to which the next quantity adds 2 r b
        }
    }
}

}  // namespace

std::unique_ptr<ImagePasses> make_paper_passes(const PassResources& resources) {
    return std::make_unique<PaperPasses>(resources);
}

}  // namespace radiafit
