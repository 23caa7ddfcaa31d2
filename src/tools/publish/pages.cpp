#include "publish/pages.h"

#include "fit/fit_maps.h"
#include "fitting/family.h"
#include "publish/coded_map.h"

namespace radiafit::tools {
namespace {

/// At least so fine, since lamps move to where no image shows the error.
constexpr float finest_normals_step = 1.0f / 512;
constexpr float byte_normals = 1.0f / 127;

std::vector<TexelMap> normal_maps() { return {{"normal", {"x", "y", "z"}, 0}}; }

constexpr float root_step = 1.0f / 255;
std::vector<TexelMap> maps_of_bounds() { return {{"albedo", map_channels(), 0}, {"brightest", map_channels(), 3}}; }

std::vector<float> numbers_of(std::span<const Vec3f> normals) {
    std::vector<float> numbers;
    for (const Vec3f& n : normals) numbers.insert(numbers.end(), n.begin(), n.end());
    return numbers;
}

}  // namespace

bool shows_stored_srgb(const Dataset& dataset, TargetSpace space) {
    return space == TargetSpace::stored && dataset.encoding == Encoding::u8_srgb;
}

bool has_normal_map(const Dataset& dataset) {
    return dataset.has_grid() ? !dataset.grid.texel_normals.empty() : dataset.normal_map.side > 0;
}

PageMap normal_map(const Atlas& atlas) {
    std::vector<Vec3f> normals;
    for (uint32_t t = 0; t < atlas.texel_count(); ++t)
        normals.push_back(atlas.usable(t) ? atlas.normal(t) : Vec3f(Vec3f::Zero()));
    PageMap map = parameter_maps(normal_maps(), numbers_of(normals), atlas)[0];
    map.one_unit = true;
    map.most_step = finest_normals_step;
    return map;
}

PageMap fit_normal_map(std::span<const Vec3f> normals, const Atlas& atlas, bool over_grid) {
    std::vector<std::string> axes = {"x", "y", "z"};
    if (over_grid) axes.pop_back();
    PageMap map{.name = "fit_normal", .image = parameter_image(atlas, numbers_of(normals), {"", axes, 0})};
    map.fixed_step = {byte_normals, byte_normals, byte_normals};
    return map;
}

std::unique_ptr<Atlas> atlas_with(const PageMap& normals, const Atlas& atlas, const Dataset& dataset, int side) {
    const std::vector<float> numbers = parameters_of(normal_maps(), {&normals, 1}, atlas);
    std::vector<Vec3f> unit;
    for (size_t i = 0; i < numbers.size(); i += 3) {
        const Vec3f normal(numbers[i], numbers[i + 1], numbers[i + 2]);
        unit.push_back(normal.norm() > 0.001f ? Vec3f(normal.normalized()) : Vec3f::Zero());
    }
    if (!dataset.has_grid()) {
        auto out = std::make_unique<TriangleAtlas>(dataset.mesh, side);
        out->set_normals(std::move(unit));
        return out;
    }
    Grid grid = dataset.grid;
    grid.texel_normals = std::move(unit);
    return std::make_unique<GridAtlas>(make_atlas(grid));
}

std::vector<PageMap> bound_maps(const std::vector<SafeRelighting::Bounds>& bounds, const Atlas& atlas) {
    std::vector<float> all;
    for (const auto& b : bounds) {
        all.insert(all.end(), b.albedo.begin(), b.albedo.end());
        all.insert(all.end(), b.brightest.begin(), b.brightest.end());
    }
    std::vector<PageMap> maps = parameter_maps(maps_of_bounds(), all, atlas);
    for (PageMap& map : maps) {
        map.root = true;
        map.fixed_step = {root_step, root_step, root_step};
    }
    return maps;
}

std::vector<SafeRelighting::Bounds> bounds_of(const PageMap* decoded, const Atlas& atlas) {
    const std::vector<float> flat = parameters_of(maps_of_bounds(), {decoded, 2}, atlas);
    std::vector<SafeRelighting::Bounds> bounds(atlas.texel_count());
    for (size_t t = 0; t < bounds.size(); ++t) bounds[t] = {Vec3f::Map(&flat[6 * t]), Vec3f::Map(&flat[6 * t + 3])};
    return bounds;
}

PageMap block_map(const BasisBlocks& blocks, const Atlas& atlas) {
    std::vector<float> numbers;
    for (uint32_t t = 0; t < atlas.texel_count(); ++t)
        numbers.push_back(atlas.usable(t) ? float(blocks.block_at(atlas.position(t))) : 0);
    const TexelMap number{"block", {"number"}, 0};
    PageMap map = parameter_maps({&number, 1}, numbers, atlas)[0];
    map.fixed_step = {1, 1, 1};
    return map;
}

namespace {

std::vector<TexelMap> maps_of_view_bounds() { return {{"mean", map_channels(), 0}, {"reach", map_channels(), 3}}; }

/// Bounds of each texel as maps; of vertices, which photographs show them.
void add_view_bounds(PageModel& page, const Dataset& dataset, const std::vector<uint32_t>& training,
                     std::shared_ptr<const SafeViews> bounds) {
    std::vector<float> numbers;
    for (const SafeViews::Bounds& b : bounds->all_bounds()) {
        numbers.insert(numbers.end(), b.mean.begin(), b.mean.end());
        numbers.insert(numbers.end(), b.reach.begin(), b.reach.end());
    }
    page.defines.emplace_back("MEAN_MAP", std::to_string(page.maps.size()));
    // Coarse, as they count off the photographs alone, and would take a third of a page.
    constexpr float mean_step = 4.0f / 255, reach_step = 16.0f / 255;
    for (PageMap& map : parameter_maps(maps_of_view_bounds(), numbers, *page.atlas)) {
        map.root = !shows_stored_srgb(dataset, bounds->space());
        float white = 0;
        for (const float value : map.image.values) white = std::max(white, stored_number(map, value));
        const float step = std::max(1e-6f, white * (map.name.starts_with("mean") ? mean_step : reach_step));
        map.fixed_step = {step, step, step};
        page.maps.push_back(std::move(map));
    }
    constexpr size_t bits = 16;  // of a number, four to an entry
    const size_t entries = (training.size() + 4 * bits - 1) / (4 * bits);
    PageTable cameras{"photographs", {}}, seen{"seen_from", {}}, spacing{"photograph_spacing", {}};
    std::vector<size_t> place(dataset.views.size(), 0);
    for (size_t i = 0; i < training.size(); ++i) {
        place[training[i]] = i;
        const Vec3f eye = dataset.views[training[i]].camera.center().cast<float>();
        cameras.entries.insert(cameras.entries.end(), {eye.x(), eye.y(), eye.z(), 0});
    }
    for (const std::vector<uint32_t>& views : bounds->views_of_vertices()) {
        std::vector<uint32_t> numbers_of_bits(4 * entries, 0);
        for (const uint32_t v : views) numbers_of_bits[place[v] / bits] |= 1u << (place[v] % bits);
        seen.entries.insert(seen.entries.end(), numbers_of_bits.begin(), numbers_of_bits.end());
    }
    for (const float each : bounds->spacings()) spacing.entries.insert(spacing.entries.end(), {each, 0, 0, 0});
    page.tables.push_back(std::move(cameras));
    page.tables.push_back(std::move(spacing));
    page.tables.push_back(std::move(seen));
    page.defines.emplace_back("SEEN_ENTRIES", std::to_string(entries));
    page.whole_uniforms.emplace_back("photograph_count", int(training.size()));
    page.uniforms.push_back({"apart", {float(SafeViews::apart)}});
    page.uniforms.push_back({"fade", {float(SafeViews::fade)}});
    page.uniforms.push_back({"bound_from", {float(SafeViews::bound_from)}});
    page.uniforms.push_back({"bound_within", {float(SafeViews::bound_within)}});
    page.uniforms.push_back({"most", {SafeViews::most}});
    page.shown = [shown = std::move(page.shown), bounds](const std::vector<PageMap>& decoded) {
        ShownMaps out = shown(decoded);
        out.contestant = safe_contestant_of(bounds, std::move(out.contestant));
        return out;
    };
}

}  // namespace

PageModel page_model_of(Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    PageModel page = std::visit(
        [&](const auto& m) {
            if constexpr (requires { page_model_of(m.fit, dataset.mesh); })
                return page_model_of(m.fit, dataset.mesh);
            else if constexpr (requires { page_model_of(m.fit, *m.atlas); })
                return page_model_of(m.fit, *m.atlas);
            else
                return page_model_of(m.fit, *m.atlas, dataset, fitted_views(dataset, m.fit));
        },
        fitted.model);
    if (auto bounds = safe_views_of(fitted))
        add_view_bounds(page, dataset, fitted_views(dataset, fitted.record()), std::move(bounds));
    return page;
}

}  // namespace radiafit::tools
