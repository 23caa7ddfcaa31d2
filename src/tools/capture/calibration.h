#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/lens.h"
#include "capture/pose_form.h"
#include "geometry/camera.h"

/// What any reader of calibrated photographs returns: COLMAP models, transforms.json, poses_bounds.npy.
namespace radiafit::tools {

/// From another frame to the calibration's.
struct KnownTransform {
    Mat3d linear = Mat3d::Identity();
    Vec3d shift = Vec3d::Zero();
    std::string cure;  ///< the option that applies it
};

/// What a calibration says of frames, beside its poses.
struct FrameHints {
    std::optional<KnownTransform> known_transform = {};  ///< of a frame that meshes may be in
    PoseForm poses = colmap_poses;                       ///< as its file writes them
};

struct CalibratedImage {
    std::string name;                 ///< relative to the folder of images; may hold a subfolder
    Camera camera;                    ///< of the whole photograph, at the size that was calibrated; of one that is not
                                      ///< there, its size may be 0
    bool held_out = false;            ///< the calibration itself says so
    std::filesystem::path file = {};  ///< the photograph; empty: not looked for yet, or not there
    std::filesystem::path mask = {};  ///< the calibration names this file; empty: none
    uint64_t id = 0;                  ///< COLMAP's IMAGE_ID, by which its points name it
    std::optional<Lens> lens = {};    ///< distorts what `camera` would show as a pinhole; none: a pinhole
};

struct Calibration {
    std::string origin;                   ///< what wrote it, such as COLMAP
    std::filesystem::path cameras_file;   ///< has sizes and lenses; for messages
    std::filesystem::path images_file;    ///< names the photographs; for messages
    std::string size_cure;                ///< what to do about a photograph of another size than calibrated
    std::vector<CalibratedImage> images;  ///< sorted by name, none twice, one at least
    FrameHints hints = {};
    std::vector<std::string> remarks;  ///< what a user may want to know of how it was read
};

inline constexpr int largest_calibrated_side = 1 << 16;  ///< pixels; anything beyond is a broken file

/// Sorts the images by name. Throws UserError if there is none, or a name occurs twice.
void sort_images(Calibration& calibration);

/// Finds the photographs (capture/image_finder.h): sets their files, and for names those of the files in `images`, by
/// which they are sorted then. Of those that are not there, `skip_missing` leaves out and says so in `notes`. Throws
/// UserError for a photograph that is not there, or if none is; for two names of one photograph; for what cannot be
/// read.
void locate_photographs(Calibration& calibration, const std::filesystem::path& images, bool skip_missing,
                        std::vector<std::string>& notes);

/// A camera's pose from its axes in the world, the columns right, down and forward, and its centre. Axes that were
/// rounded are made orthonormal. Throws UserError, prefixed by `where`, for axes that are not finite, or more than 1e-3
/// from a rotation.
void set_pose(Camera& camera, const Mat3d& axes, const Vec3d& centre, const std::string& where);

}  // namespace radiafit::tools
