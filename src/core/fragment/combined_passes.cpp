#include <algorithm>
#include <functional>

#include "fragment/image_passes.h"
#include "gl/context.h"

namespace radiafit {
namespace {

constexpr int most_batch = 4;

// Section 6.5's proposal: several render targets a pass and longer programs. One pass into SLS keeps the colours and
// blends the gradients of all corners; one fragment per tile then loops over the tile's texels; what need not be kept
// apart by image is summed per tile over the whole sweep and gathered over the rings once, at its end.
class CombinedPasses final : public ImagePasses {
public:
    explicit CombinedPasses(const PassResources& resources);
    int batch() const override { return batch_; }
    void count(const std::vector<ImageOnDevice>& images) override;
    void gradient_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                       MapSums* squares) override;
    void directional_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                          bool quartic) override;
    void begin_sweep(MapSums* gradient, MapSums* squares) override;
    void end_sweep() override;

private:
    // Per tile sums over a sweep, [3 corners] in the order of TilePlaces.
    enum TileSum { error, gauss_newton, curvature, third, fourth, target, tile_sums };
    /// A pass of tile sums over some corners, as many as 8 render targets allow.
    struct TilePass {
        Program program;
        Framebuffer target;
        unsigned first_blended, targets;  ///< targets [first_blended, targets) are blended over batches
    };
    /// What every vertex has in one image of the batch.
    struct InImage {
        Texture footprint;  ///< weights of four view texels; the first of them
        Texture product;    ///< per tile and corner: sum of r g_k in this image
        Framebuffer footprint_target;
        std::vector<Framebuffer> value_targets, slope_targets;  ///< [term], layers of the batch's textures
    };
    std::vector<TilePass> line_passes(const std::vector<TileSum>& sums, const Defines& defines);
    std::vector<TilePass> gradient_passes(bool with_error, const Defines& defines);
    std::vector<TilePass> tile_passes(size_t per_corner, const std::string& shader, const Defines& defines,
                                      const std::function<unsigned(int, int, std::vector<Target>&)>& targets);
    void begin_images(const std::vector<ImageOnDevice>& images, const std::vector<const Program*>& programs);
    void look_up(size_t images, const MapVector& x, std::vector<Framebuffer> InImage::*targets);
    void further_terms(size_t images, const std::vector<Framebuffer>& targets, MapSums& sums, bool squares,
                       int first_term);
    void ring_to_view(size_t images, MapSums& sums, int term, bool squares);
    void draw_tiles(const std::vector<TilePass>& passes, int term = 0);

    PassResources w_;
    int batch_;
    ItemBuffer items_;                   // with colours, a layer per image
    Texture taken_;                      // in SLS: the colours that each texel takes in the images of the batch
    Texture view_values_, view_slopes_;  // [image][term] per vertex: h_k and dh_k
    std::vector<InImage> in_image_;      // [image]
    Texture sums_[tile_sums];
    Texture tile_vertices_;
    std::vector<Framebuffer> sum_targets_[tile_sums];
    std::vector<TilePass> line_passes_, quartic_passes_, count_passes_, error_passes_, product_passes_[2];
    std::vector<Framebuffer> direction_target_, term_targets_, square_targets_;              // [term]
    Program footprint_program_, look_up_program_, direction_program_, gradient_program_[2];  // [1]: squares
    Program scatter_program_[2];
    std::vector<const Program*> direction_programs_, line_programs_;  ///< line_programs_: those of count(), too
    bool dirty_[tile_sums] = {};
};

GLenum colours_format(int parts) { return parts == 1 ? GL_R32UI : parts == 2 ? GL_RG32UI : GL_RGBA32UI; }

CombinedPasses::CombinedPasses(const PassResources& resources)
    : w_(resources),
      batch_(combined_batch(resources.shape.terms(), resources.bits, Context::current().limits().varying_components,
                            resources.images_per_pass)),
      items_(resources.mesh, resources.max_width, resources.max_height, resources.bits, batch_),
      taken_(colours_format(batch_ * resources.bits / 8), resources.shape.atlas->width(),
             resources.shape.atlas->height()),
      view_values_(GL_RGBA32F, resources.shape.grid.columns, resources.shape.grid.rows,
                   batch_ * resources.shape.terms()),
      view_slopes_(GL_RGBA32F, resources.shape.grid.columns, resources.shape.grid.rows,
                   batch_ * resources.shape.terms()) {
    const int terms = w_.shape.terms();
    const TilePlaces& places = w_.gathers.marks().places();
    const auto per_tile = [&](GLenum format) { return Texture(format, places.columns, places.rows, 3); };
    for (int sum = 0; sum < tile_sums; ++sum)
        sums_[sum] = per_tile(sum == target ? GLenum(GL_RGBA32F) : sums_format(w_.sums));
    for (int sum = 0; sum < tile_sums; ++sum)
        for (int corner = 0; corner < 3; ++corner) sum_targets_[sum].push_back(Framebuffer({{&sums_[sum], corner}}));
    in_image_.resize(size_t(batch_));
    for (int i = 0; i < batch_; ++i) {
        InImage& image = in_image_[size_t(i)];
        image.footprint = Texture(GL_RGBA32F, w_.shape.grid.columns, w_.shape.grid.rows, 2);
        image.footprint_target = Framebuffer({{&image.footprint, 0}, {&image.footprint, 1}});
        image.product = per_tile(GL_RGBA32F);
        for (int term = 0; term < terms; ++term) {
            image.value_targets.push_back(Framebuffer({{&view_values_, i * terms + term}}));
            image.slope_targets.push_back(Framebuffer({{&view_slopes_, i * terms + term}}));
        }
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

    const Defines maps = w_.shape.defines(w_.storage);
    const Defines shape = maps + Defines{{"COLOUR", std::to_string(w_.bits)}, {"BATCH", std::to_string(batch_)}};
    const Defines nearest = w_.lookup == ViewLookup::nearest ? Defines{{"NEAREST", ""}} : Defines{};
    const Defines square{{"DIAGONAL", ""}}, projected{{"PROJECTED", ""}};
    footprint_program_ = Program::draw("common/whole.vert", "gather/footprint.frag", maps + nearest);
    look_up_program_ = Program::draw("common/whole.vert", "gather/look_up.frag", maps);
    direction_program_ = Program::draw("combine/map3.vert", "combine/direction.frag", shape + projected);
    line_passes_ = line_passes({gauss_newton, curvature}, shape);
    quartic_passes_ = line_passes({gauss_newton, curvature, third, fourth}, shape + Defines{{"QUARTIC", ""}});
    count_passes_ = line_passes({target}, shape + Defines{{"COUNT", ""}});
    error_passes_ = gradient_passes(true, shape + Defines{{"WITH_ERROR", ""}});
    const int m = w_.shape.grid.view_side;
    for (int squares = 0; squares < 2; ++squares) {
        const Defines what = squares ? shape + square : shape;
        product_passes_[squares] = gradient_passes(false, what);
        gradient_program_[squares] = Program::draw("combine/map3.vert", "combine/gradient.frag", what);
        scatter_program_[squares] =
            Program::draw("gather/scatter.vert", "gather/scatter.frag", squares ? maps + square : maps);
        scatter_program_[squares].set("layout_size", float(w_.shape.grid.columns * m), float(w_.shape.grid.rows * m));
        scatter_program_[squares].bind("ring_sums", w_.problems.ring);
    }
    footprint_program_.bind("vertex_frames", w_.vertices);
    for (Program* program : {&direction_program_, &gradient_program_[0], &gradient_program_[1]}) {
        w_.mesh.set_layout(*program);
        direction_programs_.push_back(program);
    }
    const auto list = [](std::vector<const Program*>& programs, const std::vector<TilePass>& passes) {
        for (const TilePass& pass : passes) programs.push_back(&pass.program);
    };
    for (const auto* passes : {&error_passes_, &product_passes_[0], &product_passes_[1]})
        list(direction_programs_, *passes);
    for (const auto* passes : {&count_passes_, &line_passes_, &quartic_passes_}) list(line_programs_, *passes);
    for (const auto* programs : {&direction_programs_, &line_programs_})
        for (const Program* program : *programs) {
            program->bind_if_used("items", items_.items());
            program->bind_if_used("colours", taken_);
            program->bind_if_used("view_values", view_values_);
            program->bind_if_used("view_slopes", view_slopes_);
            program->bind_if_used("tile_vertices", tile_vertices_);
            program->bind_if_used("vertex_frames", w_.vertices);
        }
}

// targets(first corner, corners, list): fills the list, returns how many are not blended.
std::vector<CombinedPasses::TilePass> CombinedPasses::tile_passes(
    size_t per_corner, const std::string& shader, const Defines& defines,
    const std::function<unsigned(int, int, std::vector<Target>&)>& targets) {
    std::vector<TilePass> passes;
    const int most = std::min(3, 8 / int(per_corner));
    for (int first = 0; first < 3; first += most) {
        const int corners = std::min(most, 3 - first);
        std::vector<Target> list;
        const unsigned first_blended = targets(first, corners, list);
        const Defines which{{"FIRST", std::to_string(first)}, {"CORNERS", std::to_string(corners)}};
        passes.push_back({Program::draw("common/whole.vert", shader, defines + which), Framebuffer(list), first_blended,
                          unsigned(list.size())});
    }
    return passes;
}

std::vector<CombinedPasses::TilePass> CombinedPasses::line_passes(const std::vector<TileSum>& sums,
                                                                  const Defines& defines) {
    return tile_passes(sums.size(), "combine/tile_line.frag", defines,
                       [&](int first, int corners, std::vector<Target>& list) {
                           for (TileSum sum : sums)
                               for (int c = first; c < first + corners; ++c) list.push_back({&sums_[sum], c});
                           return 0u;
                       });
}

std::vector<CombinedPasses::TilePass> CombinedPasses::gradient_passes(bool with_error, const Defines& defines) {
    return tile_passes(size_t(batch_) + with_error, "combine/tile_direction.frag", defines,
                       [&](int first, int corners, std::vector<Target>& list) {
                           for (const InImage& image : in_image_)
                               for (int c = first; c < first + corners; ++c) list.push_back({&image.product, c});
                           const auto first_blended = unsigned(list.size());
                           if (with_error)
                               for (int c = first; c < first + corners; ++c) list.push_back({&sums_[error], c});
                           return first_blended;
                       });
}

void CombinedPasses::begin_sweep(MapSums* gradient, MapSums* squares) {
    for (int sum = 0; sum < tile_sums; ++sum) {
        for (Framebuffer& target : sum_targets_[sum]) w_.run.clear(target);
        dirty_[sum] = false;
    }
    const int terms = w_.shape.terms();
    const auto three = [&](MapSums& sums, int term) {
        return std::vector<Target>{
            {&sums.surface(), term}, {&sums.surface(), terms + term}, {&sums.surface(), 2 * terms + term}};
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

void CombinedPasses::begin_images(const std::vector<ImageOnDevice>& images,
                                  const std::vector<const Program*>& programs) {
    std::array<float, 12 * most_batch> cameras{};
    std::array<float, 4 * most_batch> extents{};
    std::array<const Camera*, most_batch> eyes;
    for (size_t i = 0; i < images.size(); ++i) {
        const Camera& camera = *(eyes[i] = images[i].camera);
        std::ranges::copy(SlsMesh::camera_rows(camera), &cameras[12 * i]);
        std::ranges::copy(std::array{float(camera.width), float(camera.height), images[i].target_scale},
                          &extents[4 * i]);
    }
    for (const Program* program : programs) {
        program->set_if_used("cameras", std::span<const float>(cameras).first(12 * size_t(batch_)));
        program->set_if_used("image_extents", std::span<const float>(extents).first(4 * size_t(batch_)));
    }
    w_.mesh.select(std::span(eyes).first(images.size()));
    w_.gathers.mark_tiles(w_.mesh);
    for (size_t i = 0; i < images.size(); ++i) {
        items_.program().bind("image", *images[i].texture);
        w_.run.draw_items(items_, *images[i].camera, int(i));
    }
    for (size_t i = 0; i < images.size(); ++i) {
        set_camera_centre(footprint_program_, *images[i].camera);
        w_.run.draw_whole(in_image_[i].footprint_target, footprint_program_);
    }
}

void CombinedPasses::look_up(size_t images, const MapVector& x, std::vector<Framebuffer> InImage::*targets) {
    look_up_program_.bind("view_maps", x.view());
    for (size_t i = 0; i < images; ++i) {
        look_up_program_.bind("footprints", in_image_[i].footprint);
        for (int term = 0; term < w_.shape.terms(); ++term) {
            look_up_program_.set("term", term);
            w_.run.draw_whole((in_image_[i].*targets)[size_t(term)], look_up_program_);
        }
    }
}

void CombinedPasses::draw_tiles(const std::vector<TilePass>& passes, int term) {
    for (const TilePass& pass : passes) {
        pass.program.bind("drawn", w_.gathers.marks().texture());
        pass.program.set_if_used("term", term);
        w_.run.blend_from(pass.first_blended, pass.targets);
        w_.run.draw_whole(pass.target, pass.program, w_.run.tile_texels());
        w_.run.no_blend();
    }
}

void CombinedPasses::count(const std::vector<ImageOnDevice>& images) {
    dirty_[target] = true;
    begin_images(images, line_programs_);
    draw_tiles(count_passes_);
}

void CombinedPasses::ring_to_view(size_t images, MapSums& sums, int term, bool squares) {
    for (size_t i = 0; i < images; ++i) {
        w_.gathers.rings(w_.run, in_image_[i].product, w_.problems.ring_target, Gather::sum, false);
        scatter_program_[squares].bind("footprints", in_image_[i].footprint);
        w_.run.blend();
        w_.run.draw_points(sums.view_targets[size_t(term)], scatter_program_[squares],
                           w_.shape.layout->problem_count());
        w_.run.no_blend();
    }
}

void CombinedPasses::further_terms(size_t images, const std::vector<Framebuffer>& targets, MapSums& sums, bool squares,
                                   int first_term) {
    const Program& surface = gradient_program_[squares];
    for (int term = first_term; term < w_.shape.terms(); ++term) {
        surface.set("term", term);
        w_.run.blend();
        w_.run.draw_tiles(targets[size_t(term)], surface);
        w_.run.no_blend();
        draw_tiles(product_passes_[squares], term);
        ring_to_view(images, sums, term, squares);
    }
}

void CombinedPasses::gradient_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                                   MapSums* squares) {
    dirty_[error] = true;
    for (const Program* program : direction_programs_) program->bind_if_used("surface_maps", x.surface());
    begin_images(images, direction_programs_);
    look_up(images.size(), x, &InImage::value_targets);
    w_.run.blend_from(1, 4);
    w_.run.draw_tiles(direction_target_.front(), direction_program_);
    w_.run.no_blend();
    draw_tiles(error_passes_);
    ring_to_view(images.size(), gradient, 0, false);
    further_terms(images.size(), term_targets_, gradient, false, 1);
    if (squares) further_terms(images.size(), square_targets_, *squares, true, 0);
}

void CombinedPasses::directional_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                                      bool quartic) {
    dirty_[gauss_newton] = dirty_[curvature] = true;
    dirty_[third] = dirty_[fourth] = quartic;
    const std::vector<TilePass>& passes = quartic ? quartic_passes_ : line_passes_;
    begin_images(images, line_programs_);
    look_up(images.size(), x, &InImage::value_targets);
    look_up(images.size(), d, &InImage::slope_targets);
    for (const TilePass& pass : passes) {
        pass.program.bind("surface_maps", x.surface());
        pass.program.bind("surface_direction", d.surface());
    }
    draw_tiles(passes);
}

}  // namespace

// As many images as one RGBA32UI texel holds the colours of, and as varyings have room for: each image takes those of
// the corners and their values in map3.vert.
int combined_batch(int terms, int bits, int varying_components, int images_per_pass) {
    const int locations = std::min(31, varying_components / 4);
    const int most = std::clamp((locations - 1) / (3 * (terms + 1)), 1, bits == 8 ? most_batch : 2);
    return images_per_pass > 0 ? std::min(images_per_pass, most) : most;
}

std::unique_ptr<ImagePasses> make_combined_passes(const PassResources& resources) {
    return std::make_unique<CombinedPasses>(resources);
}

}  // namespace radiafit
