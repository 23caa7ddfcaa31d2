#include "dataset/image_stream.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>

#include "base/clock.h"
#include "base/file.h"
#include "base/half.h"
#include "base/parallel.h"
#include "dataset/checksums.h"
#include "dataset/dataset_json.h"

namespace radiafit {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels are widened by whole words");

template <class Word>
inline Word load_word(const uint8_t* from) {
    Word word;
    std::memcpy(&word, from, sizeof(Word));
    return word;
}
template <class Word>
inline void store_word(uint8_t* to, Word word) {
    std::memcpy(to, &word, sizeof(Word));
}

/// RGB bytes to RGBA, without a look at the channels. A pixel is read as a word of its three bytes and the one behind:
/// `rgb` has a readable byte behind its end.
void widen8(const uint8_t* __restrict rgb, size_t count, uint8_t* __restrict rgba) {
    for (size_t i = 0; i < count; ++i) store_word(rgba + 4 * i, load_word<uint32_t>(rgb + 3 * i) | 0xff000000u);
}

/// tables: of the channels, by stored byte.
void look_up(const uint8_t* __restrict rgb, size_t count, const std::array<std::array<uint16_t, 256>, 3>& tables,
             uint8_t* __restrict rgba) {
    for (size_t i = 0; i < count; ++i)
        store_word(rgba + 8 * i, uint64_t{0xffff} << 48 | uint64_t{tables[2][rgb[3 * i + 2]]} << 32 |
                                     uint64_t{tables[1][rgb[3 * i + 1]]} << 16 | tables[0][rgb[3 * i]]);
}

constexpr size_t together = 8;  ///< pixels

/// Linear encodings: target / scale = value * factor of the channel, rounded; to_floats(stored, values) makes
/// `together` pixels' values. Written for vectors: what is beyond the end is worked out, too, and not stored.
template <size_t value_bytes, class ToFloats>
void multiply(const uint8_t* __restrict rgb, size_t count, const std::array<float, 3>& factors, ToFloats to_floats,
              uint8_t* __restrict rgba) {
    constexpr size_t channels = 3 * together, bytes = channels * value_bytes;
    std::array<float, channels> factor, values;
    for (size_t k = 0; k < channels; ++k) factor[k] = factors[k % 3];
    std::array<uint8_t, bytes> end{};  // of the row
    std::array<int32_t, channels> rounded;
    for (size_t i = 0; i < count; i += together, rgb += bytes) {
        const size_t pixels = std::min(together, count - i);
        if (pixels < together) std::memcpy(end.data(), rgb, 3 * pixels * value_bytes);
        to_floats(pixels < together ? end.data() : rgb, values.data());
        for (size_t k = 0; k < channels; ++k)
            rounded[k] = int32_t(std::min(std::max(0.0f, values[k] * factor[k]) + 0.5f, 65535.0f));
        for (size_t p = 0; p < pixels; ++p) {
            const auto channel = [&](size_t c) { return uint64_t(uint32_t(rounded[3 * p + c])) << 16 * c; };
            store_word(rgba + 8 * (i + p), uint64_t{0xffff} << 48 | channel(2) | channel(1) | channel(0));
        }
    }
}

/// Clears the alpha (the top byte or half-word of Word) of pixels whose mask bit is 0.
template <class Word, int alpha_shift>
void apply_mask(const uint8_t* __restrict bits, size_t width, size_t height, uint8_t* __restrict rgba) {
    const size_t row_bytes = (width + 7) / 8;
    constexpr Word color = (Word{1} << alpha_shift) - 1;
    for (size_t y = 0; y < height; ++y) {
        const uint8_t* row = bits + y * row_bytes;
        uint8_t* out = rgba + y * width * sizeof(Word);
        for (size_t x = 0; x < width; x += 8) {
            const uint8_t byte = row[x / 8];
            if (byte == 0xff) continue;  // most of a mask is all in or all out
            const size_t end = std::min<size_t>(8, width - x);
            for (size_t k = 0; k < end; ++k) {
                uint8_t* pixel = out + sizeof(Word) * (x + k);
                const Word inside = byte >> (7 - k) & 1;
                store_word<Word>(pixel, load_word<Word>(pixel) & (color | (Word{0} - inside)));
            }
        }
    }
}

/// Which views have been checked, by any of the streams that share it.
using CheckedViews = std::vector<std::atomic<bool>>;

}  // namespace

struct ImageStream::State {
    std::shared_ptr<const InputFile> file;
    bool cold = false;
    std::shared_ptr<const std::vector<uint8_t>> kept;  ///< StreamSource::memory: the whole of images.bin, and a byte
    std::vector<uint8_t> buffer;                       ///< StreamSource::disk: one image, reused
    std::vector<uint8_t> mask_buffer;
    std::vector<uint8_t> rows;  ///< of targets, one of each worker
    std::shared_ptr<const std::vector<View>> views;
    std::shared_ptr<CheckedViews> checked;
    std::filesystem::path path;  ///< of images.bin
    Encoding encoding = Encoding::u8_srgb;
    TargetSpace space = TargetSpace::stored;
    std::array<std::array<uint16_t, 256>, 3> tables = {};
    Gain tables_gain = 0;  ///< the gain `tables` were made for
    std::array<std::array<float, 256>, 3> values = {};
    Gain values_gain = 0;            ///< the gain `values` were made for
    std::optional<uint32_t> masked;  ///< the view that load_mask() read

    bool linear_targets() const { return space == TargetSpace::linear; }
    double target(double stored, double gain) const {
        const double light = gain * decode(encoding, stored);
        return linear_targets() ? light : encode(encoding, light);
    }
    /// The bytes of [offset, offset + bytes), with one readable byte behind them.
    const uint8_t* bytes_at(uint64_t offset, uint64_t bytes, std::vector<uint8_t>& to, uint64_t& bytes_read) {
        if (kept) return kept->data() + offset;
        if (to.size() < bytes + 1) to.resize(bytes + 1);
        file->read(to.data(), offset, bytes);
        if (cold) file->forget(offset, bytes);
        bytes_read += bytes;
        return to.data();
    }
    /// Checked when the view is read for the first time.
    const uint8_t* pixels_at(uint32_t index, uint64_t& bytes_read) {
        const View& view = views->at(index);
        std::atomic<bool>& known = (*checked)[index];
        if (known.load(std::memory_order_relaxed))
            return bytes_at(view.pixel_offset, pixel_bytes(view.camera, encoding), buffer, bytes_read);
        const uint64_t bytes = checked_bytes(view, encoding);
        const uint8_t* block = bytes_at(view.pixel_offset, bytes, buffer, bytes_read);
        check_image_bytes(view, encoding, {block, bytes}, path);
        known.store(true, std::memory_order_relaxed);
        return block;
    }
    const uint8_t* mask_at(const View& view, uint64_t& bytes_read) {
        if (!view.mask_offset) return nullptr;
        return bytes_at(*view.mask_offset, mask_bytes(view.camera), mask_buffer, bytes_read);
    }
    /// body(target), where target(i, c) is that of the i-th stored value, of channel c, as a float: of linear
    /// encodings, a multiple in either space.
    template <class Body>
    void with_targets(const uint8_t* stored, const Gain& gain, const Body& body) {
        switch (encoding) {
            case Encoding::f32_linear:
                return body(
                    [=](size_t i, size_t c) { return float(gain[c] * double(load_word<float>(stored + 4 * i))); });
            case Encoding::f16_linear:
                return body([=](size_t i, size_t c) {
                    return float(gain[c] * double(float_from_half(load_word<uint16_t>(stored + 2 * i))));
                });
            case Encoding::u16_linear:
                return body([=](size_t i, size_t c) {
                    return float(gain[c] * (load_word<uint16_t>(stored + 2 * i) / 65535.0));
                });
            default:
                if (values_gain != gain)
                    for (size_t c = 0; c < 3; ++c)
                        for (size_t v = 0; v < 256; ++v) values[c][v] = float(target(double(v) / 255, gain[c]));
                values_gain = gain;
                return body([=, this](size_t i, size_t c) { return values[c][stored[i]]; });
        }
    }
    void make_tables(const Gain& gain, double scale) {
        if (tables_gain == gain) return;
        for (size_t c = 0; c < 3; ++c)
            for (size_t v = 0; v < 256; ++v)
                tables[c][v] = uint16_t(std::min(65535.0, std::round(target(double(v) / 255, gain[c]) / scale)));
        tables_gain = gain;
    }
};

ImageStream::ImageStream(const Dataset& dataset, StreamSource source, TargetSpace space)
    : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.encoding = dataset.encoding;
    s.space = space;
    const bool bytes = bytes_per_channel(dataset.encoding) == 1;
    const bool as_stored = space == TargetSpace::stored || dataset.encoding != Encoding::u8_srgb;
    double largest = 0;
    uint64_t end = 0;
    bool gains = false;
    s.views = std::make_shared<const std::vector<View>>(dataset.views);
    s.checked = std::make_shared<CheckedViews>(dataset.views.size());
    for (const View& view : dataset.views) {
        gains |= view.gain != 1;
        largest = std::max(largest, s.target(view.peak, view.gain.most()));
        end = std::max(end, view.pixel_offset + checked_bytes(view, dataset.encoding));
        if (view.mask_offset) end = std::max(end, *view.mask_offset + mask_bytes(view.camera));
    }
    bits_ = bytes && as_stored && !gains ? 8 : 16;
    if (!(largest > 0)) largest = 1;  // black throughout
    scale_ = bits_ == 8 ? 1.0f / 255.0f : static_cast<float>(largest / 65535);

    s.path = dataset.folder / dataset_images_name;
    s.file = std::make_shared<InputFile>(s.path);
    s.cold = source == StreamSource::disk_cold;
    if (s.cold) {
        s.file->no_readahead();  // or pages of images that come later stay
        s.file->forget(0, end);
    }
    if (source == StreamSource::memory) {
        auto kept = std::make_shared<std::vector<uint8_t>>(end + 1);
        s.file->read(kept->data(), 0, end);
        bytes_read_ = end;
        s.kept = std::move(kept);
    }
}

ImageStream::ImageStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
ImageStream::~ImageStream() = default;
ImageStream::ImageStream(ImageStream&&) noexcept = default;

ImageStream ImageStream::another() const {
    ImageStream copy(std::make_unique<State>(*state_));
    copy.bits_ = bits_;
    copy.scale_ = scale_;
    return copy;
}

// What widen() looks up.
void ImageStream::prepare(const View& view) {
    if (bits_ == 16 && bytes_per_channel(state_->encoding) == 1) state_->make_tables(view.gain, double(scale_));
}

// The targets of `count` pixels, what the mask leaves out included.
void ImageStream::widen(const View& view, const uint8_t* stored, size_t count, uint8_t* rgba) const {
    if (bits_ == 8) return widen8(stored, count, rgba);
    const State& s = *state_;
    const auto factors = [&](double full) {
        std::array<float, 3> out;
        for (size_t c = 0; c < 3; ++c) out[c] = float(view.gain[c] / full / double(scale_));
        return out;
    };
    if (s.encoding == Encoding::f16_linear) {
        const auto to_floats = [](const uint8_t* halves, float* values) {
            for (size_t k = 0; k < 3 * together; k += 8) eight_floats_from_halves(halves + 2 * k, values + k);
        };
        multiply<2>(stored, count, factors(1), to_floats, rgba);
    } else if (s.encoding == Encoding::f32_linear) {
        const auto to_floats = [](const uint8_t* floats, float* values) {
            std::memcpy(values, floats, 3 * together * 4);
        };
        multiply<4>(stored, count, factors(1), to_floats, rgba);
    } else if (s.encoding == Encoding::u16_linear) {
        const auto to_floats = [](const uint8_t* words, float* values) {
            for (size_t k = 0; k < 3 * together; ++k) values[k] = float(load_word<uint16_t>(words + 2 * k));
        };
        multiply<2>(stored, count, factors(65535), to_floats, rgba);
    } else {
        look_up(stored, count, s.tables, rgba);
    }
}

void ImageStream::load(uint32_t index, TargetImage& image) {
    const double start_s = wall_time_s();
    State& s = *state_;
    const View& view = s.views->at(index);
    const size_t width = size_t(view.camera.width), height = size_t(view.camera.height), count = width * height;
    const uint8_t *pixels = s.pixels_at(index, bytes_read_), *mask = s.mask_at(view, bytes_read_);
    s.masked.reset();

    image.width = view.camera.width;
    image.height = view.camera.height;
    image.bits = bits_;
    image.scale = scale_;
    prepare(view);
    if (bits_ == 8) {
        image.rgba8.resize(4 * count);
        image.rgba16.clear();
        widen(view, pixels, count, image.rgba8.data());
        if (mask) apply_mask<uint32_t, 24>(mask, width, height, image.rgba8.data());
    } else {
        image.rgba16.resize(4 * count);
        image.rgba8.clear();
        auto* rgba = reinterpret_cast<uint8_t*>(image.rgba16.data());
        widen(view, pixels, count, rgba);
        if (mask) apply_mask<uint64_t, 48>(mask, width, height, rgba);
    }
    seconds_ += wall_time_s() - start_s;
}

void ImageStream::load_rows(uint32_t index, bool by_all_threads,
                            const std::function<void(int y, const uint8_t* row, int worker)>& take) {
    const double start_s = wall_time_s();
    State& s = *state_;
    const View& view = s.views->at(index);
    const size_t width = size_t(view.camera.width), stored = 3 * width * bytes_per_channel(s.encoding);
    const uint8_t *pixels = s.pixels_at(index, bytes_read_), *mask = s.mask_at(view, bytes_read_);
    s.masked.reset();
    prepare(view);
    const size_t row_bytes = width * size_t(bits_ / 2);
    s.rows.resize(size_t(thread_count()) * row_bytes);
    const auto load_band = [&](size_t begin, size_t end, int worker) {
        uint8_t* row = s.rows.data() + size_t(worker) * row_bytes;
        for (size_t y = begin; y < end; ++y) {
            widen(view, pixels + y * stored, width, row);
            const uint8_t* in = mask ? mask + y * ((width + 7) / 8) : nullptr;
            if (in && bits_ == 8) apply_mask<uint32_t, 24>(in, width, 1, row);
            if (in && bits_ == 16) apply_mask<uint64_t, 48>(in, width, 1, row);
            take(int(y), row, worker);
        }
    };
    const auto height = size_t(view.camera.height);
    if (by_all_threads)
        parallel_chunks(height, band_rows, std::cref(load_band));
    else
        load_band(0, height, 0);
    seconds_ += wall_time_s() - start_s;
}

void ImageStream::load_values(uint32_t index, std::vector<float>& values) {
    const double start_s = wall_time_s();
    State& s = *state_;
    const View& view = s.views->at(index);
    const uint8_t* stored = s.pixels_at(index, bytes_read_);
    s.masked.reset();
    values.resize(3 * size_t(view.camera.width) * size_t(view.camera.height));
    s.with_targets(stored, view.gain, [&](auto target) {
        for (size_t i = 0; i < values.size(); i += 3)
            for (size_t c = 0; c < 3; ++c) values[i + c] = target(i + c, c);
    });
    seconds_ += wall_time_s() - start_s;
}

void ImageStream::load_mask(uint32_t index, TargetImage& image) {
    const double start_s = wall_time_s();
    State& s = *state_;
    const View& view = s.views->at(index);
    s.masked.reset();
    s.pixels_at(index, bytes_read_);
    const uint8_t* mask = s.mask_at(view, bytes_read_);
    image.width = view.camera.width;
    image.height = view.camera.height;
    image.bits = 8;
    image.scale = 1.0f / 255.0f;
    image.rgba16.clear();
    image.rgba8.resize(4 * size_t(view.camera.width) * size_t(view.camera.height));
    for (size_t at = 0; at < image.rgba8.size(); at += 4) store_word(&image.rgba8[at], 0xff000000u);
    if (mask) apply_mask<uint32_t, 24>(mask, size_t(view.camera.width), size_t(view.camera.height), image.rgba8.data());
    s.masked = index;
    seconds_ += wall_time_s() - start_s;
}

void ImageStream::values_at(std::span<const uint32_t> pixels, float* values) {
    State& s = *state_;
    if (!s.masked) throw std::logic_error("ImageStream::values_at without load_mask");
    const View& view = (*s.views)[*s.masked];
    s.with_targets(s.kept ? s.kept->data() + view.pixel_offset : s.buffer.data(), view.gain, [&](auto target) {
        for (const uint32_t pixel : pixels)
            for (size_t c = 0; c < 3; ++c) *values++ = target(3 * size_t(pixel) + c, c);
    });
}

}  // namespace radiafit
