#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Whether cameras that were found from photographs alone are good enough to go on with.
namespace radiafit::tools {

struct ModelCheck {
    struct Photograph {
        std::string name;
        bool registered = false;  ///< the model knows where it was taken
        size_t points = 0;        ///< of the model that it shows
    };
    std::vector<Photograph> photographs;  ///< by name
    size_t registered = 0;
    size_t points = 0;
    double reprojection_error = 0;  ///< pixels, mean over points
    double track_length = 0;        ///< photographs that show a point, mean
    /// What is too poor to go on, one line each: what is wrong, and what to do about it. Empty: good enough.
    std::vector<std::string> poor;
};

/// model: a COLMAP model of undistorted photographs, with its points; photographs: the folder that all were in. Poor
/// are: fewer than three of four photographs registered, a reprojection error above 1.5 pixels, tracks of fewer than
/// three photographs, or a registered photograph that shows fewer than 30 points. Throws UserError.
ModelCheck check_model(const std::filesystem::path& model, const std::filesystem::path& photographs);

}  // namespace radiafit::tools
