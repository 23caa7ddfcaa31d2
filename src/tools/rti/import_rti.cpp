#include "rti/import_rti.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/resources.h"
#include "base/wording.h"
#include "dataset/stream_views.h"
#include "fitting/family.h"
#include "rti/rti_fit.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

struct MadeLamp {
    Vec3d direction;
    bool held_out;
};

/// Down to near the horizon, so that no lamp is far outside of all; and dense enough that the brightest that a texel is
/// under them says how bright it gets (SafeRelighting::most).
std::vector<MadeLamp> made_lamps() {
    struct Ring {
        int lamps, held_out;
        double elevation;  ///< degrees
    };
    constexpr Ring rings[] = {{1, -1, 90}, {6, 2, 60}, {8, 5, 30}, {9, 4, 3}};
    std::vector<MadeLamp> out;
    for (const Ring& ring : rings)
        for (int i = 0; i < ring.lamps; ++i) {
            const double elevation = ring.elevation * std::numbers::pi / 180;
            const double azimuth = 2 * std::numbers::pi * (i + 0.25) / ring.lamps;
            out.push_back({Vec3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation)),
                           i == ring.held_out});
        }
    return out;
}

/// [height][width][3] what the file shows, as sRGB stores it in 8 bits.
void show(const RtiFile& file, const Vec3d& lamp, std::vector<uint8_t>& rgb) {
    const Eigen::MatrixXf at = file.functions(lamp).cast<float>();
    const auto numbers = Eigen::Index(file.numbers);
    rgb.resize(3 * file.values.size() / file.numbers);
    for (size_t p = 0; p < rgb.size() / 3; ++p) {
        const Eigen::Map<const Eigen::VectorXf> z(&file.values[p * file.numbers], numbers);
        const Vec3f value = at.col(0) + at.rightCols(numbers) * z;
        for (int c = 0; c < 3; ++c) {
            const float stored =
                file.curve == ValueCurve::srgb ? value[c] : srgb_encode(from_curve(file.curve, value[c]));
            rgb[3 * p + size_t(c)] = uint8_t(std::lround(255 * std::clamp(stored, 0.0f, 1.0f)));
        }
    }
}

constexpr const char* made_from = "images that were made from another program's file";

/// Throws UserError where a dataset of other images is, which made ones would replace.
void check_made(const fs::path& images) {
    if (!fs::exists(images / "dataset.json")) return;
    if (open_dataset(images).description.find(made_from) == std::string::npos)
        throw UserError(fmt::format(
            "{}: a dataset is there that was not made from a file; choose another output, or give {}, if the file was "
            "made of it",
            images.string(), option_name("dataset")));
}

Dataset make_images(const RtiFile& file, const RtiImportOptions& options, DatasetWriter& writer) {
    const std::vector<MadeLamp> lamps = made_lamps();
    stream_views("making images", lamps.size(), writer, [&](size_t i, int, PackedImage& image) {
        show(file, lamps[i].direction, image.pixels);
        View view;
        view.name = fmt::format("lamp_{:02}", i);
        view.camera.width = file.width;
        view.camera.height = file.height;
        view.camera_direction = Vec3d::UnitZ();
        view.light = Light{Light::Kind::distant, lamps[i].direction, Vec3d::Ones()};
        view.held_out = lamps[i].held_out;
        return view;
    });
    Dataset header;
    header.grid = Grid::centered(file.width, file.height, 1);
    header.name = options.images.filename().string();
    header.description =
        fmt::format("{} {} ({}), no photographs; camera fixed and distant", lamps.size(), made_from, file.kind);
    header.source = fmt::format("what {} shows", options.file.string());
    writer.finish(header);
    return open_dataset(options.images);
}

/// Of the file's values, the fit's, and the maps on their way to the disk.
Needs needs_of(const RtiImportOptions& options, int width, int height, size_t numbers) {
    const uint64_t pixels = uint64_t(width) * uint64_t(height), values = pixels * numbers * sizeof(float);
    Needs needs;
    std::error_code error;
    const uint64_t file = fs::file_size(options.file, error);
    needs.memory = 3 * values + 100 * pixels + (error ? 0 : file);
    needs.disk = values + 16 * pixels + (options.dataset.empty() ? made_lamps().size() * 3 * pixels : 0);
    return needs;
}

}  // namespace

RtiImportReport import_rti(const RtiImportOptions& options, const fs::path& out) {
    check_fit_target(out);
    std::optional<DatasetWriter> writer;
    if (options.dataset.empty()) {
        check_made(options.images);
        writer.emplace(options.images);
    }
    std::optional<Dataset> dataset;
    if (!writer) dataset = open_dataset(options.dataset);
    RtiFile file = read_rti(options.file, [&](int width, int height, size_t numbers) {
        announce_needs("import", needs_of(options, width, height, numbers), out, options.force);
    });
    file.curve = options.curve.value_or(file.curve);
    if (writer)
        dataset = make_images(file, options, *writer);
    else
        check_rti_dataset(file, options.file, *dataset);
    RtiFit made = fit_of(file, *dataset);
    made.fit.record().provenance_json = options.provenance_json;
    fits::write_fit(out, made.fit, {});
    return {file.kind, fitted_model(out), file.width, file.height, dataset->folder, made.difference};
}

}  // namespace radiafit::tools
