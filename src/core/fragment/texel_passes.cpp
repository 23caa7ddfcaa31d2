#include "fragment/texel_passes.h"

#include <cmath>

namespace radiafit {
namespace {

// The least 16-bit unit of a channel whose value is clipped; beyond all of them where none is.
float clipped_unit(float clip_above, float gain, float scale) {
    if (!(clip_above > 0)) return 1e6f;
    const float limit = clip_above * gain;
    float unit = std::max(0.0f, std::floor(limit / scale) - 1);
    while (unit * scale < limit) ++unit;
    return unit;
}

}  // namespace

std::array<float, 12> view_numbers(const View& view, float scale, float clip_above) {
    std::array<float, 12> numbers;
    const auto put = [&](size_t at, const Vec3d& three, float fourth) {
        for (int c = 0; c < 3; ++c) numbers[at + size_t(c)] = float(three(c));
        numbers[at + 3] = fourth;
    };
    const Light& light = *view.light;
    // Where a lamp sends no light of a colour, the pixel says nothing of it, and is 0.
    const Vec3d inverse = light.intensity.unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });
    put(0, light.place, light.kind == Light::Kind::near ? 1.0f : 0.0f);
    put(4, double(scale) * inverse, clipped_unit(clip_above, float(view.gain[0]), scale));
    if (view.camera_direction)
        put(8, *view.camera_direction, 0);
    else
        put(8, view.camera.center(), 1);
    return numbers;
}

void TexelPassResources::set_stack(const Program& program, int images_in_it) const {
    program.set("blocks_per_row", ImageStack::blocks(shape.width()));
    program.set("images_per_block", images_in_it);
}

void TexelPassResources::set_shapes(const Program& program, int group) const {
    const StartLayout layout(*shape.model);
    if (shape.shape_maps() == 0) return;
    std::vector<float> shapes;
    for (int i = 0; i < layout.candidates; ++i) {
        const size_t start = std::min(size_t(group * layout.candidates + i), shape.model->starts.size() - 1);
        for (int j = 0; j < shape.shape_maps(); ++j)
            for (int c = 0; c < 4; ++c)
                shapes.push_back(c < 3 && 3 * j + c < shape.model->shape
                                     ? float(shape.model->starts[start][size_t(3 * j + c)])
                                     : 0.0f);
    }
    program.set_if_used("shapes", std::span<const float>(shapes));
}

}  // namespace radiafit
