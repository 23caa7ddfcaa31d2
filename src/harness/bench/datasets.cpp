#include "bench/datasets.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/log.h"
#include "synthetic/synthetic.h"

namespace radiafit::harness {
namespace {

/// Enough images for what experiments take of the ornament: 12 to fit, 16 at the paper's scale, and those held out.
int ornament_images(const std::string& scale) { return scale == "paper" ? 19 : 14; }

std::vector<SyntheticOptions> datasets_of(const std::string& scale) {
    return {{.shape = "star", .scale = scale},
            {.shape = "bust", .scale = scale},
            {.shape = "ornament", .scale = scale, .views = ornament_images(scale)}};
}

Needs needs_of(const std::string& scale) {
    Needs needs;
    for (const SyntheticOptions& options : datasets_of(scale)) {
        const Needs one = synthetic_needs(options);
        needs.disk += one.disk;
        needs.memory = std::max(needs.memory, one.memory);
    }
    needs.memory += 8 * needs.disk;  // engines of several devices, each with its samples or its images
    return needs;
}

std::filesystem::path announced(const std::string& scale) {
    std::filesystem::path folder = std::filesystem::temp_directory_path();
    announce_needs("radiafit-bench", needs_of(scale), folder, true);
    return folder;
}

}  // namespace

BenchDatasets::BenchDatasets(const std::string& scale) : folder_(announced(scale), "radiafit-bench") {
    for (const SyntheticOptions& options : datasets_of(scale)) {
        log_info(fmt::format("making {}, {} scale", options.shape, scale));
        generate_synthetic(options, folder_.path() / options.shape);
        datasets_.push_back(open_dataset(folder_.path() / options.shape));
    }
}

}  // namespace radiafit::harness
