#include "capture/colmap_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/error.h"
#include "base/read_file.h"
#include "base/text_file.h"
#include "capture/colmap_binary.h"

namespace radiafit::tools {
namespace {

/// Places of the images by their ids.
class ImagePlaces {
public:
    explicit ImagePlaces(const Calibration& calibration) : images_file_(calibration.images_file) {
        for (size_t i = 0; i < calibration.images.size(); ++i)
            places_.emplace(calibration.images[i].id, static_cast<uint32_t>(i));
    }
    uint32_t operator()(const std::string& where, uint64_t id) const {
        const auto place = places_.find(id);
        if (place == places_.end())
            throw UserError(
                fmt::format("{}: a point is seen by image {}, which {} does not hold: take both files from "
                            "one model",
                            where, id, images_file_.string()));
        return place->second;
    }

private:
    std::filesystem::path images_file_;
    std::unordered_map<uint64_t, uint32_t> places_;
};

void add_point(std::vector<SparsePoint>& points, const std::string& where, SparsePoint point) {
    if (!point.position.allFinite() || !std::isfinite(point.error))
        throw UserError(fmt::format("{}: a point is not finite (NaN or infinity): run `colmap mapper` again", where));
    if (point.images.empty())
        throw UserError(
            fmt::format("{}: a point has no track, the images that show it: take the model as COLMAP wrote it", where));
    std::sort(point.images.begin(), point.images.end());
    point.images.erase(std::unique(point.images.begin(), point.images.end()), point.images.end());
    points.push_back(std::move(point));
}

// POINT3D_ID X Y Z R G B ERROR, then the track: IMAGE_ID POINT2D_IDX ...
std::vector<SparsePoint> read_text(const std::filesystem::path& file, const ImagePlaces& place_of) {
    TextFile text(file, "list of points");
    std::vector<SparsePoint> points;
    for (std::string_view line; text.next_entry(line);) {
        const auto tokens = split_tokens(line);
        if (tokens.size() < 8 || tokens.size() % 2 != 0)
            text.fail("expected POINT3D_ID X Y Z R G B ERROR, then pairs IMAGE_ID POINT2D_IDX: correct the line");
        SparsePoint point;
        for (size_t i = 0; i < 3; ++i) point.position[int(i)] = text.to_double(tokens[1 + i], "a coordinate");
        point.error = text.to_double(tokens[7], "ERROR");
        for (size_t i = 8; i < tokens.size(); i += 2)
            point.images.push_back(place_of(text.where(), text.to_unsigned(tokens[i], "IMAGE_ID")));
        add_point(points, text.where(), std::move(point));
    }
    return points;
}

std::vector<SparsePoint> read_binary(const std::filesystem::path& path, const ImagePlaces& place_of) {
    ColmapBinary file(path);
    std::vector<SparsePoint> points;
    const auto count = file.get<uint64_t>();
    for (uint64_t i = 0; i < count; ++i) {
        file.set_entry(fmt::format("point {} of {}", i + 1, count));
        file.get<uint64_t>();  // POINT3D_ID
        SparsePoint point;
        for (int k = 0; k < 3; ++k) point.position[k] = file.get<double>();
        file.skip(3, 1);  // its colour
        point.error = file.get<double>();
        const auto track = file.get<uint64_t>();
        for (uint64_t k = 0; k < track; ++k) {
            point.images.push_back(place_of(path.string(), file.get<uint32_t>()));
            file.get<uint32_t>();  // POINT2D_IDX
        }
        add_point(points, path.string(), std::move(point));
    }
    file.expect_end();
    return points;
}

}  // namespace

std::vector<SparsePoint> read_colmap_points(const std::filesystem::path& folder, const Calibration& calibration) {
    const ImagePlaces place_of(calibration);
    const bool binary = calibration.images_file.extension() == ".bin";
    const std::filesystem::path file = folder / (binary ? "points3D.bin" : "points3D.txt");
    if (!path_exists(file))
        throw UserError(
            fmt::format("{}: no such file: take the whole model, with its points; cameras without points do for "
                        "an import alone",
                        file.string()));
    return binary ? read_binary(file, place_of) : read_text(file, place_of);
}

}  // namespace radiafit::tools
