#pragma once
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "eval/contestant.h"
#include "fit/fit_maps.h"
#include "fit/texel_fit.h"
#include "image/exr.h"

/// What a page needs to show a fit, whatever its family: maps, tables and numbers for shaders/view, and the way back
/// from maps as the page has them to what the judge compares.
namespace radiafit::tools {

/// Which texture of the page a map is in: all of one place have the same size.
enum class MapPlace { surface, view };

/// Numbers of the fit as an image of up to three channels. Zeros stay zeros.
struct PageMap {
    std::string name;
    MapPlace place = MapPlace::surface;
    ExrImage image = {};
    bool root = false;     ///< stored as signed square roots, so that small values have finer steps
    bool one_unit = true;  ///< the channels have one unit, and so one step
    /// Each channel's step as stored; 0: as fine as what it shows asks for (publish/steps.h), but not above most_step.
    std::array<float, 3> fixed_step{};
    float most_step = std::numeric_limits<float>::infinity();
};

/// Numbers that are stored as they are: [entries][4].
struct PageTable {
    std::string uniform;  ///< of the shader
    std::vector<float> entries;
};

/// How decoded maps look.
struct ShownMaps {
    Contestant contestant;
    /// Has the contestant show another state of one of those maps whose steps follow from what they show. Empty: all
    /// are to be shown anew.
    std::function<void(size_t map, const PageMap& decoded)> change = {};
};

struct PageModel {
    std::string shader = {};         ///< shaders/view/SHADER.frag
    std::string vertex_shader = {};  ///< its values at vertices, SHADER.frag; empty: none
    int vertex_entries = 0;          ///< of each vertex's values
    std::vector<std::pair<std::string, std::string>> defines = {};  ///< of both
    std::vector<PageMap> maps = {};                                 ///< in the order in which the shader numbers them
    std::vector<PageTable> tables = {};
    std::vector<std::pair<std::string, std::vector<float>>> uniforms = {};  ///< floats: 1, 3 or 4 of them
    std::vector<std::pair<std::string, int>> whole_uniforms = {};
    std::vector<std::string> terms = {};  ///< names of what can be left out of the sum
    std::string residual_unit = {};       ///< of the second channel of what is known of a site
    std::vector<uint8_t> sides = {};      ///< [triangles] of tiles; empty: all have largest_side
    int largest_side = 0;                 ///< 0: over a grid
    const Atlas* atlas = nullptr;         ///< of the surface's maps; the fit's, or kept by `shown`
    /// To a Lambertian colour, beyond the lamps that were fitted; else it is carried over from the nearest of them.
    bool fades = true;
    float most_uncertainty = 0;  ///< where the scale of the map of uncertainty ends; 0: there is none
    /// How these maps look, decoded and in the same order. It owns what it needs but for the fit and its dataset.
    std::function<ShownMaps(const std::vector<PageMap>& maps)> shown = {};
};

/// `contestant`, which keeps `owner` alive.
Contestant kept_alive(Contestant contestant, std::shared_ptr<const void> owner);

/// log2(1 + samples) and root mean square residual [texels], as a map.
PageMap knowledge_map(const FitRecord& fit, const Atlas& atlas);
/// The root mean square of 3 x samples residuals, whose squares have the sum 2 x error.
float root_mean_square(float error, uint32_t samples);

/// Maps of parameters [texels][numbers of all `maps`], at most three channels each: a longer one becomes several.
std::vector<PageMap> parameter_maps(std::span<const TexelMap> maps, std::span<const float> parameters,
                                    const Atlas& atlas);
/// `maps` as parameter_maps() cuts them.
std::vector<TexelMap> pieces_of(std::span<const TexelMap> maps);
/// The way back from the first of `decoded`.
std::vector<float> parameters_of(std::span<const TexelMap> maps, std::span<const PageMap> decoded, const Atlas& atlas);

/// Of a fit with colours by view direction: its parameters by these maps, the first of a page's.
template <class Fit, class AtlasOfFit>
std::function<ShownMaps(const std::vector<PageMap>&)> shown_by_view(const Fit& fit, const AtlasOfFit& atlas,
                                                                    std::vector<TexelMap> maps) {
    return [&fit, &atlas, pieces = pieces_of(maps)](const std::vector<PageMap>& decoded) {
        const auto shown = std::make_shared<Fit>(fit);
        const auto change = [shown, &atlas, pieces](size_t map, const PageMap& other) {
            take_parameter_image(other.image, atlas, pieces.at(map), shown->parameters);
        };
        for (size_t m = 0; m < pieces.size(); ++m) change(m, decoded[m]);
        return ShownMaps{kept_alive(contestant_of(*shown, atlas), shown), change};
    };
}

}  // namespace radiafit::tools
