#include "gl/texel_passes.h"

#include <cmath>

namespace radiafit {
namespace {

// The least 16-bit unit of a channel whose value is clipped; beyond all of them where none is.
float clipped_unit(float clip_above, const ImageOnDevice& image) {
    if (!(clip_above > 0)) return 1e6f;
    const float limit = clip_above * float(image.view->gain);
    float unit = std::max(0.0f, std::floor(limit / image.target_scale) - 1);
    while (unit * image.target_scale < limit) ++unit;
    return unit;
}

}  // namespace

Defines TexelWorld::defines(int batch) const {
    const Defines all = shape.defines(storage) + Defines{{"BATCH", std::to_string(batch)}};
    return mesh ? all + mesh->defines() : all + Defines{{"GRID", ""}};
}

void TexelWorld::set_images(const Program& program, const std::vector<ImageOnDevice>& images, int batch) const {
    std::vector<float> lamps, exposures, eyes;
    const auto add = [](std::vector<float>& to, const Vec3d& three, float fourth) {
        to.insert(to.end(), {float(three.x()), float(three.y()), float(three.z()), fourth});
    };
    for (const ImageOnDevice& image : images) {
        const View& view = *image.view;
        const Light& light = *view.light;
        // Where a lamp sends no light of a colour, the pixel says nothing of it, and is 0.
        const Vec3d inverse = light.intensity.unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });
        add(lamps, light.place, light.kind == Light::Kind::near ? 1.0f : 0.0f);
        add(exposures, double(image.target_scale) * inverse, clipped_unit(clip_above, image));
        if (view.camera_direction)
            add(eyes, *view.camera_direction, 0);
        else
            add(eyes, view.camera.center(), 1);
    }
    for (int i = int(images.size()); i < batch; ++i) {
        add(lamps, Vec3d::UnitZ(), 0);
        add(exposures, Vec3d::Zero(), -1);
        add(eyes, Vec3d::UnitZ(), 0);
    }
    program.set4(44, batch, lamps.data());
    program.set4(48, batch, exposures.data());
    program.set4(52, batch, eyes.data());
    program.set(5, shape.width());
    program.set(56, bits == 8 ? 257 : 1);
}

void TexelWorld::set_shapes(const Program& program, int group) const {
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
    program.set4(14, layout.candidates * shape.shape_maps(), shapes.data());
}

}  // namespace radiafit
