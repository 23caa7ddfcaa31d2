#include "publish/scene_json.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json.h"
#include "dataset/view_directions.h"
#include "eval/safe_relighting.h"
#include "eval/specular_enhancement.h"
#include "geometry/triangles_across.h"
#include "gl/program.h"
#include "image/web/webp_image.h"
#include "publish/choices.h"
#include "publish/pages.h"
#include "viewbasis/texel_views.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr int largest_picture = 1280;  // pixels a side; larger photographs are halved
constexpr int largest_first_picture = 640;
constexpr float photograph_quality = 85, baseline_quality = 75;

Json json_of(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }
template <class Number, size_t count>
Json json_of(const std::array<Number, count>& numbers) {
    return std::vector<double>(numbers.begin(), numbers.end());
}

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
    std::string out(numbers.size() * sizeof(Number), '\0');
    if (!numbers.empty()) std::memcpy(out.data(), numbers.data(), out.size());
    return out;
}

std::string add_blob(Page& page, const std::string& name, std::string bytes) {
    page.blobs.emplace_back(name, std::move(bytes));
    return name;
}

/// The picture, halved until it is small enough.
ByteRaster halved(ByteRaster image, int largest) {
    while (std::max(image.width, image.height) > largest) {
        ByteRaster half{image.width / 2, image.height / 2, image.channels, {}};
        half.bytes.resize(size_t(half.width) * size_t(half.height) * size_t(half.channels));
        const size_t channels = size_t(image.channels), row = size_t(image.width) * channels;
        for (size_t y = 0; y < size_t(half.height); ++y)
            for (size_t i = 0; i < size_t(half.width) * channels; ++i) {
                const size_t at = 2 * y * row + 2 * (i / channels) * channels + i % channels;
                const uint8_t* p = &image.bytes[at];
                half.bytes[y * size_t(half.width) * channels + i] =
                    uint8_t((p[0] + p[channels] + p[row] + p[row + channels] + 2) / 4);
            }
        image = std::move(half);
    }
    return image;
}

/// sRGB bytes of a judged picture, with the judge's foreground as alpha.
ByteRaster raster_of(const JudgedView& view, const std::vector<float>& stored, Encoding encoding) {
    ByteRaster out{view.width, view.height, 4, {}};
    out.bytes.reserve(4 * view.foreground.size());
    for (size_t i = 0; i < view.foreground.size(); ++i) {
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double shown = encoding == Encoding::u8_srgb ? stored[c] : srgb_encode(decode(encoding, stored[c]));
            out.bytes.push_back(uint8_t(std::lround(255 * std::clamp(std::isfinite(shown) ? shown : 0.0, 0.0, 1.0))));
        }
        out.bytes.push_back(view.foreground[i] ? 255 : 0);
    }
    return out;
}

double psnr_of(const JudgedView& view) {
    ErrorSums sums;
    for (size_t i = 0; i < view.foreground.size(); ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && view.foreground[i]; ++c)
            sums.add(double(view.render[c]) - double(view.photograph[c]));
    return sums.psnr();
}

Json camera_json(const View& view) {
    const Camera& c = view.camera;
    Json out = {{"width", c.width}, {"height", c.height}, {"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}};
    std::vector<double> rotation;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) rotation.push_back(c.cam_from_world_rotation(row, column));
    out["rotation"] = rotation;
    out["translation"] = json_of(c.cam_from_world_translation);
    if (view.camera_direction) out["direction"] = json_of(*view.camera_direction);
    return out;
}

Json light_json(const Light& light) {
    return {{"near", light.kind == Light::Kind::near},
            {"place", json_of(light.place)},
            {"intensity", json_of(light.intensity)}};
}

Json enhancement_json() {
    const SpecularEnhancement by;
    return {{"diffuse", by.diffuse}, {"highlight", by.highlight}, {"exponent", by.exponent}};
}

bool interpolated(const Published& fit) { return fit.record.surface == SurfaceLookup::linear; }

const char* name_of(MapPlace place) { return place == MapPlace::surface ? "surface" : "view"; }

}  // namespace

std::string shaders_json(const Published& fit) {
    Defines defines = fit.model.defines;
    defines.emplace_back("MAPS", std::to_string(fit.model.maps.size()));
    if (fit.dataset.has_grid()) defines.emplace_back("GRID", "1");
    if (shows_stored_srgb(fit.dataset, fit.fit.space)) defines.emplace_back("STORED_SRGB", "1");
    if (fit.model.vertex_entries > 0) defines.emplace_back("VERTEX_ENTRIES", std::to_string(fit.model.vertex_entries));
    const auto text = [&](const std::string& file, const Defines& with) {
        return expand_shader("view/" + file, with).text;
    };
    if (interpolated(fit)) defines.emplace_back("LINEAR", "1");
    Json out = {{"whole", text("whole.vert", {})},
                {"add", text("add.frag", {})},
                {"present", text("present.frag", {})},
                {"texel", text(fit.model.shader + ".frag", defines)},
                {"pixel", text("pixel.frag", defines)}};
    if (!fit.dataset.has_grid()) {
        out["mesh"] = text("mesh.vert", {});
        out["texels"] = text("texels.vert", {});
    }
    if (!fit.model.vertex_shader.empty()) out["vertices"] = text(fit.model.vertex_shader + ".frag", defines);
    return json_text(out);
}

std::string maps_json(const PageModel& model, const std::vector<CodedMap>& coded, Page& page) {
    Json sets = Json::object(), maps = Json::array();
    for (size_t m = 0; m < coded.size(); ++m) {
        const PageMap& map = model.maps[m];
        Json& set = sets[name_of(map.place)];
        if (set.is_null()) set = {{"width", map.image.width}, {"height", map.image.height}, {"layers", Json::array()}};
        const auto add = [&](const std::string& bytes, const char* which) {
            if (bytes.empty()) return -1;
            set["layers"].push_back(add_blob(page, fmt::format("map{:02}{}", m, which), bytes));
            return int(set["layers"].size()) - 1;
        };
        const int low = add(coded[m].low, ""), high = add(coded[m].high, "_high");
        maps.push_back({{"name", map.name},
                        {"scale", json_of(coded[m].scale)},
                        {"offset", json_of(coded[m].offset)},
                        {"low", low},
                        {"high", high}});
    }
    return json_text(Json{{"sets", sets}, {"maps", maps}});
}

std::string surface_json(const Published& fit, Page& page) {
    const Dataset& dataset = fit.dataset;
    Json out = {{"centre", json_of(surface_centre(dataset.mesh, dataset.grid))},
                {"up", json_of(mean_up(dataset).cast<double>())}};
    if (dataset.has_grid()) {
        const Grid& g = dataset.grid;
        out["grid"] = {{"width", g.width},          {"height", g.height},      {"origin", json_of(g.origin)},
                       {"right", json_of(g.right)}, {"down", json_of(g.down)}, {"normal", json_of(g.normal())}};
        return json_text(out);
    }
    const Mesh& mesh = dataset.mesh;
    std::vector<float> vertices;  // position and normal, as tables have it
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    Eigen::AlignedBox3f box;
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        box.extend(mesh.positions[v]);
        vertices.insert(vertices.end(), mesh.positions[v].begin(), mesh.positions[v].end());
        vertices.insert(vertices.end(), normals[v].begin(), normals[v].end());
    }
    std::vector<uint32_t> triangles;
    for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    const TriangleAtlas atlas(mesh, fit.model.largest_side);
    out["mesh"] = {{"vertices", add_blob(page, "vertices", bytes_of(vertices))},
                   {"triangles", add_blob(page, "triangles", bytes_of(triangles))},
                   {"radius", double(box.diagonal().norm()) / 2},
                   {"largest_side", fit.model.largest_side},
                   {"rectangles_per_row", atlas.rectangles_per_row()}};
    if (!fit.model.sides.empty()) out["mesh"]["sides"] = add_blob(page, "sides", bytes_of(fit.model.sides));
    if (interpolated(fit)) out["mesh"]["across"] = add_blob(page, "across", bytes_of(triangles_across(atlas)));
    return json_text(out);
}

std::string model_json(const Published& fit, Page& page) {
    Json tables = Json::array();
    for (const PageTable& table : fit.model.tables)
        tables.push_back(
            {{"uniform", table.uniform}, {"entries", add_blob(page, table.uniform, bytes_of(table.entries))}});
    std::vector<float> samples, residuals;
    for (size_t i = 0; i < fit.record.samples.size(); ++i) {
        samples.push_back(std::log2(1 + float(fit.record.samples[i])));
        residuals.push_back(root_mean_square(fit.record.error[i], fit.record.samples[i]));
    }
    Json uniforms = Json::object();
    for (const auto& [name, values] : fit.model.uniforms) uniforms[name] = values;
    Json whole = Json::object();
    for (const auto& [name, value] : fit.model.whole_uniforms) whole[name] = value;
    return json_text(Json{{"description", fit.description},
                          {"takes_light", fit.takes_light},
                          {"fades", fit.model.fades},
                          {"enhancement", fit.takes_light ? enhancement_json() : Json()},
                          {"terms", fit.model.terms},
                          {"vertex_entries", fit.model.vertex_entries},
                          {"tables", tables},
                          {"uniforms", uniforms},
                          {"whole_uniforms", whole},
                          {"most_samples", std::exp2(end_of_scale(samples)) - 1},
                          {"most_residual", end_of_scale(residuals)},
                          {"most_uncertainty", fit.model.most_uncertainty},
                          {"residual_unit", fit.model.residual_unit},
                          {"baseline", fit.baseline_name}});
}

std::string directions_json(const Published& fit) {
    const Vec3d centre = surface_centre(fit.dataset.mesh, fit.dataset.grid);
    Json cameras = Json::array(), lamps = Json::array();
    Vec3d irradiance = Vec3d::Zero();
    for (const uint32_t v : fit.training) {
        const View& view = fit.dataset.views[v];
        cameras.push_back(json_of(view.direction_to_camera(centre)));
        if (!view.light) continue;
        lamps.push_back(json_of(view.light->direction_from(centre)));
        irradiance += view.light->irradiance_at(centre) / double(fit.training.size());
    }
    return json_text(Json{{"cameras", cameras},
                          {"lamps", lamps},
                          {"irradiance", json_of(irradiance)},
                          {"trusted", SafeRelighting::trusted},
                          {"fade", SafeRelighting::fade}});
}

std::string view_json(const Published& fit, uint32_t number, const JudgedView& judged, const JudgedView& baseline,
                      Page& page) {
    const View& view = fit.dataset.views[number];
    const auto picture = [&](const char* what, const JudgedView& of, const std::vector<float>& stored, float quality) {
        const ByteRaster raster = halved(raster_of(of, stored, fit.dataset.encoding), largest_picture);
        return add_blob(page, fmt::format("{}{:04}", what, number), lossy_webp(raster, quality));
    };
    Json out = {{"number", number},
                {"name", view.name},
                {"held_out", view.held_out},
                {"camera", camera_json(view)},
                {"gain", json_of(judged.gain.channels)},
                {"psnr", psnr_of(judged)},
                {"baseline_psnr", psnr_of(baseline)},
                {"photograph", picture("photograph", judged, judged.photograph, photograph_quality)},
                {"baseline", picture("baseline", baseline, baseline.render, baseline_quality)}};
    if (view.light) out["light"] = light_json(*view.light);
    return json_text(out);
}

std::string picture_of(const JudgedView& judged, Encoding encoding) {
    return lossy_webp(halved(raster_of(judged, judged.render, encoding), largest_first_picture), baseline_quality);
}

}  // namespace radiafit::tools
