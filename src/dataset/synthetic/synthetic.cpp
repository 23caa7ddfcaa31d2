#include "dataset/synthetic/synthetic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "dataset/dataset.h"
#include "dataset/synthetic/closed_mesh.h"
#include "dataset/synthetic/render_view.h"
#include "dataset/synthetic/viewpoints.h"

namespace radiafit {
namespace {

constexpr int held_out_every = 8;
constexpr float saturates_at = 0.9955f;  // linear light that sRGB stores as 255

/// The exposure that saturates `saturated_share` of the foreground, measured with one sample per pixel.
float choose_exposure(const Scene& scene, const std::vector<Camera>& cameras) {
    std::vector<std::vector<float>> brightest(cameras.size());
    std::vector<ViewRenderer> renderers(static_cast<size_t>(thread_count()));
    parallel_for(cameras.size(), 1, [&](size_t i, int worker) {
        LinearImage image;
        renderers[size_t(worker)].render(scene, cameras[i], 1, image);
        for (size_t p = 0; p < image.pixels.size(); ++p)
            if (image.foreground[p]) brightest[i].push_back(image.pixels[p].maxCoeff());
    });
    std::vector<float> all;
    for (const std::vector<float>& b : brightest) all.insert(all.end(), b.begin(), b.end());
    const auto rank = std::min(all.size() - 1, size_t((1 - saturated_share) * double(all.size())));
    std::nth_element(all.begin(), all.begin() + ptrdiff_t(rank), all.end());
    return saturates_at / all[rank];
}

/// Linear light to sRGB bytes by a table fine enough for the curve's steep foot.
class ByteTable {
public:
    ByteTable() : bytes_(size_t(steps) + 1) {
        for (size_t i = 0; i < bytes_.size(); ++i)
            bytes_[i] = uint8_t(std::lround(255 * srgb_encode(double(i) / steps)));
    }
    uint8_t operator()(float linear) const {
        return bytes_[size_t(std::clamp(linear, 0.0f, 1.0f) * float(steps) + 0.5f)];
    }

private:
    static constexpr int steps = 1 << 15;
    std::vector<uint8_t> bytes_;
};

std::string description(const SyntheticOptions& options) {
    const std::string paper =
        options.shape == "star" ? "the star (6,093 triangles, 159 MB)" : "the bust (7,228 triangles, 161 MB)";
    return fmt::format(
        "A stand-in for {} of Hillesland et al. 2003, whose capture is not public: "
        "a painted, glossy {} under four lamps and a sky, with shadows.",
        paper, options.shape);
}

void write_views(const Scene& scene, const std::vector<Camera>& cameras, DatasetWriter& writer) {
    const float exposure = choose_exposure(scene, cameras);
    const ByteTable to_byte;
    const auto workers = static_cast<size_t>(thread_count());
    const size_t batch = 4 * workers;
    std::vector<std::vector<uint8_t>> bytes(batch);
    std::vector<ViewRenderer> renderers(workers);
    std::vector<LinearImage> images(workers);
    Progress progress("generate", cameras.size());
    for (size_t first = 0; first < cameras.size(); first += batch) {
        const size_t count = std::min(batch, cameras.size() - first);
        parallel_for(count, 1, [&](size_t i, int worker) {
            LinearImage& image = images[size_t(worker)];
            renderers[size_t(worker)].render(scene, cameras[first + i], supersamples, image);
            bytes[i].clear();
            for (const Vec3f& pixel : image.pixels)
                for (int c = 0; c < 3; ++c) bytes[i].push_back(to_byte(exposure * pixel[c]));
            progress.advance();
        });
        for (size_t i = 0; i < count; ++i) {
            View view;
            view.name = fmt::format("view_{:03}", first + i);
            view.camera = cameras[first + i];
            view.held_out = (first + i) % held_out_every == 0;
            writer.add(view, bytes[i].data(), {});
        }
    }
}

}  // namespace

SyntheticSize synthetic_size(const SyntheticOptions& options) {
    const bool star = options.shape == "star";
    if (!star && options.shape != "bust")
        throw UserError(fmt::format("unknown shape \"{}\"; there are star and bust", options.shape));
    if (options.scale == "smoke") return {320, 24, 64};
    if (options.scale == "standard") return {1280, 100, 256};
    if (options.scale == "paper") return star ? SyntheticSize{6094, 331, 400} : SyntheticSize{7228, 336, 400};
    throw UserError(fmt::format("unknown scale \"{}\"; there are smoke, standard and paper", options.scale));
}

void generate_synthetic(const SyntheticOptions& options, const std::filesystem::path& out) {
    const SyntheticSize size = synthetic_size(options);
    DatasetWriter writer(out);
    const bool star = options.shape == "star";
    const Solid solid = star ? star_solid(options.seed) : bust_solid(options.seed, 2.2 / std::sqrt(size.triangles));
    Dataset header;
    header.mesh = wrap_solid(solid, star ? Vec3d(0, 0, 0) : Vec3d(0, 0.06, 0), size.triangles);

    const std::vector<Camera> cameras = hemisphere_cameras(header.mesh, size.views, size.side, options.seed);
    const Paint paint(header.mesh, options.shape, options.seed);
    const SurfaceLight light(header.mesh, solid, size.side < 100 ? 4 : 8);  // steps of about a pixel
    write_views({header.mesh, paint, light}, cameras, writer);

    header.name = options.shape;
    header.description = description(options);
    header.source = synthetic_source(options);
    writer.finish(header);
}

std::string synthetic_source(const SyntheticOptions& options) {
    constexpr int recipe = 1;  // count up whenever the same options begin to give other bytes
    return fmt::format("radiafit generate {} --scale {} --seed {} (recipe {})", options.shape, options.scale,
                       options.seed, recipe);
}

}  // namespace radiafit
