#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/wording.h"
#include "fragment/texel_passes.h"
#include "gl/context.h"

namespace radiafit {
namespace {

// Section 6.5's proposal: a fragment loops over the pixels that its texel takes, and writes all sums at once. Over a
// grid these are in a stack of images; over a mesh a pass for each image leaves them in a layer, until there is no
// more room.
class CombinedTexelPasses final : public TexelPasses {
public:
    CombinedTexelPasses(const TexelPassResources& resources, int images_per_pass);
    int batch() const override { return w_.mesh ? 1 : room_; }
    void count(const std::vector<ImageOnDevice>& images) override;
    void start(const std::vector<ImageOnDevice>& images, int group, int window, const TexelSumLayers& sums) override;
    void gradient_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) override;
    void directional_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x,
                          const TexelVector& d) override;
    void finish() override;

private:
    void take(const ImageOnDevice& image, int layer);
    void add(const std::vector<ImageOnDevice>& images, const Program& program, const Framebuffer& target);
    void sum();

    TexelPassResources w_;
    int room_;  ///< images that one loop may take
    Buffer numbers_;
    Texture views_;  ///< of numbers_: three texels a view, in the order of sweeps
    std::optional<ItemBuffer> items_;
    Texture taken_;  ///< over a mesh: words of colour in SLS, a layer per image
    std::vector<Framebuffer> layers_;
    Program take_;
    Framebuffer with_diagonal_;
    Program gradient_, gradient_and_diagonal_, line_, count_;
    std::vector<Program> start_;  ///< [window]
    /// What sum() adds up.
    struct {
        const Program* program = nullptr;
        const Framebuffer* target = nullptr;
        size_t first = 0;
        int images = 0;
    } waiting_;
};

CombinedTexelPasses::CombinedTexelPasses(const TexelPassResources& resources, int images_per_pass)
    : w_(resources),
      room_(combined_texel_images(*w_.shape.atlas, w_.images.views().size(), w_.images.bits(), images_per_pass)) {
    const int targets_needed = w_.shape.maps() + w_.shape.diagonal_layers(),
              most = Context::current().limits().draw_buffers;
    if (targets_needed > most)
        throw UserError(
            fmt::format("the model {} has too many parameters for combined passes: they take {} render "
                        "targets, and this device has {}; choose {} paper",
                        w_.shape.model->name, targets_needed, most, option_name("passes")));
    std::vector<float> numbers;
    for (const uint32_t view : w_.images.views())
        for (const float number : w_.numbers_of(w_.dataset.views[view])) numbers.push_back(number);
    numbers_ = Buffer(numbers);
    views_ = Texture::of_buffer(GL_RGBA32F, numbers_);
    bool one_camera = !numbers.empty();
    for (size_t at = 0; at < numbers.size(); at += 12)
        one_camera = one_camera && std::equal(numbers.begin() + 8, numbers.begin() + 12, numbers.data() + at + 8);

    if (w_.mesh) {
        const auto [width, height] = w_.images.largest();
        items_.emplace(*w_.mesh, width, height);
        taken_ = Texture(w_.images.bits() == 8 ? GL_R32UI : GL_RG32UI, w_.shape.width(), w_.shape.height(), room_);
        for (int layer = 0; layer < room_; ++layer) layers_.push_back(Framebuffer({{&taken_, layer}}));
        take_ = Program::draw("distribute/tile.vert", "reflect/take.frag",
                              w_.mesh->defines() + w_.colour() + Defines{{"PROJECTED", ""}});
        w_.mesh->set_layout(take_);
        take_.bind("items", items_->items());
    }
    Defines here = w_.shape.defines(w_.storage) + w_.colour();
    if (!w_.mesh) here.push_back({"GRID", ""});
    if (one_camera) here.push_back({"ONE_CAMERA", ""});
    const auto make = [&](const char* shader, const Defines& what) {
        Program program = Program::draw("common/whole.vert", std::string("reflect/") + shader, here + what);
        if (one_camera) program.set("camera_centre", std::span<const float>(numbers).subspan(8, 4));
        program.bind("views", views_);
        program.bind("surface", w_.surface);
        if (w_.mesh)
            program.bind("taken", taken_);
        else
            w_.set_stack(program, room_);
        return program;
    };
    gradient_ = make("direction.frag", {});
    std::vector<Target> targets = w_.sums.gradient.targets();
    for (const Target& target : w_.sums.diagonal.targets()) targets.push_back(target);
    with_diagonal_ = Framebuffer(targets);
    gradient_and_diagonal_ = make("direction.frag", {{"DIAGONAL", ""}});
    line_ = make("line.frag", {});
    count_ = make("count.frag", {});
    const StartLayout layout(*w_.shape.model);
    for (int window = 0; window < layout.windows(); ++window)
        start_.push_back(make("start.frag", {{"CANDIDATES", std::to_string(layout.candidates)},
                                             {"FIRST", std::to_string(4 * window * StartLayout::most_targets)},
                                             {"RESULTS", std::to_string(layout.targets_in(window))}}));
}

void CombinedTexelPasses::take(const ImageOnDevice& image, int layer) {
    SlsMesh::set_camera(take_, *image.camera);
    w_.mesh->select({{image.camera}});
    w_.run.draw_items(*items_, *image.camera);
    take_.bind("image", *image.texture);
    w_.run.clear(layers_[size_t(layer)]);
    w_.run.draw_tiles(layers_[size_t(layer)], take_);
}

void CombinedTexelPasses::add(const std::vector<ImageOnDevice>& images, const Program& program,
                              const Framebuffer& target) {
    if (waiting_.images == 0) waiting_ = {&program, &target, images[0].position, 0};
    if (!w_.mesh) {
        program.bind("images", *images[0].texture);
        waiting_.images = int(images.size());
        return sum();
    }
    for (const ImageOnDevice& image : images) {
        take(image, waiting_.images);
        if (++waiting_.images == room_) sum();
    }
}

void CombinedTexelPasses::sum() {
    waiting_.program->set("first_view", int(waiting_.first));
    waiting_.program->set("image_count", waiting_.images);
    w_.run.blend();
    w_.run.draw_whole(*waiting_.target, *waiting_.program,
                      uint64_t(w_.shape.width()) * uint64_t(w_.shape.height()) * uint64_t(waiting_.images));
    w_.run.no_blend();
    waiting_.images = 0;
}

void CombinedTexelPasses::finish() {
    if (waiting_.images > 0) sum();
}

void CombinedTexelPasses::count(const std::vector<ImageOnDevice>& images) { add(images, count_, w_.sums.count.all); }

void CombinedTexelPasses::start(const std::vector<ImageOnDevice>& images, int group, int window,
                                const TexelSumLayers& sums) {
    w_.set_shapes(start_[size_t(window)], group);
    add(images, start_[size_t(window)], sums.all);
}

void CombinedTexelPasses::gradient_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) {
    const Program& program = diagonal ? gradient_and_diagonal_ : gradient_;
    program.bind("parameters", x.maps());
    add(images, program, diagonal ? with_diagonal_ : w_.sums.gradient.all);
}

void CombinedTexelPasses::directional_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x,
                                           const TexelVector& d) {
    line_.bind_if_used("parameters", x.maps());
    line_.bind("direction", d.maps());
    add(images, line_, w_.sums.line.all);
}

}  // namespace

int combined_texel_images(const Atlas& atlas, size_t views, int bits, int images_per_pass) {
    // What devices have: texels of a buffer texture, layers of an array.
    constexpr uint64_t budget = uint64_t(256) << 20, most_texels = uint64_t(1) << 27, most_layers = 2048;
    const bool grid = dynamic_cast<const GridAtlas*>(&atlas) != nullptr;
    const uint64_t bytes = ImageStack::bytes(atlas.width(), atlas.height(), bits),
                   fit = std::max<uint64_t>(4, budget / bytes),
                   limit = grid ? most_texels / (bytes / uint64_t(bits / 2)) : most_layers,
                   most = std::max<uint64_t>(1, std::min(limit, images_per_pass > 0 ? uint64_t(images_per_pass) : fit)),
                   all = std::max<size_t>(1, views), loops = (all + most - 1) / most;
    return int((all + loops - 1) / loops);
}

std::unique_ptr<TexelPasses> make_combined_texel_passes(const TexelPassResources& resources, int images_per_pass) {
    return std::make_unique<CombinedTexelPasses>(resources, images_per_pass);
}

}  // namespace radiafit
