#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "dataset/dataset.h"

namespace radiafit {

/// Where every load() gets its pixels from.
enum class StreamSource {
    disk,       ///< read from images.bin each time, as the paper did
    disk_cold,  ///< read each time, then dropped from the page cache, so that every read is from the disk itself
    memory      ///< read once, kept in host memory
};

/// The space residuals are formed in.
enum class TargetSpace {
    stored,  ///< the dataset's encoding (sRGB photographs stay sRGB)
    linear
};

/// One image as every engine sees it: quantized target values, so that all engines fit the very same numbers.
/// value = channel * scale; alpha is 0 outside the mask, else the channel type's maximum.
struct TargetImage {
    int width = 0, height = 0;
    int bits = 8;                  ///< 8: rgba8 is filled; 16: rgba16
    float scale = 1.0f / 255.0f;   ///< target per unit of channel
    std::vector<uint8_t> rgba8;    ///< [height][width][4]
    std::vector<uint16_t> rgba16;  ///< [height][width][4]

    /// Target values of a pixel, widened to 16 bits: value = channel16 * scale16().
    std::array<uint16_t, 4> channel16(size_t pixel) const {
        if (bits == 8) {
            const uint8_t* p = rgba8.data() + 4 * pixel;
            return {uint16_t(p[0] * 257), uint16_t(p[1] * 257), uint16_t(p[2] * 257), uint16_t(p[3] * 257)};
        }
        const uint16_t* p = rgba16.data() + 4 * pixel;
        return {p[0], p[1], p[2], p[3]};
    }
    float scale16() const { return bits == 8 ? scale / 257.0f : scale; }
    bool masked_in(size_t pixel) const { return bits == 8 ? rgba8[4 * pixel + 3] != 0 : rgba16[4 * pixel + 3] != 0; }
};

/// Streams a dataset's images. 8 bits where the stored bytes are the targets (u8, no gain, stored space); else 16 bits,
/// rounded to nearest, with one scale for the whole dataset (largest representable target / 65535). Targets below 0
/// (halves) are 0. If no view has a mask, alpha is the maximum everywhere.
/// What is read is checked the first time (check_image_bytes()): a UserError names the image that is not as written.
/// Not thread-safe: one stream per thread. Cameras, gains and offsets are copied from the dataset at construction.
class ImageStream {
public:
    ImageStream(const Dataset& dataset, StreamSource source, TargetSpace space = TargetSpace::stored);
    ~ImageStream();
    ImageStream(ImageStream&&) noexcept;
    /// The same images for another thread; StreamSource::memory shares the bytes it keeps.
    ImageStream another() const;

    /// Fills `image`, reusing its storage. Throws SystemError when the file cannot be read whole.
    void load(uint32_t view, TargetImage& image);
    /// The same for who keeps pixels elsewhere: take(y, row, worker) for each row, [width][4] channels of bits(). Rows
    /// come in order or, by_all_threads, in bands of band_rows, those of a band in order by one worker, as
    /// parallel_chunks() names them.
    void load_rows(uint32_t view, bool by_all_threads,
                   const std::function<void(int y, const uint8_t* row, int worker)>& take);
    static constexpr int band_rows = 16;
    /// The targets [height][width][3] as they are before load() rounds them to 16 bits; negative values and what the
    /// mask leaves out are kept. Throws SystemError when the file cannot be read whole.
    void load_values(uint32_t view, std::vector<float>& values);
    /// The mask alone: `image` gets 8 bits, its colours 0. For those who need the values of some pixels: values_at()
    /// gives load_values()'s of single ones until the next load. Throws as load_values().
    void load_mask(uint32_t view, TargetImage& image);
    /// values [pixels][3] out
    void values_at(std::span<const uint32_t> pixels, float* values);

    int bits() const { return bits_; }
    float scale() const { return scale_; }  ///< TargetImage::scale of every image
    float scale16() const { return bits_ == 8 ? scale_ / 257.0f : scale_; }
    double seconds() const { return seconds_; }  ///< wall time spent in load() so far
    uint64_t bytes_read() const { return bytes_read_; }

private:
    struct State;
    explicit ImageStream(std::unique_ptr<State> state);
    void prepare(const View& view);
    void widen(const View& view, const uint8_t* stored, size_t count, uint8_t* rgba) const;
    std::unique_ptr<State> state_;
    int bits_ = 8;
    float scale_ = 1;
    double seconds_ = 0;
    uint64_t bytes_read_ = 0;
};

}  // namespace radiafit
