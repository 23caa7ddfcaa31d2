#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "capture/image_set.h"
#include "lamps/sphere_lamps.h"
#include "lamps/surface_samples.h"

/// Images that show one surface pixel on pixel, read as light for what is found of their lamps.
namespace radiafit::tools {

/// Of a surface in the plane z = 0 (lamps/sphere_lamps.h: PictureFrame), each under a lamp of its own.
struct LitImages {
    std::filesystem::path folder;  ///< for messages
    std::vector<std::filesystem::path> files;
    ImageSetFormat format;             ///< they are read at the files' size
    std::vector<uint8_t> mask;         ///< [file_height][file_width], 0: no surface there; empty: all is
    double width = 0;                  ///< what an image covers, world units
    std::optional<Vec3d> eye;          ///< where the camera is; none: far away along z
    std::vector<Vec3d> intensities{};  ///< [images] Light::intensity, where these are known; empty: to be found

    PictureFrame frame() const { return {format.file_width, format.file_height, width / format.file_width, eye}; }
};

/// Reads them at the files' size. `images` must outlive it.
class LitReader {
public:
    explicit LitReader(const LitImages& images);

    /// Throws UserError as read_packed() does.
    PackedImage read(size_t i) const { return read_packed(images_->files[i], format_, images_->mask); }
    /// Mean of the channels, of all pixels whatever mask they have.
    LuminanceImage luminance(const PackedImage& image) const;
    /// Linear light; not a number where the pixel is masked, or may be clipped.
    std::array<float, 3> rgb(const PackedImage& image, size_t pixel) const;

private:
    const LitImages* images_;
    ImageSetFormat format_;
    StoredLight light_;
};

/// Some thousand pixels, evenly spread over what the mask has and no sphere shadows, in square patches.
class SurfacePixels {
public:
    SurfacePixels(const LitImages& images, const std::vector<Circle>& spheres);

    /// Keeps what image i shows there. Different images may be taken at the same time.
    void take(size_t i, const LitReader& reader, const PackedImage& image);
    /// Of `which` of the images, all of them taken.
    SurfaceSamples samples(const std::vector<uint32_t>& which, const PictureFrame& frame) const;

private:
    std::vector<size_t> pixels_;
    std::vector<uint32_t> patches_;
    std::vector<std::vector<float>> values_;  ///< [images][pixels][3]
};

/// Whether a place lies on one of the circles, made larger by a factor.
bool within(const std::vector<Circle>& circles, const Vec2d& place, double factor);

}  // namespace radiafit::tools
