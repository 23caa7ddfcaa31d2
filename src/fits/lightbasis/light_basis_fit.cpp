#include "lightbasis/light_basis_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/choose.h"
#include "base/error.h"
#include "base/json.h"
#include "dataset/view_directions.h"
#include "eval/texel_of_pixel.h"
#include "fit/fit_maps.h"
#include "geometry/direction_hull.h"
#include "geometry/shortest_turn.h"
#include "image/exr.h"

namespace radiafit::fits {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* basis_name = "basis.exr";

std::array<int, 2> size_of(const LightBasis& basis) { return {1 + basis.rank, int(basis.rows() * basis.cubes.size())}; }

/// What the middle of the surface sees of views.
struct FromCentre {
    Vec3d centre;
    std::vector<Vec3d> lamps, cameras;

    FromCentre(const Dataset& dataset, const std::vector<uint32_t>& views)
        : centre(surface_centre(dataset.mesh, dataset.grid)) {
        for (const uint32_t v : views) {
            lamps.push_back(lamp_of(dataset.views[v]));
            cameras.push_back(camera_of(dataset.views[v]));
        }
    }
    Vec3d lamp_of(const View& view) const { return view.light->direction_from(centre); }
    Vec3d camera_of(const View& view) const { return view.direction_to_camera(centre); }
    InwardTurns turns(const View& view) const {
        return {turn_between(lamp_of(view), lamps), turn_between(camera_of(view), cameras)};
    }

private:
    static Eigen::Matrix3f turn_between(const Vec3d& direction, const std::vector<Vec3d>& others) {
        const Vec3d inside = nearest_inside(others, direction);
        return shortest_turn(direction, inside).toRotationMatrix().cast<float>();
    }
};

/// What texels show under a view's lamp.
class LitTexels {
public:
    LitTexels(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
              const std::vector<uint32_t>& training, std::vector<SafeRelighting::Bounds> bounds)
        : fit_(&fit),
          atlas_(&atlas),
          texel_of_(atlas),
          functions_(fit.basis, double(fit.basis.smoothing)),
          training_(dataset, training) {
        if (!fit.underneath) return;
        underneath_ = underneath_of(fit);
        safe_ = bounds.empty()
                    ? std::make_unique<SafeRelighting>(dataset, training, atlas, underneath_)
                    : std::make_unique<SafeRelighting>(dataset, training, atlas, underneath_, std::move(bounds));
    }

    void shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const {
        rgb.assign(3 * pixels.size(), 0.0f);
        const InwardTurns inward = training_.turns(view);
        const auto share = float(share_of_fit(view));
        Functions functions;
        for (size_t i = 0; i < pixels.size(); ++i)
            if (pixels[i].triangle != no_triangle)
                Vec3f::Map(&rgb[3 * i]) = light_of(texel_of_(pixels[i]), view, inward, share, functions);
    }

    double share_of_fit(const View& view) const {
        if (safe_) return safe_->share_of_fit(view);
        double outside = angle_outside(training_.lamps, training_.lamp_of(view));
        if (fit_->basis.by_half())
            outside = std::max(outside, angle_outside(training_.cameras, training_.camera_of(view)));
        return SafeRelighting::share_at(outside);
    }

private:
    /// Mean and functions of a block under a lamp; neighbouring pixels mostly have the same.
    struct Functions {
        size_t block = SIZE_MAX;
        LampAndHalf lit = {Vec3f::Zero()};
        Eigen::Matrix<float, 3, Eigen::Dynamic> at;  ///< [channel][1 + rank]
    };

    void evaluate(size_t block, const LampAndHalf& lit, Functions& functions) const {
        if (functions.block == block && functions.lit == lit) return;
        functions = {block, lit, functions_.at(block, lit)};
    }

    /// share: of the fit, which fades with the model underneath; a basis by itself does not.
    Vec3f light_of(uint32_t texel, const View& view, const InwardTurns& inward, float share,
                   Functions& functions) const {
        const LightBasis& basis = fit_->basis;
        const Vec3f position = atlas_->position(texel), normal = atlas_->normal(texel);
        const Vec3f direction = view.light->direction_from(position.cast<double>()).cast<float>();
        const Vec3f inside = inward.lamp * direction;
        const Vec3f to_camera = view.direction_to_camera(position.cast<double>()).cast<float>();
        const Frame frame = basis.frame_of(normal);
        const Vec3f facing = basis.frame ? frame.normal : normal;
        if (!basis.frame && !(normal.dot(direction) > 0)) return Vec3f::Zero();
        evaluate(basis.block_at(position), inward.turned(basis, frame, direction, to_camera), functions);
        const Eigen::Map<const Eigen::VectorXf> z(&fit_->parameters[size_t(texel) * fit_->numbers()], basis.rank);
        Vec3f value = functions.at.col(0) + functions.at.rightCols(basis.rank) * z;
        const float darker = direction == inside
                                 ? 1.0f
                                 : std::min(most_bright, std::max(0.0f, facing.dot(direction)) /
                                                             std::max(least_cosine, facing.dot(inside)));
        const Vec3f irradiance = view.light->irradiance_at(position.cast<double>()).cast<float>();
        if (safe_) {
            const Vec3f under = basis.value_of(safe_->colour_of(texel, view, share), irradiance);
            return basis.light_of((under + share * darker * value).cwiseMax(0.0f), irradiance);
        }
        return darker * basis.light_of(value.cwiseMax(0.0f), irradiance);
    }

    const LightBasisFit* fit_;
    const Atlas* atlas_;
    TexelOfPixel texel_of_;
    LampFunctions functions_;
    FromCentre training_;
    ReflectanceFit underneath_;
    std::unique_ptr<const SafeRelighting> safe_;  ///< of the model underneath; null: there is none
};

void take_half_vectors(const Json& own, LightBasis& b) {
    b.half_length = own.at("half_length").get<float>();
    b.half_share = own.at("half_share").get<float>();
    const Json& halves = own.at("halves");
    if (!(b.half_length > 0) || !(b.half_share > 0 && b.half_share <= 1) || halves.size() != b.lamps.size())
        throw std::runtime_error("its half vectors are not as many as its lamps, or their length or share is none");
    for (size_t i = 0; i < b.lamps.size(); ++i) b.lamps[i].half = vector_of(halves.at(i));
}

}  // namespace

InwardTurns turns_inside(const Dataset& dataset, const std::vector<uint32_t>& training, const View& view) {
    return FromCentre(dataset, training).turns(view);
}

std::string description_of(const LightBasis& basis) {
    Json own = {{"rank", basis.rank},
                {"noise", double(basis.noise)},
                {"curve", name_of(basis.curve)},
                {"length", double(basis.length)},
                {"smoothing", double(basis.smoothing)},
                {"white", numbers_of(basis.white)},
                {"up", numbers_of(basis.up)}};
    if (basis.frame)
        own["frame"] = {numbers_of(basis.frame->tangent), numbers_of(basis.frame->bitangent),
                        numbers_of(basis.frame->normal)};
    own["lamps"] = Json::array();
    for (const LampAndHalf& at : basis.lamps) own["lamps"].push_back(numbers_of(at.lamp));
    if (basis.by_half()) {
        own["half_length"] = double(basis.half_length);
        own["half_share"] = double(basis.half_share);
        own["halves"] = Json::array();
        for (const LampAndHalf& at : basis.lamps) own["halves"].push_back(numbers_of(at.half));
    }
    own.update(parse_json<Json>(description_of(static_cast<const BasisBlocks&>(basis))));
    return json_text(own);
}

LightBasis described_light_basis(const std::string& json) {
    const Json own = parse_json<Json>(json);
    LightBasis b{described_blocks(json)};
    b.rank = own.at("rank").get<int>();
    b.noise = own.at("noise").get<float>();
    check_options(LightBasisOptions{.rank = b.rank});
    if (!(b.noise > 0)) throw std::runtime_error("its noise is no number above 0");
    b.curve = choose("curve", own.at("curve").get<std::string>(), value_curves());
    b.length = own.at("length").get<float>();
    b.smoothing = own.at("smoothing").get<float>();
    for (const Json& lamp : own.at("lamps")) b.lamps.push_back({vector_of(lamp)});
    if (b.lamps.empty() || b.lamps.size() > most_reference_lamps || !(b.length > 0) || !(b.smoothing > 0))
        throw std::runtime_error("its lamps are none or too many, or its length or smoothing is no number above 0");
    if (own.contains("half_length")) take_half_vectors(own, b);
    b.white = vector_of(own.at("white"));
    b.up = vector_of(own.at("up"));
    if (own.contains("frame"))
        b.frame =
            Frame{vector_of(own.at("frame").at(0)), vector_of(own.at("frame").at(1)), vector_of(own.at("frame").at(2))};
    return b;
}

ReflectanceFit underneath_of(const LightBasisFit& fit) {
    ReflectanceFit out;
    static_cast<FitRecord&>(out) = fit;
    out.options.model = fit.underneath;
    out.options.surface_side = fit.surface_side;
    const size_t numbers = fit.numbers(), own = size_t(fit.underneath->parameters);
    for (size_t first = numbers - own; first < fit.parameters.size(); first += numbers)
        out.parameters.insert(out.parameters.end(), &fit.parameters[first], &fit.parameters[first] + own);
    return out;
}

std::vector<TexelMap> maps_of(const LightBasisFit& fit) {
    static const std::vector<std::string> channels = {"R", "G", "B"};
    std::vector<TexelMap> maps;
    for (int k = 0; k < fit.basis.rank; k += 3) {
        const auto count = std::min(3, fit.basis.rank - k);
        maps.push_back({fmt::format("z{:02}.exr", k), {channels.begin(), channels.begin() + count}, size_t(k)});
    }
    if (fit.underneath)
        for (TexelMap map : maps_of(*fit.underneath)) {
            map.file = "underneath_" + map.file;
            map.first += size_t(fit.basis.rank);
            maps.push_back(std::move(map));
        }
    return maps;
}

void write_fit(const std::filesystem::path& folder, const LightBasisFit& fit, const Atlas& atlas,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    Json own = {{"surface_side", fit.surface_side}};
    if (fit.underneath) own["underneath"] = fit.underneath->name;
    own.update(parse_json<Json>(description_of(fit.basis)));
    write_texel_fit(folder, fit, {light_basis_name, light_basis_name, json_text(own)}, atlas, maps_of(fit),
                    fit.parameters, [&](const auto& place) {
                        const auto [width, height] = size_of(fit.basis);
                        write_exr(place / basis_name, {width, height, {"coefficient"}, fit.basis.numbers, {}});
                        if (add_files) add_files(place);
                    });
}

StoredLightBasis read_light_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    StoredLightBasis stored;
    LightBasisFit& fit = stored.fit;
    const TakeNotes take = [&](const std::string& model, const std::string& own) {
        if (model != light_basis_name) throw std::runtime_error("its model is no light basis");
        const Json notes = parse_json<Json>(own);
        fit.surface_side = notes.at("surface_side").get<int>();
        if (notes.contains("underneath")) {
            const auto name = notes.at("underneath").get<std::string>();
            fit.underneath = find_texel_model(name);
            if (!fit.underneath) throw std::runtime_error("there is no model " + name + " to be underneath");
        }
        fit.basis = described_light_basis(own);
    };
    TexelFitReader reader(folder, light_basis_name, take, fit);
    fit.basis.numbers = read_exr(folder / basis_name, {"coefficient"}, size_of(fit.basis)).values;
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    require_lights(*stored.dataset);
    stored.atlas = texel_atlas(*stored.dataset, fit.surface_side);
    fit.parameters = reader.maps(*stored.atlas, maps_of(fit));
    return stored;
}

Contestant contestant_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                         const std::vector<uint32_t>& training, std::vector<SafeRelighting::Bounds> bounds) {
    const auto lit = std::make_shared<const LitTexels>(fit, atlas, dataset, training, std::move(bounds));
    return {
        [lit](const View& view, const auto& pixels, std::vector<float>& rgb, int) { lit->shade(view, pixels, rgb); },
        TargetSpace::linear, [lit](const View& view) { return lit->share_of_fit(view); }};
}

}  // namespace radiafit::fits
