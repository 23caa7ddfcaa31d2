#include <fmt/format.h>

#include <optional>

#include "base/error.h"
#include "gl/context.h"
#include "gl/texel_passes.h"

namespace radiafit {
namespace {

// Section 6.5's proposal: each fragment takes its pixels of a batch of images, and writes all sums at once.
class CombinedTexelPasses final : public TexelPasses {
public:
    explicit CombinedTexelPasses(const TexelWorld& world);
    int batch() const override { return texel_batch; }
    void count(const std::vector<ImageOnDevice>& images) override;
    void start(const std::vector<ImageOnDevice>& images, int group, int window, const TexelSumLayers& sums) override;
    void direction(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) override;
    void line(const std::vector<ImageOnDevice>& images, const TexelVector& x, const TexelVector& d) override;

private:
    void begin_images(const std::vector<ImageOnDevice>& images);
    void add(const std::vector<ImageOnDevice>& images, const Program& program, const Framebuffer& target);

    TexelWorld w_;
    std::optional<ItemBuffer> items_;  ///< with colours, a layer per image
    Framebuffer with_diagonal_;
    Program gradient_, gradient_and_diagonal_, line_, count_;
    std::vector<Program> start_;  ///< [window]
};

CombinedTexelPasses::CombinedTexelPasses(const TexelWorld& world) : w_(world) {
    const int targets_needed = w_.shape.maps() + w_.shape.diagonal_layers(),
              most = Context::current().limits().draw_buffers;
    if (targets_needed > most)
        throw UserError(
            fmt::format("the model {} has too many parameters for combined passes: they take {} render "
                        "targets, and this device has {}; choose --passes paper",
                        w_.shape.model->name, targets_needed, most));
    if (w_.mesh) items_.emplace(*w_.mesh, w_.max_width, w_.max_height, w_.bits, texel_batch);
    Defines here = w_.defines(texel_batch) + w_.colour();
    if (w_.mesh) here.push_back({"ITEMS", ""});
    const std::string tiles = w_.mesh ? "reflect/tiles.vert" : "common/whole.vert";
    const auto make = [&](const char* shader, const Defines& what) {
        Program program = Program::draw(tiles, std::string("reflect/") + shader, here + what);
        if (w_.mesh) w_.mesh->set_layout(program);
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

void CombinedTexelPasses::begin_images(const std::vector<ImageOnDevice>& images) {
    if (w_.mesh) {
        std::vector<const Camera*> cameras;
        for (const ImageOnDevice& image : images) cameras.push_back(image.camera);
        w_.mesh->select(cameras);
        for (size_t i = 0; i < images.size(); ++i) {
            images[i].texture->bind(1);
            w_.run.draw_items(*items_, *images[i].camera, int(i));
        }
        items_->items().bind(0);
    } else {
        for (int i = 0; i < texel_batch; ++i)
            images[std::min(size_t(i), images.size() - 1)].texture->bind(1 + unsigned(i));
    }
    w_.surface.bind(7);
}

void CombinedTexelPasses::add(const std::vector<ImageOnDevice>& images, const Program& program,
                              const Framebuffer& target) {
    w_.set_images(program, images, texel_batch);
    std::vector<float> cameras, pictures(4 * size_t(texel_batch), 0.0f);
    for (size_t i = 0; i < images.size() && w_.mesh; ++i) {
        const auto rows = SlsMesh::camera_rows(*images[i].camera);
        cameras.insert(cameras.end(), rows.begin(), rows.end());
        pictures[4 * i] = float(images[i].camera->width);
        pictures[4 * i + 1] = float(images[i].camera->height);
    }
    if (w_.mesh) {
        program.set4(24, int(cameras.size() / 4), cameras.data());
        program.set4(40, texel_batch, pictures.data());
    }
    w_.run.bind(target, program);
    w_.run.blend();
    w_.draw();
    w_.run.no_blend();
}

void CombinedTexelPasses::count(const std::vector<ImageOnDevice>& images) {
    begin_images(images);
    add(images, count_, w_.sums.count.all);
}

void CombinedTexelPasses::start(const std::vector<ImageOnDevice>& images, int group, int window,
                                const TexelSumLayers& sums) {
    begin_images(images);
    w_.set_shapes(start_[size_t(window)], group);
    add(images, start_[size_t(window)], sums.all);
}

void CombinedTexelPasses::direction(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) {
    begin_images(images);
    x.bind(5);
    if (diagonal)
        add(images, gradient_and_diagonal_, with_diagonal_);
    else
        add(images, gradient_, w_.sums.gradient.all);
}

void CombinedTexelPasses::line(const std::vector<ImageOnDevice>& images, const TexelVector& x, const TexelVector& d) {
    begin_images(images);
    x.bind(5);
    d.bind(6);
    add(images, line_, w_.sums.line.all);
}

}  // namespace

std::unique_ptr<TexelPasses> make_combined_texel_passes(const TexelWorld& world) {
    return std::make_unique<CombinedTexelPasses>(world);
}

}  // namespace radiafit
