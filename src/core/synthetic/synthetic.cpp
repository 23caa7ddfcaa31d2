#include "synthetic/synthetic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "dataset/dataset_json.h"
#include "dataset/stream_views.h"
#include "synthetic/closed_mesh.h"
#include "synthetic/ornament.h"
#include "synthetic/render_view.h"
#include "synthetic/viewpoints.h"

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
    std::vector<ViewRenderer> renderers(workers);
    std::vector<LinearImage> images(workers);
    stream_views("generate", cameras.size(), writer, [&](size_t i, int worker, PackedImage& packed) {
        LinearImage& image = images[size_t(worker)];
        renderers[size_t(worker)].render(scene, cameras[i], supersamples, image);
        packed.pixels.clear();
        for (const Vec3f& pixel : image.pixels)
            for (int c = 0; c < 3; ++c) packed.pixels.push_back(to_byte(exposure * pixel[c]));
        return synthetic_view(i, cameras[i]);
    });
}

/// Star or bust, by the rules of synthetic.h.
void write_painted(const SyntheticSize& size, const SyntheticOptions& options, DatasetWriter& writer, Dataset& header) {
    const bool star = options.shape == "star";
    const Solid solid = star ? star_solid(options.seed) : bust_solid(options.seed, 2.2 / std::sqrt(size.triangles));
    header.mesh = wrap_solid(solid, star ? Vec3d(0, 0, 0) : Vec3d(0, 0.06, 0), size.triangles);

    const std::vector<Camera> cameras = hemisphere_cameras(header.mesh, size.views, size.side, options.seed);
    const Paint paint(header.mesh, options.shape, options.seed);
    const SurfaceLight light(header.mesh, solid, size.side < 100 ? 4 : 8);  // steps of about a pixel
    write_views({header.mesh, paint, light}, cameras, writer);
    header.mesh = subdivided(header.mesh, options.subdivide);
    header.description = description(options);
}

}  // namespace

View synthetic_view(size_t i, const Camera& camera) {
    View view;
    view.name = fmt::format("view_{:03}", i);
    view.camera = camera;
    view.held_out = i % held_out_every == 0;
    return view;
}

namespace {

/// The size by the scale alone.
SyntheticSize usual_size(const SyntheticOptions& options) {
    const bool star = options.shape == "star", ornament = options.shape == "ornament";
    if (!star && !ornament && options.shape != "bust")
        throw UserError(fmt::format("unknown shape \"{}\"; there are star, bust and ornament", options.shape));
    if (!ornament && !(options.ornament == OrnamentOptions{}))
        throw UserError(
            fmt::format("encoding, noise, shading and light are the ornament's to choose, not the {}'s; "
                        "leave these options out",
                        options.shape));
    if (ornament && options.subdivide > 1)
        throw UserError("the ornament's truth is of its own triangles; leave subdivide out");
    // About two texels of the ornament for each pixel that sees it: finer than the images, so that a texel takes nearly
    // every pixel (Section 5.1.1).
    if (ornament && options.scale == "smoke") return {320, 240, 64, 6};
    if (ornament && options.scale == "standard") return {1280, 400, 256, 12};
    if (ornament && options.scale == "paper") return {3690, 623, 512, 16};
    if (options.scale == "smoke") return {320, 24, 64};
    if (options.scale == "standard") return {1280, 100, 256};
    if (options.scale == "paper") return star ? SyntheticSize{6094, 331, 400} : SyntheticSize{7228, 336, 400};
    throw UserError(fmt::format("unknown scale \"{}\"; there are smoke, standard and paper", options.scale));
}

}  // namespace

SyntheticSize synthetic_size(const SyntheticOptions& options) {
    SyntheticSize size = usual_size(options);
    if (options.views > 0) size.views = options.views;
    return size;
}

Needs synthetic_needs(const SyntheticOptions& options) {
    const SyntheticSize size = synthetic_size(options);
    const bool ornament = options.shape == "ornament";
    const uint64_t channel = ornament ? uint64_t(bytes_per_channel(options.ornament.sensor.encoding)) : 1;
    const uint64_t pixels = uint64_t(size.side) * uint64_t(size.side);
    const uint64_t tile = uint64_t(size.surface_side) * uint64_t(size.surface_side + 1) / 2;
    const uint64_t texels = ornament ? uint64_t(size.triangles) * tile : 0;
    constexpr uint64_t texel_on_disk = 12 + 36 + 1;  // normal, truth and material
    constexpr uint64_t texel_in_memory = 4 * 49;     // these, where they come from, and shading frames
    constexpr uint64_t pixel_in_memory = 100;        // supersampled, in several stages
    constexpr uint64_t mesh_on_disk = 20;            // of a triangle: 13 bytes and half a vertex
    constexpr uint64_t other_memory = 300'000'000;   // the program and its tables of light
    const uint64_t image = (3 * channel * pixels + image_alignment - 1) / image_alignment * image_alignment;
    return {.memory = other_memory + uint64_t(thread_count()) * 4 * pixels * pixel_in_memory + texels * texel_in_memory,
            .disk = uint64_t(size.views) * (image + 1000) + texels * texel_on_disk +
                    uint64_t(size.triangles) * uint64_t(options.subdivide * options.subdivide) * mesh_on_disk};
}

void generate_synthetic(const SyntheticOptions& options, const std::filesystem::path& out) {
    const SyntheticSize size = synthetic_size(options);
    DatasetWriter writer(out);
    Dataset header;
    header.name = options.shape;
    if (options.shape == "ornament")
        write_ornament(size, options.seed, options.ornament, writer, header);
    else
        write_painted(size, options, writer, header);
    header.source = synthetic_source(options);
    writer.finish(header);
}

std::string synthetic_source(const SyntheticOptions& options) {
    constexpr int recipe = 1;  // count up whenever the same options begin to give other bytes
    std::string own;
    if (options.subdivide > 1) own += fmt::format(" --subdivide {}", options.subdivide);
    const OrnamentOptions &o = options.ornament, usual;
    if (o.sensor.encoding != usual.sensor.encoding) own += " --encoding " + to_string(o.sensor.encoding);
    if (o.sensor.read_noise > 0) own += fmt::format(" --read-noise {}", o.sensor.read_noise);
    if (o.sensor.shot_noise > 0) own += fmt::format(" --shot-noise {}", o.sensor.shot_noise);
    if (o.shading != usual.shading) own += " --shading pixel";
    if (o.light != usual.light) own += " --light near";
    const std::string views = options.views > 0 ? fmt::format(", of {} images", options.views) : "";
    return fmt::format("radiafit generate {} --scale {} --seed {}{} (recipe {}){}", options.shape, options.scale,
                       options.seed, own, recipe, views);
}

}  // namespace radiafit
