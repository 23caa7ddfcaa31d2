// OpenEXR pictures as photographs: which channels are the picture, and where it lies in the display window.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>
#include <streambuf>
#include <string_view>

#include "base/error.h"
#include "image/codecs.h"
#include "image/exr_header.h"

namespace radiafit {
namespace {

/// Bytes in memory, to be read as a stream.
struct ViewBuffer : std::streambuf {
    explicit ViewBuffer(std::string_view bytes) {
        char* begin = const_cast<char*>(bytes.data());  // it only reads
        setg(begin, begin, begin + bytes.size());
    }
};

ExrHeader walk_bytes(const std::filesystem::path& file, std::string_view bytes) {
    ViewBuffer buffer(bytes);
    std::istream in(&buffer);
    try {
        return walk_exr_header(in, bytes.size());
    } catch (const std::runtime_error& e) {
        fail_damaged_image(file, e.what());
    }
}

/// The picture's channels among all of a file.
struct ChosenChannels {
    std::vector<std::string> names;  ///< R, G, B or one of grey, then perhaps alpha; empty: all, which are not more
    std::vector<std::string> left;   ///< those that are left out
};

bool is_alpha(const std::string& name) { return name == "A" || name.ends_with(".A"); }

/// Where there is one channel beside one of alpha, whatever its name, or three of red, green and blue, they are the
/// picture. Else R, G, B are, plain ones or those of the only layer that has them.
ChosenChannels choose_channels(const std::filesystem::path& file, const std::vector<std::string>& channels) {
    const auto alphas = std::ranges::count_if(channels, is_alpha);
    const auto colors = std::ptrdiff_t(channels.size()) - alphas;
    const auto is_color = [](const std::string& name) {
        std::string last = name.substr(name.rfind('.') + 1);
        std::ranges::transform(last, last.begin(), [](unsigned char c) { return std::tolower(c); });
        constexpr std::string_view colors[] = {"r", "red", "g", "green", "b", "blue"};
        return std::ranges::count(colors, last) == 1;
    };
    const bool named = std::ranges::count_if(channels, is_color) == 3;
    if (alphas <= 1 && (colors == 1 || (colors == 3 && named))) return {};
    const auto has = [&](const std::string& name) { return std::ranges::count(channels, name) == 1; };
    std::set<std::string> layers;  // what stands before R; empty: no layer
    for (const std::string& name : channels)
        if (name == "R" || name.ends_with(".R")) {
            const std::string layer = name.substr(0, name.size() - 1);
            if (has(layer + "R") && has(layer + "G") && has(layer + "B")) layers.insert(layer);
        }
    if (layers.contains("")) layers = {""};
    if (layers.size() > 1)
        throw UserError(fmt::format("{}: holds {} layers of R, G, B ({}), and none outside a layer: export one alone",
                                    file.string(), layers.size(), fmt::join(layers, " ")));
    ChosenChannels chosen;
    if (layers.size() == 1)
        for (const char* color : {"R", "G", "B"}) chosen.names.push_back(*layers.begin() + color);
    else if (has("Y") && !(has("X") && has("Z")))
        chosen.names = {"Y"};
    else
        throw UserError(fmt::format("{}: has the channels {}, but neither R, G, B nor Y: export R, G and B",
                                    file.string(), fmt::join(channels, ", ")));
    const std::string alpha = layers.empty() ? "A" : *layers.begin() + "A";
    if (has(alpha)) chosen.names.push_back(alpha);
    for (const std::string& name : channels)
        if (std::ranges::count(chosen.names, name) == 0) chosen.left.push_back(name);
    return chosen;
}

/// Only the channels of these names, which the picture has.
void keep_channels(const std::filesystem::path& file, RawImage& image, const std::vector<std::string>& names) {
    std::vector<size_t> places;
    for (const std::string& name : names) {
        const auto at = std::ranges::find(image.names, name);
        if (at == image.names.end()) fail_damaged_image(file, "its channel " + name + " is not found again");
        places.push_back(size_t(at - image.names.begin()));
    }
    auto* all = std::get_if<std::vector<float>>(&image.values);
    if (!all) fail_damaged_image(file, "its channels are not floats");
    const size_t count = all->size() / size_t(image.channels);
    std::vector<float> kept(count * places.size());
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < places.size(); ++c)
            kept[i * places.size() + c] = (*all)[i * size_t(image.channels) + places[c]];
    image.values = std::move(kept);
    image.channels = int(names.size());
    image.alpha = is_alpha(names.back()) ? image.channels - 1 : -1;
    image.names = names;
}

/// An alpha channel of ones behind the others, where there is none.
void add_alpha(RawImage& image) {
    if (image.alpha >= 0) return;
    const auto channels = size_t(image.channels);
    const auto& stored = std::get<std::vector<float>>(image.values);
    std::vector<float> values(stored.size() / channels * (channels + 1), 1.0f);
    for (size_t i = 0; i < stored.size(); ++i) values[i / channels * (channels + 1) + i % channels] = stored[i];
    image.values = std::move(values);
    image.alpha = image.channels++;
}

/// From the data window to the display window; what the file does not have becomes 0, alpha included.
void fit_window(RawImage& image, const ExrHeader& windows, const ImageHeader& header) {
    const int64_t width = int64_t(header.width), height = int64_t(header.height);
    const int64_t left = int64_t(windows.data[0]) - windows.display[0];
    const int64_t top = int64_t(windows.data[1]) - windows.display[1];
    const int64_t first = std::max<int64_t>(left, 0), last = std::min(left + windows.width, width);
    const int64_t upper = std::max<int64_t>(top, 0), lower = std::min(top + windows.height, height);
    if (first > 0 || upper > 0 || last < width || lower < height) add_alpha(image);
    const int64_t channels = image.channels;
    const auto& stored = std::get<std::vector<float>>(image.values);
    std::vector<float> values(size_t(width * height * channels), 0.0f);
    for (int64_t y = upper; y < lower && first < last; ++y)
        std::copy_n(stored.begin() + ((y - top) * windows.width + first - left) * channels, (last - first) * channels,
                    values.begin() + (y * width + first) * channels);
    image.values = std::move(values);
    image.width = int(width);
    image.height = int(height);
}

/// What is said of windows that differ; empty: they are the same.
std::string describe_windows(const ExrHeader& h) {
    const bool within = h.data[0] >= h.display[0] && h.data[1] >= h.display[1] && h.data[2] <= h.display[2] &&
                        h.data[3] <= h.display[3];
    const bool around = h.data[0] <= h.display[0] && h.data[1] <= h.display[1] && h.data[2] >= h.display[2] &&
                        h.data[3] >= h.display[3];
    if (within && around) return "";
    if (around) return "what lies outside the display window is cropped away";
    if (within) return "left out outside the data window, which does not fill the display window";
    return "left out outside the data window, and cropped to the display window";
}

}  // namespace

ImageHeader read_exr_header(const std::filesystem::path& file, std::string_view bytes) {
    constexpr uint64_t largest_tile = 2048;  // pixels a side; OpenEXR takes memory for whole tiles
    const ExrHeader exr = walk_bytes(file, bytes);
    if (!exr.plain)
        throw UserError(fmt::format("{}: holds several or deep pictures: export one plain picture", file.string()));
    if (exr.tile > largest_tile) fail_damaged_image(file, "tiles larger than 2048 pixels");
    const auto size = [](int64_t first, int64_t last) { return uint64_t(std::max<int64_t>(last - first + 1, 0)); };
    ImageHeader header{size(exr.display[0], exr.display[2]), size(exr.display[1], exr.display[3]), exr.bits_per_pixel};
    const uint64_t wide = uint64_t(std::max<int64_t>(exr.width, 0)), high = uint64_t(std::max<int64_t>(exr.height, 0));
    if (wide < 1 || high < 1 || wide > largest_image_side || high > largest_image_side)
        return {wide, high, exr.bits_per_pixel};  // the caller says so
    header.stored_pixels = wide * high;
    // The part that is filled up costs memory, too, and no byte of the file vouches for it: what a camera has, or 64
    // times what is there.
    constexpr uint64_t camera_pixels = uint64_t(1) << 24;
    if (header.width <= largest_image_side && header.height <= largest_image_side &&
        header.width * header.height > std::max(camera_pixels, 64 * header.stored_pixels))
        fail_damaged_image(file, "a display window far larger than the data window");
    if (exr.subsampled)
        throw UserError(fmt::format(
            "{}: channels ({}) of fewer pixels than the picture, such as luminance and chroma: export R, G and B",
            file.string(), fmt::join(exr.channels, ", ")));
    const ChosenChannels chosen = choose_channels(file, exr.channels);
    if (!chosen.left.empty())
        header.remarks.push_back(
            fmt::format("{} taken, {} left out", fmt::join(chosen.names, ", "), fmt::join(chosen.left, ", ")));
    const std::string windows = describe_windows(exr);
    if (!windows.empty()) header.remarks.push_back(windows);
    std::copy(exr.chromaticities.begin(), exr.chromaticities.end(), header.colors.chromaticities.begin());
    return header;
}

RawImage read_exr_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    const ExrHeader exr = walk_bytes(file, bytes);
    ImageHeader stored;
    stored.width = uint64_t(exr.width);
    stored.height = uint64_t(exr.height);
    RawImage image = read_oiio_pixels(file, bytes, stored, "openexr");
    const ChosenChannels chosen = choose_channels(file, exr.channels);
    if (!chosen.names.empty()) keep_channels(file, image, chosen.names);
    if (exr.data != exr.display) fit_window(image, exr, header);
    return image;
}

}  // namespace radiafit
