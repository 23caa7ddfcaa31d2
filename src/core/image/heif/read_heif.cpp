#include "image/heif/read_heif.h"

#include <libheif/heif.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "image/image_header.h"

namespace radiafit {
namespace {

template <auto release>
struct Releaser {
    template <class T>
    void operator()(T* object) const {
        release(object);
    }
};
using Context = std::unique_ptr<heif_context, Releaser<heif_context_free>>;
using Handle = std::unique_ptr<heif_image_handle, Releaser<heif_image_handle_release>>;
using Image = std::unique_ptr<heif_image, Releaser<heif_image_release>>;
using Nclx = std::unique_ptr<heif_color_profile_nclx, Releaser<heif_nclx_color_profile_free>>;

bool failed(const heif_error& error, HeifPicture& out) {
    if (error.code == heif_error_Ok) return false;
    out.damage = error.message;
    return true;
}

void take_numbers(const heif_image_handle* handle, HeifPicture& out) {
    heif_color_profile_nclx* read = nullptr;
    const bool none = heif_image_handle_get_nclx_color_profile(handle, &read).code != heif_error_Ok;
    const Nclx nclx(read);  // also where numbers of no meaning are refused
    if (!none && nclx) out.numbers = ColorNumbers{nclx->color_primaries, nclx->transfer_characteristics};
}

void take_colors(const heif_image_handle* handle, HeifPicture& out) {
    const size_t size = heif_image_handle_get_raw_color_profile_size(handle);
    if (size == 0) return take_numbers(handle, out);
    std::string profile(std::min(size, largest_profile + 1), '\0');
    if (size <= largest_profile &&
        heif_image_handle_get_raw_color_profile(handle, profile.data()).code != heif_error_Ok)
        out.profile_unreadable = true;
    else
        out.profile = std::move(profile);
}

/// Little-endian values of `bits` bits, spread over all of 16.
uint16_t spread(const uint8_t* at, int bits) {
    const uint32_t value = at[0] | uint32_t(at[1]) << 8, largest = (1u << bits) - 1;
    return uint16_t((std::min(value, largest) * 65535u + largest / 2) / largest);
}

void take_pixels(const heif_image_handle* handle, HeifPicture& out) {
    const bool wide = out.bits > 8;
    const heif_chroma chroma = wide
                                   ? out.alpha ? heif_chroma_interleaved_RRGGBBAA_LE : heif_chroma_interleaved_RRGGBB_LE
                               : out.alpha ? heif_chroma_interleaved_RGBA
                                           : heif_chroma_interleaved_RGB;
    heif_image* decoded = nullptr;
    const heif_error error = heif_decode_image(handle, &decoded, heif_colorspace_RGB, chroma, nullptr);
    const Image image(decoded);
    if (failed(error, out)) return;
    constexpr heif_channel all = heif_channel_interleaved;
    const int width = heif_image_get_width(decoded, all), height = heif_image_get_height(decoded, all);
    int stride = 0;
    const uint8_t* pixels = heif_image_get_plane_readonly(decoded, all, &stride);
    if (!pixels || width < 1 || height < 1 || uint64_t(width) != out.width || uint64_t(height) != out.height) {
        out.damage = "the picture differs from its header";
        return;
    }
    const int channels = out.alpha ? 4 : 3;
    const size_t row_values = size_t(width) * size_t(channels);
    out.image = {width, height, channels, out.alpha ? 3 : -1, false, {}, {}};
    const auto row = [&](int y) { return pixels + ptrdiff_t(y) * stride; };
    if (!wide) {
        std::vector<uint8_t> values(row_values * size_t(height));
        for (int y = 0; y < height; ++y) std::memcpy(values.data() + size_t(y) * row_values, row(y), row_values);
        out.image.values = std::move(values);
        return;
    }
    const int bits = heif_image_get_bits_per_pixel_range(decoded, all);
    if (bits < 9 || bits > 16) {
        out.damage = "it decodes to another number of bits than its header says";
        return;
    }
    std::vector<uint16_t> values(row_values * size_t(height));
    for (int y = 0; y < height; ++y)
        for (size_t i = 0; i < row_values; ++i) values[size_t(y) * row_values + i] = spread(row(y) + 2 * i, bits);
    out.image.values = std::move(values);
}

void read_heif(std::string_view bytes, bool pixels, HeifPicture& out) {
    const Context context(heif_context_alloc());
    heif_context_set_maximum_image_size_limit(context.get(), int(largest_image_side));
    heif_context_set_max_decoding_threads(context.get(), 0);
    if (failed(heif_context_read_from_memory_without_copy(context.get(), bytes.data(), bytes.size(), nullptr), out))
        return;
    heif_image_handle* primary = nullptr;
    if (failed(heif_context_get_primary_image_handle(context.get(), &primary), out)) return;
    const Handle handle(primary);
    out.width = uint64_t(std::max(0, heif_image_handle_get_width(primary)));
    out.height = uint64_t(std::max(0, heif_image_handle_get_height(primary)));
    out.bits = heif_image_handle_get_luma_bits_per_pixel(primary);
    out.alpha = heif_image_handle_has_alpha_channel(primary) != 0;
    if (out.alpha && heif_image_handle_is_premultiplied_alpha(primary))
        out.other = "a picture whose colours are multiplied by its alpha";
    if (out.bits < 8 || out.bits > 16)
        out.damage = "the header says nothing of its bits";
    else
        take_colors(primary, out);
    if (pixels && out.damage.empty() && out.other.empty()) take_pixels(primary, out);
}

}  // namespace
}  // namespace radiafit

extern "C" radiafit::ReadHeif radiafit_read_heif;  // NOLINT: its name is looked up

extern "C" void radiafit_read_heif(std::string_view bytes, bool pixels, radiafit::HeifPicture& out) {
    radiafit::read_heif(bytes, pixels, out);
}
