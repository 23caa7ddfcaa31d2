#include <algorithm>
#include <optional>

#include "fragment/texel_passes.h"

namespace radiafit {
namespace {

class PaperTexelPasses final : public TexelPasses {
public:
    explicit PaperTexelPasses(const TexelPassResources& resources);
    int batch() const override { return 1; }
    void count(const std::vector<ImageOnDevice>& images) override;
    void start(const std::vector<ImageOnDevice>& images, int group, int window, const TexelSumLayers& sums) override;
    void gradient_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) override;
    void directional_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x,
                          const TexelVector& d) override;

private:
    void keep(const ImageOnDevice& image, const Program& program);
    void add(const Program& program, const Framebuffer& target);
    void draw(const Framebuffer& target, const Program& program) {
        w_.mesh ? w_.run.draw_tiles(target, program) : w_.run.draw_whole(target, program);
    }

    TexelPassResources w_;
    std::optional<ItemBuffer> items_;
    Texture kept_;  ///< in SLS: residual or target of the image at hand; alpha 1 where a sample is
    Framebuffer kept_target_;
    Program target_, residual_;
    std::vector<Program> gradient_, diagonal_, start_, count_;  ///< a pass each
    Program line_;
    std::vector<const Program*> all_;
};

PaperTexelPasses::PaperTexelPasses(const TexelPassResources& resources)
    : w_(resources), kept_(GL_RGBA32F, resources.shape.width(), resources.shape.height()), kept_target_({{&kept_}}) {
    const auto [width, height] = w_.images.largest();
    if (w_.mesh) items_.emplace(*w_.mesh, width, height);
    const Defines here = w_.shape.defines(w_.storage) + (w_.mesh ? w_.mesh->defines() : Defines{{"GRID", ""}}),
                  kept = here + Defines{{"KEPT", ""}}, diagonal{{"DIAGONAL", ""}};
    const std::string tiles = w_.mesh ? "distribute/tile.vert" : "common/whole.vert";
    const auto only = [](int i) { return Defines{{"ONLY", std::to_string(i)}}; };
    const Defines projected = w_.mesh ? Defines{{"PROJECTED", ""}} : w_.colour();
    target_ = Program::draw(tiles, "reflect/residual.frag", here + projected + Defines{{"TARGET_ONLY", ""}});
    residual_ = Program::draw(tiles, "reflect/residual.frag", here + projected);
    for (int map = 0; map < w_.shape.maps(); ++map)
        gradient_.push_back(Program::draw(tiles, "reflect/direction.frag", kept + only(map)));
    for (int layer = 0; layer < w_.shape.diagonal_layers(); ++layer)
        diagonal_.push_back(
            Program::draw(tiles, "reflect/direction.frag", kept + diagonal + only(w_.shape.maps() + layer)));
    for (int layer = 0; layer < 2; ++layer)
        count_.push_back(Program::draw(tiles, "reflect/count.frag", kept + only(layer)));
    const StartLayout layout(*w_.shape.model);
    for (int target = 0; target < layout.targets(); ++target) {
        const Defines which{
            {"CANDIDATES", std::to_string(layout.candidates)}, {"FIRST", std::to_string(4 * target)}, {"RESULTS", "1"}};
        start_.push_back(Program::draw(tiles, "reflect/start.frag", kept + which + only(0)));
    }
    line_ = Program::draw(tiles, "reflect/line.frag", kept + only(0));
    all_ = {&target_, &residual_, &line_};
    for (const auto* programs : {&gradient_, &diagonal_, &start_, &count_})
        for (const Program& program : *programs) all_.push_back(&program);
    for (const Program* program : all_) {
        if (w_.mesh) w_.mesh->set_layout(*program);
        program->bind_if_used("surface", w_.surface);
        program->bind_if_used("kept", kept_);
    }
    for (const Program* program : {&target_, &residual_}) {
        if (!w_.mesh) {
            w_.set_stack(*program, 1);
            continue;
        }
        program->bind("items", items_->items());
        program->set("to_16_bit", w_.images.bits() == 8 ? 257 : 1);
    }
}

// Keeps an image's residuals or targets in SLS, by the program that finds them.
void PaperTexelPasses::keep(const ImageOnDevice& image, const Program& program) {
    const std::array<float, 12> numbers = w_.numbers_of(*image.view);
    constexpr const char* names[] = {"lamp", "exposure", "camera_centre"};
    for (const Program* each : all_)
        for (size_t i = 0; i < 3; ++i) each->set_if_used(names[i], std::span<const float>(numbers).subspan(4 * i, 4));
    if (w_.mesh) {
        SlsMesh::set_camera(program, *image.camera);
        w_.mesh->select({{image.camera}});
        w_.run.draw_items(*items_, *image.camera);
    }
    program.bind(w_.mesh ? "image" : "images", *image.texture);
    draw(kept_target_, program);
}

void PaperTexelPasses::add(const Program& program, const Framebuffer& target) {
    w_.run.blend();
    draw(target, program);
    w_.run.no_blend();
}

void PaperTexelPasses::count(const std::vector<ImageOnDevice>& images) {
    for (const ImageOnDevice& image : images) {
        keep(image, target_);
        for (size_t layer = 0; layer < count_.size(); ++layer) add(count_[layer], w_.sums.count.each[layer]);
    }
}

void PaperTexelPasses::start(const std::vector<ImageOnDevice>& images, int group, int window,
                             const TexelSumLayers& sums) {
    const size_t first = size_t(window * StartLayout::most_targets);
    const size_t layers = std::min(sums.each.size(), start_.size() - first);  // the last window may be a small one
    for (const ImageOnDevice& image : images) {
        keep(image, target_);
        for (size_t layer = 0; layer < layers; ++layer) {
            w_.set_shapes(start_[first + layer], group);
            add(start_[first + layer], sums.each[layer]);
        }
    }
}

void PaperTexelPasses::gradient_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) {
    for (const Program* program : all_) program->bind_if_used("parameters", x.maps());
    for (const ImageOnDevice& image : images) {
        keep(image, residual_);
        for (size_t map = 0; map < gradient_.size(); ++map) add(gradient_[map], w_.sums.gradient.each[map]);
        for (size_t layer = 0; layer < diagonal_.size() && diagonal; ++layer)
            add(diagonal_[layer], w_.sums.diagonal.each[layer]);
    }
}

void PaperTexelPasses::directional_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x,
                                        const TexelVector& d) {
    for (const Program* program : {&residual_, &line_}) program->bind_if_used("parameters", x.maps());
    line_.bind("direction", d.maps());
    for (const ImageOnDevice& image : images) {
        keep(image, residual_);
        add(line_, w_.sums.line.each[0]);
    }
}

}  // namespace

std::unique_ptr<TexelPasses> make_paper_texel_passes(const TexelPassResources& resources) {
    return std::make_unique<PaperTexelPasses>(resources);
}

}  // namespace radiafit
