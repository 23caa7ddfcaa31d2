#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "geometry/surface_lookup.h"
#include "model/lfm.h"
#include "model/status.h"
#include "model/texel_options.h"

/// The FIT folder: what a fit leaves behind, readable with any JSON and EXR reader (docs/formats.md).
namespace radiafit {

/// Distinguishes datasets without reading their pixels.
struct DatasetFingerprint {
    uint64_t vertices = 0, triangles = 0, views = 0, held_out = 0, image_bytes = 0;
    std::string digest;  ///< 16 hexadecimal digits over mesh, cameras, split, gains and encoding
    bool operator==(const DatasetFingerprint&) const = default;
};
DatasetFingerprint fingerprint(const Dataset& dataset);

/// What every fit says, whatever its model.
struct FitRecord {
    TargetSpace space = TargetSpace::stored;         ///< the space of the model's values
    SurfaceLookup surface = SurfaceLookup::nearest;  ///< how texels of a mesh are looked up
    std::string solver, engine;

    // One entry per problem.
    std::vector<Status> status;
    std::vector<uint32_t> iterations;
    std::vector<uint32_t> samples;  ///< radiance samples that count in the problem
    std::vector<float> error;       ///< raw E = 1/2 sum r^2: no normalization, no penalty

    std::filesystem::path dataset_path;  ///< as the program may open it; saved relative to the fit folder
    std::string dataset_name;
    Encoding encoding = Encoding::u8_srgb;  ///< of the dataset
    DatasetFingerprint dataset_fingerprint;

    // JSON objects as text; empty means {}.
    std::string options_json;     ///< every resolved option of the run
    std::string provenance_json;  ///< command line, git revision, compiler, device, time
    std::string times_json;       ///< name -> seconds

    size_t problem_count() const { return status.size(); }
    std::array<uint64_t, size_t(Status::count)> status_counts() const;
};

/// Problem 3 * vertex + channel.
struct LightFieldFit : FitRecord {
    LfmOptions options;
    std::vector<float> parameters;  ///< LfmLayout order; the padding lane of every texel is not saved
};

/// A texel-local model over an atlas, a problem per texel.
struct ReflectanceFit : FitRecord {
    TexelOptions options;           ///< surface_side is that of a mesh's atlas, unused for a grid
    std::vector<float> parameters;  ///< [texels][options.model->parameters], canonical gauge
};

/// Fills dataset_path, dataset_name, encoding and dataset_fingerprint.
void set_dataset(FitRecord& fit, const Dataset& dataset);

/// Throws UserError if something other than a fit (or an empty folder) is at `folder`, or a fit to which somebody
/// added files. Call it before fitting.
void check_fit_target(const std::filesystem::path& folder);

/// Writes under a temporary name beside `folder`, then renames; an earlier fit there is replaced whole, and survives
/// any failure. `add_files` may put further files (trace.csv) into the folder it is handed.
/// Throws UserError when the folder cannot be written, std::invalid_argument when the fit's sizes disagree with the
/// mesh.
void write_fit(const std::filesystem::path& folder, const LightFieldFit& fit, const Mesh& mesh,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files = {});

struct StoredFit {
    LightFieldFit fit;
    Mesh mesh;  ///< what was fitted: a fit can be rendered without its dataset
};

/// Reads and checks everything. Throws UserError with one line that names the file and the cure.
StoredFit read_fit(const std::filesystem::path& folder);

/// The model that fit.json names: "lfm", or a texel-local model's name. Throws UserError if it can't be read.
std::string fitted_model(const std::filesystem::path& folder);

/// The same for reflectance. `atlas` is that of the fit's texels.
void write_fit(const std::filesystem::path& folder, const ReflectanceFit& fit, const Atlas& atlas,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files = {});
/// The dataset that was fitted, at the place that the fit names or at `moved_to`, its atlas, and the fit.
struct StoredReflectance {
    ReflectanceFit fit;
    std::unique_ptr<Dataset> dataset;
    std::unique_ptr<Atlas> atlas;
};
StoredReflectance read_reflectance(const std::filesystem::path& folder, const std::filesystem::path& moved_to = {});

/// Opens the dataset that the fit names, or the one at `moved_to`, and checks that it is the one that was fitted.
Dataset open_fitted_dataset(const FitRecord& fit, const std::filesystem::path& moved_to = {});

}  // namespace radiafit
