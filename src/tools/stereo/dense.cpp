#include "stereo/dense.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/journal.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/resources.h"
#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "stereo/agreement.h"
#include "stereo/patch_match.h"
#include "stereo/region.h"
#include "stereo/source_views.h"
#include "stereo/stereo_folder.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

std::vector<Camera> cameras_of(const Calibration& model) {
    std::vector<Camera> cameras;
    for (const CalibratedImage& image : model.images) cameras.push_back(image.camera);
    return cameras;
}

std::vector<Pyramid> read_pyramids(const Calibration& model, const fs::path& folder) {
    std::vector<Pyramid> pyramids(model.images.size());
    parallel_for(pyramids.size(), 1, [&](size_t i, int) {
        const CalibratedImage& image = model.images[i];
        const fs::path file = folder / image.name;
        const auto check = [&](int width, int height) {
            if (width != image.camera.width || height != image.camera.height)
                throw UserError(fmt::format("{}: {} x {} pixels, but {} calibrates {} x {}: {}", file.string(), width,
                                            height, model.cameras_file.string(), image.camera.width,
                                            image.camera.height, model.size_cure));
        };
        pyramids[i] = pyramid_of(grey_of(read_image(file, false, check), image.camera));
    });
    return pyramids;
}

/// Grey values of all sizes, planes before and after they are compared, costs of those at work.
Needs needs_of(const std::vector<Camera>& cameras) {
    Needs needs;
    for (const Camera& c : cameras) {
        const uint64_t pixels = uint64_t(c.width) * uint64_t(c.height);
        needs.memory += pixels * (4 * 4 / 3 + 2 * sizeof(InversePlane));
        needs.disk += pixels * 4 * sizeof(float);
    }
    needs.memory += needs.memory / cameras.size() * uint64_t(thread_count());
    return needs;
}

/// All that decides the maps before they are compared.
std::string key_of(const DenseOptions& options, const Calibration& model,
                   const std::vector<std::vector<uint32_t>>& sources) {
    uint64_t hash = hash_start;
    const auto add_file = [&](const fs::path& file, const char* what) {
        const std::string bytes = read_file(file, what);
        hash = hash_bytes(bytes.data(), bytes.size(), hash);
    };
    add_file(model.cameras_file, "COLMAP file");
    add_file(model.images_file, "COLMAP file");
    for (const CalibratedImage& image : model.images) add_file(options.images / image.name, "image");
    for (const auto& list : sources) hash = hash_bytes(list.data(), list.size() * sizeof(uint32_t), hash);
    return fmt::format("depths 1, region {}, cost {}, seed {}, data {:016x}", options.region, options.cost,
                       options.seed, hash);
}

/// What a run that was stopped finished, if it was to make the same maps.
Journal open_journal(const fs::path& file, const std::string& key) {
    std::error_code error;
    if (fs::is_regular_file(file, error)) {
        if (Journal::key_of(file) == key)
            log_info(fmt::format("{}: goes on from there", file.string()));
        else
            fs::remove(file, error);
    }
    constexpr double seconds_between_writes = 10;
    return {file, key, seconds_between_writes};
}

size_t pixels_within(const SearchBall& region, const Camera& camera) {
    size_t count = 0;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) count += inverse_depths(region, camera, x + 0.5, y + 0.5).has_value();
    return count;
}

}  // namespace

fs::path unfinished_depths(const fs::path& out) {
    return fs::path(out.has_filename() ? out : out.parent_path()).concat(".parts") / "depths.journal";
}

DenseReport compute_depths(const DenseOptions& options, const fs::path& out) {
    const Calibration model = read_colmap(options.model);
    const std::vector<Camera> cameras = cameras_of(model);
    const auto sources = choose_sources(cameras, read_colmap_points(options.model, model), size_t(options.sources));
    if (std::all_of(sources.begin(), sources.end(), [](const auto& list) { return list.size() < 2; }))
        throw UserError(
            fmt::format("{}: no photograph shares points with two others: take photographs that overlap more",
                        options.model.string()));
    const SearchBall region = region_of(cameras, options.region);
    AtomicFolder folder(out);
    announce_needs("depths", needs_of(cameras), out, options.force);
    const std::vector<Pyramid> pyramids = read_pyramids(model, options.images);

    const size_t count = cameras.size();
    DenseReport report;
    report.views.resize(count);
    std::vector<PlaneMap> maps(count);
    for (size_t i = 0; i < count; ++i)
        maps[i] = {cameras[i], std::vector<InversePlane>(pyramids[i][0].values.size(), InversePlane::Zero())};
    const fs::path unfinished = unfinished_depths(out);
    try {
        Journal journal = open_journal(unfinished, key_of(options, model, sources));
        Progress progress("depths of photographs", count);
        finish_blocks(
            &journal, count,
            [&](auto& visit, size_t i) { visit(std::span(maps[i].planes[0].data(), 3 * maps[i].planes.size())); },
            [&](size_t i, int) {
                std::vector<const Pyramid*> others;
                for (const uint32_t s : sources[i]) others.push_back(&pyramids[s]);
                if (others.size() >= 2)
                    maps[i] = match_patches(pyramids[i], others, region, float(options.cost), options.seed + i);
            },
            [&](size_t i) {
                report.views[i] = {model.images[i].name, sources[i].size(), pixels_within(region, cameras[i]),
                                   maps[i].known_count(), 0};
                progress.advance();
            });
    } catch (Interrupted& stop) {
        stop.note = fmt::format("{} keeps what is finished; the same command goes on from there", unfinished.string());
        throw;
    }
    std::vector<std::set<uint32_t>> compared(count);  // with which others; both ways
    for (uint32_t i = 0; i < count; ++i)
        for (const uint32_t s : sources[i]) compared[i].insert(s), compared[s].insert(i);
    std::vector<std::string> names;
    for (const CalibratedImage& image : model.images) names.push_back(image.name);
    parallel_for(count, 1, [&](size_t i, int) {
        std::vector<const PlaneMap*> others;
        for (const uint32_t s : compared[i]) others.push_back(&maps[s]);
        const PlaneMap agreed = agreed_planes(maps[i], others, options.agree);
        report.views[i].agreed = agreed.known_count();
        write_planes(folder.path(), names[i], agreed);
    });
    write_fusion_list(folder.path(), names);
    folder.commit();
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    fs::remove(unfinished.parent_path(), ignored);
    return report;
}

}  // namespace radiafit::tools
