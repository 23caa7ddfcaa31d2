#include "synthetic/ornament.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "dataset/stream_views.h"
#include "dataset/truth.h"
#include "synthetic/closed_mesh.h"
#include "synthetic/moving_lights.h"
#include "synthetic/ornament_pattern.h"
#include "synthetic/paint.h"
#include "synthetic/render_reflectance.h"
#include "synthetic/synthetic.h"
#include "synthetic/viewpoints.h"

namespace radiafit {
namespace {

/// The decoration at every texel's centre: its normals go to `map`.
ReflectanceTruth decorate(const TriangleAtlas& atlas, const OrnamentPattern& pattern, NormalMap& map) {
    const double step = 0.5 * double(mean_edge(atlas.mesh())) / atlas.side();
    ReflectanceTruth truth;
    truth.side = map.side = atlas.side();
    for (size_t m = 0; m < ornament_material_names.size(); ++m)
        truth.materials.push_back(describe(ornament_material_names[m], model_of(OrnamentMaterial(m))));
    truth.material.resize(atlas.texel_count());
    truth.parameters.resize(atlas.texel_count());
    map.normals.resize(atlas.texel_count());
    parallel_for(atlas.texel_count(), 1024, [&](size_t i, int) {
        const auto texel = uint32_t(i);
        const Vec3d x = atlas.position(texel).cast<double>();
        truth.material[i] = uint8_t(pattern.at(x).material);
        truth.parameters[i] = pattern.parameters(x);
        map.normals[i] = pattern.normal(x, atlas.normal(texel).cast<double>(), step).cast<float>();
    });
    return truth;
}

std::string description(const OrnamentOptions& o) {
    const Sensor& s = o.sensor;
    const std::string noise = s.read_noise > 0 || s.shot_noise > 0
                                  ? fmt::format("noise of {:g} plus {:g} at white", s.read_noise, s.shot_noise)
                                  : "no noise";
    return fmt::format(
        "A stand-in for the ornament (3,690 triangles, 0.98 GB) of Hillesland et al. 2003, whose data is not public: "
        "relief in white (Oren-Nayar and Blinn), gold and green (Lafortune), one {} lamp per image, no shadows, {}, "
        "pixels shaded {}; its truth stands beside it.",
        o.light == Light::Kind::distant ? "distant" : "near", noise,
        o.shading == Shading::texel ? "at their texels' centres" : "over their areas");
}

}  // namespace

void write_ornament(const SyntheticSize& size, uint64_t seed, const OrnamentOptions& options, DatasetWriter& writer,
                    Dataset& header) {
    check_sensor(options.sensor);
    header.mesh = wrap_solid(ornament_solid(), {0, 0, 0}, size.triangles);
    TriangleAtlas atlas(header.mesh, size.surface_side);
    ReflectanceTruth truth = decorate(atlas, OrnamentPattern(seed), header.normal_map);
    truth.exact = options.shading == Shading::texel;
    atlas.set_normals(header.normal_map.normals);
    write_truth(truth, writer.temporary_folder());

    const std::vector<Camera> cameras = sphere_cameras(header.mesh, size.views, size.side, seed);
    double radius = 0;
    for (const Vec3f& p : header.mesh.positions) radius = std::max(radius, double(p.norm()));
    const std::vector<Light> lights = moving_lights(cameras, options.light, radius, seed);

    struct Worker {
        TexelSurfaceRenderer renderer;
        LinearImage image;
    };
    std::vector<Worker> workers(static_cast<size_t>(thread_count()));
    writer.set_encoding(options.sensor.encoding);
    stream_views("generate", cameras.size(), writer, [&](size_t i, int worker, PackedImage& packed) {
        auto& [renderer, image] = workers[size_t(worker)];
        renderer.render({atlas, truth}, cameras[i], lights[i], options.shading, image);
        options.sensor.expose(image.pixels, seed, i, packed.pixels);
        View view = synthetic_view(i, cameras[i]);
        view.light = lights[i];
        return view;
    });
    header.description = description(options);
}

}  // namespace radiafit
