#include "stereo/preview.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/output_claims.h"
#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture/coverage.h"
#include "capture/image_scale.h"
#include "capture/mesh_file.h"
#include "geometry/raster.h"
#include "image/image_file.h"
#include "image/png_file.h"
#include "model/value_curve.h"
#include "stereo/mesh_border.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr size_t columns = 3;
constexpr int panel_side = 480;  // pixels, the longer one

using Rgb = std::array<uint8_t, 3>;
constexpr Rgb border_red = {220, 30, 30}, ink = {40, 40, 60};

struct Picture {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;

    Picture(int w, int h) : width(w), height(h), rgb(3 * size_t(w) * size_t(h), 255) {}
    void dot(int x, int y, const Rgb& color) {
        if (x >= 0 && y >= 0 && x < width && y < height)
            std::ranges::copy(color, rgb.begin() + 3 * (ptrdiff_t(y) * width + x));
    }
    void paste(const Picture& other, int left, int top) {
        for (int y = 0; y < other.height; ++y)
            std::copy_n(other.rgb.begin() + 3 * ptrdiff_t(y) * other.width, 3 * other.width,
                        rgb.begin() + 3 * (ptrdiff_t(top + y) * width + left));
    }
};

/// Photographs whose cameras are farthest apart, each from those before, as seen from where they all look.
std::vector<size_t> far_apart(const Calibration& model) {
    std::vector<Camera> cameras;
    for (const CalibratedImage& image : model.images) cameras.push_back(image.camera);
    const Vec3d middle = meeting_point(cameras).value_or(Vec3d::Zero());
    std::vector<size_t> chosen = {0};
    while (chosen.size() < std::min(columns, cameras.size())) {
        const auto nearest = [&](size_t i) {
            double angle = INFINITY;
            for (const size_t c : chosen)
                angle = std::min(
                    angle,
                    std::acos(std::clamp(
                        (cameras[i].center() - middle).normalized().dot((cameras[c].center() - middle).normalized()),
                        -1.0, 1.0)));
            return angle;
        };
        size_t best = 0;
        for (size_t i = 1; i < cameras.size(); ++i)
            if (nearest(i) > nearest(best)) best = i;
        chosen.push_back(best);
    }
    return chosen;
}

Camera within_panel(const Camera& camera) {
    const auto [width, height] = size_within(camera.width, camera.height, panel_side);
    const double x = double(width) / camera.width, y = double(height) / camera.height;
    Camera small = camera;
    small.width = width, small.height = height;
    small.fx *= x, small.cx *= x, small.fy *= y, small.cy *= y;
    return small;
}

/// sRGB of 16 bits or of a float.
uint8_t byte_of(const ImageFile& image, size_t at) {
    const float value = image.bits == 16 ? float(image.rgb16[at]) / 65535 : image.rgb32[at];
    const float within = value > 0 ? std::min(value, 1.0f) : 0;  // what is no number is black
    const bool light = image.bits == 32 || image.linear;
    return uint8_t(std::lround(255 * (light ? srgb_encode(within) : within)));
}

Picture photograph(const fs::path& file, const Camera& small) {
    constexpr double most_difference = 0.02;  // of the sides' ratios
    ImageFile image = read_image(file, true);
    const double ratio = double(image.width) / image.height * small.height / small.width;
    if (std::abs(ratio - 1) > most_difference)
        throw UserError(fmt::format(
            "{}: {} x {} pixels, of another shape than the model's camera: give the undistorted photographs "
            "that the model is of",
            file.string(), image.width, image.height));
    image = scale_down(image, std::min(small.width, image.width), std::min(small.height, image.height));
    Picture out(small.width, small.height);
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            const size_t pixel =
                size_t(y * image.height / small.height) * size_t(image.width) + size_t(x * image.width / small.width);
            Rgb color;
            for (size_t c = 0; c < 3; ++c)
                color[c] = image.bits == 8 ? image.rgb8[3 * pixel + c] : byte_of(image, 3 * pixel + c);
            out.dot(x, y, color);
        }
    return out;
}

Picture drawn_points(const std::vector<SparsePoint>& points, const Camera& camera) {
    Picture out(camera.width, camera.height);
    for (const SparsePoint& point : points) {
        const Vec3d p = camera.project(point.position);
        if (!(p.z() > 0) || std::abs(p.x()) > 1e6 || std::abs(p.y()) > 1e6) continue;
        for (int k = 0; k < 4; ++k) out.dot(int(p.x()) + k % 2, int(p.y()) + k / 2, ink);
    }
    return out;
}

void draw_borders(Picture& picture, const Mesh& mesh, const Rasterizer& raster, const Camera& camera) {
    constexpr double hidden_behind = 0.01;  // of the depth
    for (const auto& [a, b] : border_edges(mesh)) {
        const Vec3d from = mesh.positions[a].cast<double>(), to = mesh.positions[b].cast<double>();
        const Vec3d p = camera.project(from), q = camera.project(to);
        if (!(p.z() > 0 && q.z() > 0)) continue;
        const int steps = int(std::clamp((p - q).head<2>().norm(), 1.0, 2.0 * panel_side));
        for (int i = 0; i <= steps; ++i) {
            const Vec3d at = camera.project(from + double(i) / steps * (to - from));
            if (!(at.x() >= 0 && at.y() >= 0 && at.x() < camera.width && at.y() < camera.height)) continue;
            const size_t pixel = size_t(at.y()) * size_t(camera.width) + size_t(at.x());
            if (at.z() * double(raster.inverse_depth()[pixel]) < 1 + hidden_behind)
                picture.dot(int(at.x()), int(at.y()), border_red);
        }
    }
}

Picture drawn_mesh(const Mesh& mesh, const Camera& camera) {
    Rasterizer raster;
    raster.draw(mesh, camera);
    Picture out(camera.width, camera.height);
    for (size_t i = 0; i < raster.pixels().size(); ++i) {
        const uint32_t triangle = raster.pixels()[i].triangle;
        if (triangle == no_triangle) continue;
        const auto& [a, b, c] = mesh.triangles[triangle];
        const Vec3f normal =
            (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).normalized();
        const Vec3f from_camera = (mesh.positions[a] - camera.center().cast<float>()).normalized();
        const auto grey = uint8_t(50 + 180 * std::abs(normal.dot(from_camera)));
        out.dot(int(i) % camera.width, int(i) / camera.width, {grey, grey, grey});
    }
    draw_borders(out, mesh, raster, camera);
    return out;
}

}  // namespace

void write_preview(const PreviewInput& input, const fs::path& out) {
    Calibration model = read_colmap(input.model);
    std::vector<SparsePoint> points;
    Mesh mesh;
    if (input.mesh.empty())
        points = read_colmap_points(input.model, model);
    else
        mesh = read_mesh_file(input.mesh).mesh;
    std::vector<std::string> notes;
    locate_photographs(model, input.images, false, notes);
    constexpr int gap = 8;
    const std::vector<size_t> chosen = far_apart(model);
    std::vector<Camera> cameras;
    int width = 0, height = 0;
    for (const size_t i : chosen) {
        cameras.push_back(within_panel(model.images[i].camera));
        width = std::max(width, cameras.back().width), height = std::max(height, cameras.back().height);
    }
    Picture picture(int(chosen.size()) * (width + gap) - gap, 2 * height + gap);
    for (size_t k = 0; k < chosen.size(); ++k) {
        const int left = int(k) * (width + gap);
        picture.paste(photograph(model.images[chosen[k]].file, cameras[k]), left, 0);
        picture.paste(input.mesh.empty() ? drawn_points(points, cameras[k]) : drawn_mesh(mesh, cameras[k]), left,
                      height + gap);
    }
    write_png(out, picture.width, picture.height, picture.rgb, made_by_remark());
}

}  // namespace radiafit::tools
