#include "target.h"

namespace radiafit::fuzz {

// One line per file of targets.
std::vector<Target> config_targets();
std::vector<Target> batch_targets();
std::vector<Target> dataset_targets();
std::vector<Target> record_targets();
std::vector<Target> journal_targets();
std::vector<Target> image_targets();
std::vector<Target> mesh_targets();
std::vector<Target> text_targets();
std::vector<Target> colmap_targets();
std::vector<Target> calibration_targets();
std::vector<Target> stereo_targets();
std::vector<Target> rti_targets();
std::vector<Target> fit_targets();

std::vector<Target> targets() {
    std::vector<Target> all;
    for (const auto list :
         {config_targets, batch_targets, dataset_targets, record_targets, journal_targets, image_targets, mesh_targets,
          text_targets, colmap_targets, calibration_targets, stereo_targets, rti_targets, fit_targets})
        for (Target& target : list()) all.push_back(std::move(target));
    return all;
}

}  // namespace radiafit::fuzz
