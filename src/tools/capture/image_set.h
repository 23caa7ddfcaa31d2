#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/picture_facts.h"
#include "dataset/stream_views.h"

/// Images of one surface that show it pixel on pixel: all of one size and depth.
namespace radiafit::tools {

/// What the images of a set share, learnt from the first.
struct ImageSetFormat {
    std::filesystem::path first;            ///< that image, for messages
    int width = 0, height = 0;              ///< pixels, of the dataset
    int file_width = 0, file_height = 0;    ///< of the files
    int bits = 8;                           ///< per channel: 8, 16 or 32 (floats)
    std::string transfer;                   ///< linear, srgb, or auto: as each file says
    Encoding encoding = Encoding::u8_srgb;  ///< of the dataset

    bool is_scaled() const { return width != file_width || height != file_height; }
};

/// transfer: linear or srgb, whatever the file says; or auto: what it says (capture/picture_colors.h), and where it
/// says nothing, srgb for 8 bits, else linear. depth: the bits per channel that all images were declared to have, or 0;
/// max_size: the longest side that a dataset's image may have, or 0. Throws UserError for another depth, and for floats
/// in sRGB.
ImageSetFormat learn_format(const std::filesystem::path& first, const std::string& transfer, int depth,
                            int max_size = 0);

/// A mask of the files' size, or none, at the dataset's.
std::vector<uint8_t> scaled_mask(const std::vector<uint8_t>& mask, const ImageSetFormat& format);

/// The mask, empty meaning all, less where an image's alpha is below one half.
std::vector<uint8_t> without_transparent(std::vector<uint8_t> mask, const std::vector<uint8_t>& alpha);

/// One image in the format's encoding and size. mask: of all images, [file_height][file_width], or empty; the image's
/// alpha, below one half, leaves out more. Throws UserError that names file and cure for another size or depth than
/// the first image's, and for a pixel that is not finite; where it is left out anyway, it becomes 0. facts: what the
/// file is taken for, if not null.
PackedImage read_packed(const std::filesystem::path& file, const ImageSetFormat& format,
                        const std::vector<uint8_t>& mask, PictureFacts* facts = nullptr);

/// Linear light of the values that packed images of a format hold.
class StoredLight {
public:
    explicit StoredLight(const ImageSetFormat& format);
    /// pixels: as PackedImage has them; i: of [height][width][3].
    float at(const std::vector<uint8_t>& pixels, size_t i) const;
    /// From here on light may have been more than could be stored; infinite where values are floats.
    float clipped() const { return clipped_; }

private:
    size_t bytes_;                     ///< per value
    const std::vector<float>* table_;  ///< of every stored value; null: floats
    float clipped_;
};

/// Throws UserError for a value of rgb [height][width][3] that is not finite, unless mask [height][width] (empty: none)
/// leaves its pixel out; then it becomes 0.
void require_finite(std::vector<float>& rgb, const std::vector<uint8_t>& mask, const std::filesystem::path& file,
                    int width);

}  // namespace radiafit::tools
