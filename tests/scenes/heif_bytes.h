#pragma once
#include <libheif/heif.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

/// HEIC pictures as phones write them, by libheif.
namespace radiafit::testing {

struct HeifOptions {
    int width = 64, height = 48;  ///< as stored
    int bits = 8;
    bool alpha = false;
    heif_orientation orientation = heif_orientation_normal;
    std::string profile = {};  ///< ICC, or none
    uint16_t primaries = 0;    ///< nclx numbers of ISO/IEC 23091-2; 0: none are written
    uint16_t transfer = 13;
    heif_compression_format format = heif_compression_HEVC;
};

inline void check_heif(const heif_error& error) {
    if (error.code != heif_error_Ok) throw std::runtime_error(std::string("libheif: ") + error.message);
}

/// value(x, y, channel), from 0 to 1, is what the stored picture shows, nearly: colours are compressed.
inline std::string encode_heif(const HeifOptions& options, const std::function<double(int, int, int)>& value) {
    using Context = std::unique_ptr<heif_context, void (*)(heif_context*)>;
    using Image = std::unique_ptr<heif_image, void (*)(const heif_image*)>;
    using Encoder = std::unique_ptr<heif_encoder, void (*)(heif_encoder*)>;
    using Nclx = std::unique_ptr<heif_color_profile_nclx, void (*)(heif_color_profile_nclx*)>;
    using Options = std::unique_ptr<heif_encoding_options, void (*)(heif_encoding_options*)>;
    const int channels = options.alpha ? 4 : 3, bytes = options.bits > 8 ? 2 : 1;
    const auto chroma = heif_chroma(heif_chroma_interleaved_RGB + (options.alpha ? 1 : 0) + (bytes == 2 ? 4 : 0));
    heif_image* made = nullptr;
    check_heif(heif_image_create(options.width, options.height, heif_colorspace_RGB, chroma, &made));
    const Image image(made, heif_image_release);
    check_heif(heif_image_add_plane(made, heif_channel_interleaved, options.width, options.height, options.bits));
    int stride = 0;
    uint8_t* plane = heif_image_get_plane(made, heif_channel_interleaved, &stride);
    for (int y = 0; y < options.height; ++y)
        for (int i = 0; i < options.width * channels; ++i) {
            const auto stored = std::lround(value(i / channels, y, i % channels) * ((1 << options.bits) - 1));
            for (int b = 0; b < bytes; ++b) plane[y * stride + i * bytes + b] = uint8_t(stored >> (8 * b));
        }
    if (!options.profile.empty())
        check_heif(heif_image_set_raw_color_profile(made, "prof", options.profile.data(), options.profile.size()));
    const Nclx nclx(heif_nclx_color_profile_alloc(), heif_nclx_color_profile_free);
    const Options encoding(heif_encoding_options_alloc(), heif_encoding_options_free);
    encoding->image_orientation = options.orientation;
    encoding->macOS_compatibility_workaround = encoding->macOS_compatibility_workaround_no_nclx_profile = 0;
    if (options.primaries) {
        check_heif(heif_nclx_color_profile_set_color_primaries(nclx.get(), options.primaries));
        check_heif(heif_nclx_color_profile_set_transfer_characteristics(nclx.get(), options.transfer));
        encoding->output_nclx_profile = nclx.get();
        check_heif(heif_image_set_nclx_color_profile(made, nclx.get()));
    }
    const Context context(heif_context_alloc(), heif_context_free);
    heif_encoder* found = nullptr;
    check_heif(heif_context_get_encoder_for_format(context.get(), options.format, &found));
    const Encoder encoder(found, heif_encoder_release);
    check_heif(heif_encoder_set_lossy_quality(found, 95));
    heif_encoder_set_parameter_string(found, "chroma", "444");
    check_heif(heif_context_encode_image(context.get(), made, found, encoding.get(), nullptr));
    std::string file;
    heif_writer writer = {1, [](heif_context*, const void* data, size_t size, void* to) {
                              static_cast<std::string*>(to)->append(static_cast<const char*>(data), size);
                              return heif_error{heif_error_Ok, heif_suberror_Unspecified, ""};
                          }};
    check_heif(heif_context_write(context.get(), &writer, &file));
    return file;
}

}  // namespace radiafit::testing
