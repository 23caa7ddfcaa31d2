#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fit/fit_folder.h"
#include "geometry/atlas.h"

/// The folder of a fit whose model is in texels, whichever it is: a problem per texel, and images in the atlas's 2-D
/// layout of its parameters (docs/formats.md).
namespace radiafit {

/// An image of some of a texel's parameters, from `first` on, one per channel; 0 where no texel is.
struct TexelMap {
    std::string file;
    std::vector<std::string> channels;
    size_t first;
};

/// What fit.json says of the model: its name, and under `key` a JSON object private to the model.
struct TexelFitNotes {
    std::string model, key, own_json;
    bool newer = false;  ///< what programs that know version 1 alone would read wrongly
};
using TakeNotes = std::function<void(const std::string& model, const std::string& own_json)>;

/// As write_fit(). parameters: [texels][numbers of all maps].
void write_texel_fit(const std::filesystem::path& folder, const FitRecord& fit, const TexelFitNotes& notes,
                     const Atlas& atlas, std::span<const TexelMap> maps, std::span<const float> parameters,
                     const std::function<void(const std::filesystem::path& temporary_folder)>& add_files);

/// Standard deviations of a fit: the parameters' in their order, [problems] a sample's, and [problems] how many
/// directions the samples don't determine.
struct ErrorBarMaps {
    std::span<const float> deviation, noise;
    std::span<const uint32_t> deficient;
};
/// deviation_NAME.exr for each of a model's maps, and error_bars.exr: noise, deficient.
void write_error_bars(const std::filesystem::path& folder, const Atlas& atlas, std::span<const TexelMap> maps,
                      const ErrorBarMaps& bars);

/// Reads a fit in two steps, as read_fit(): what fit.json says, and, once dataset and atlas are known by that, the
/// maps.
class TexelFitReader {
public:
    /// Fills `fit`, which must outlive the reader, but for its problems. What `take` throws is reported as a fault
    /// of fit.json.
    TexelFitReader(const std::filesystem::path& folder, const std::string& key, const TakeNotes& take, FitRecord& fit);
    /// The problems, and the parameters [texels][numbers of all maps].
    std::vector<float> maps(const Atlas& atlas, std::span<const TexelMap> maps);

private:
    std::filesystem::path folder_;
    FitRecord* fit_;
    std::array<uint64_t, size_t(Status::count)> status_counts_;  ///< as fit.json has them
};

}  // namespace radiafit
