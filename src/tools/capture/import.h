#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The face of capture: what `radiafit import` calls.
namespace radiafit::tools {

struct ImportOptions {
    std::filesystem::path model;   ///< the calibration: folder of a COLMAP model, transforms.json, poses_bounds.npy
    std::filesystem::path images;  ///< folder of the photographs, 8 or 16 bits or floats
    std::filesystem::path mesh;    ///< surface, see capture/mesh_file.h
    std::string mesh_turn, mesh_shift;  ///< bring it into the model's frame, with mesh_scale (capture/mesh_placement.h)
    double mesh_scale = 1;
    bool apply_transform = false;  ///< then also by the transform that the calibration's file says was applied to it
    bool flip_faces = false;       ///< the mesh's faces turn inward
    std::filesystem::path masks;  ///< folder, white = object (names: capture/mask_names.h); empty: what the calibration
                                  ///< names, if anything
    std::string holdout;          ///< see capture/split.h; empty: what the calibration says, else every:8
    int max_size = 0;             ///< longest side of a photograph, pixels; 0: as it is
    /// auto, none, estimate, per-channel, or a table (see capture/gains.h). auto: one for each photograph where these
    /// explain the photographs better than gloss does (capture/gain_benefit.h), else none.
    std::string gains = "auto";
    /// Share of the masks' pixels that the mesh has to cover, without masks of all pixels; 0: any. Not given: 0.2 of
    /// the masks, or 0.01 of the pixels.
    std::optional<double> least_coverage;
    bool invert_masks = false;  ///< black = object
    bool skip_missing = false;  ///< go on without photographs that are calibrated and not there
    /// Whether photographs are turned as their EXIF orientation says: stored, never; apply, always; auto, where that
    /// gives the calibrated size and the stored pixels do not have it.
    std::string exif_orientation = "auto";
    std::string name;    ///< of the dataset; empty: the output folder's
    bool force = false;  ///< go on where memory or disk will not suffice
};

struct ImportReport {
    size_t images = 0;                  ///< in the model
    size_t training = 0, held_out = 0;  ///< written
    size_t vertices = 0, triangles = 0;
    std::vector<std::string> dropped;  ///< images that see nothing of the mesh
    std::vector<std::string> notes;    ///< what the user should know, one line each: defects, drops, guesses
    std::vector<std::string> remarks;  ///< what a user may want to know, and is no cause to worry
    std::vector<std::string> unlike;   ///< photographs that a note says do not belong where they are
    std::string undistortion;          ///< what was done to lenses, one line; empty: nothing
    double coverage = 0;               ///< see ImportOptions::least_coverage
};

/// Packs a capture that COLMAP calibrated (capture/colmap.h). Each photograph is cropped to what it shows of the mesh
/// inside the mask, plus four pixels; an alpha channel is a mask too. 8-bit photographs are stored as they are
/// (u8-srgb), in sRGB's colours (capture/picture_colors.h), unless their lens has distortion, which is taken out
/// (capture/undistort.h); one of 16 bits or of linear values makes the whole dataset u16-linear, one of floats
/// f32-linear. Everything is checked before the first image is written. Throws UserError; for a mesh that does not
/// belong where it is it says what is wrong with it (capture/capture_check.h).
ImportReport import_colmap(const ImportOptions& options, const std::filesystem::path& out);

/// The same for a NeRF's transforms.json, or the folder that has it (capture/transforms.h). `images`: what its paths
/// are relative to; empty: the file's folder. Without a rule, images of transforms_test.json beside it are held out;
/// with one, that file is not read.
ImportReport import_transforms(const ImportOptions& options, const std::filesystem::path& out);

/// The same for LLFF's poses_bounds.npy, or the folder that has it (capture/llff.h). `images` empty: the folder images
/// beside it.
ImportReport import_llff(const ImportOptions& options, const std::filesystem::path& out);

}  // namespace radiafit::tools
