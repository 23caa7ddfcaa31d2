#pragma once
#include <algorithm>
#include <cmath>
#include <utility>

#include "capture_fixture.h"

/// Picture files byte by byte from their specifications, right or wrong: PNG, TIFF, OpenEXR, ICC profiles, EXIF.
namespace radiafit::testing {

/// A PNG of one's own header and pixel bytes; more: chunks between them.
inline std::string plain_png(uint32_t width, uint32_t height, char bits, char color, const std::string& zlib,
                             const std::string& more = "") {
    return "\x89PNG\r\n\x1a\n" +
           png_chunk("IHDR", big_endian(width) + big_endian(height) + std::string{bits, color, 0, 0, 0}) + more +
           png_chunk("IDAT", zlib) + png_chunk("IEND", "");
}

struct TiffEntry {
    uint16_t tag, type;  ///< type: 3 short, 4 long, 5 fraction (two values), 7 byte
    std::vector<uint32_t> values;
};

/// A TIFF of one strip, at byte 512 or, where the directory needs more, at 8192. The entries may be wrong in any way.
/// wide: as a BigTIFF.
inline std::string encode_tiff(std::vector<TiffEntry> entries, const std::string& strip, bool big = false,
                               bool wide = false, size_t strip_at = 512) {
    const auto number = [&](uint32_t v, size_t bytes) {
        std::string text = (std::string(4, '\0') + big_endian(v)).substr(8 - bytes);
        if (!big) std::reverse(text.begin(), text.end());
        return text;
    };
    const size_t word = wide ? 8 : 4, count_bytes = wide ? 8 : 2;
    std::string file = (big ? "MM" : "II") + number(wide ? 43 : 42, 2) + (wide ? number(8, 2) + number(0, 2) : "") +
                       number(uint32_t(2 * word), word) + number(uint32_t(entries.size()), count_bytes);
    std::string later;
    const size_t end = file.size() + (4 + 2 * word) * entries.size() + word;
    for (TiffEntry& entry : entries) {
        if (entry.tag == 273 && entry.values.empty()) entry.values = {1 << 20};
        std::string values;
        for (const uint32_t v : entry.values) values += number(v, entry.type == 7 ? 1 : entry.type == 3 ? 2 : 4);
        file += number(entry.tag, 2) + number(entry.type, 2) +
                number(uint32_t(entry.values.size() / (entry.type == 5 ? 2 : 1)), word);
        if (values.size() > word) {
            file += number(uint32_t(end + later.size()), word);
            later += values;
        } else {
            file += values + std::string(word - values.size(), '\0');
        }
    }
    file += number(0, word) + later;
    return file + std::string(strip_at - file.size(), '\0') + strip;
}

inline std::vector<TiffEntry> tiff_entries(uint32_t width, uint32_t height, uint32_t channels, uint32_t bits) {
    return {{256, 4, {width}},
            {257, 4, {height}},
            {258, 3, std::vector<uint32_t>(channels, bits)},
            {259, 3, {1}},
            {262, 3, {channels < 3 ? 1u : 2u}},
            {273, 4, {512}},
            {277, 3, {channels}},
            {278, 4, {height}},
            {279, 4, {width * height * channels * bits / 8}},
            {338, 3, {2}},
            {339, 3, std::vector<uint32_t>(channels, bits == 32 ? 3 : 1)}};
}

/// An attribute of an OpenEXR header.
inline std::string exr_attribute(const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + Bytes().put(int32_t(value.size())).text + value;
}

using ExrBox = std::array<int32_t, 4>;  ///< left, top, right, bottom

/// An uncompressed OpenEXR file of floats, all channels of these names (sorted) and each value of channel c at (x, y)
/// of the data window by value(c, x, y), x and y counted from the data window's corner. more: further attributes.
inline std::string encode_exr_channels(const std::vector<std::string>& names, const ExrBox& data, const ExrBox& display,
                                       const std::function<float(size_t, int, int)>& value,
                                       const std::string& more = "") {
    const auto box = [](const ExrBox& b) { return Bytes().put(b[0]).put(b[1]).put(b[2]).put(b[3]).text; };
    std::string channels;
    for (const std::string& name : names) channels += name + '\0' + Bytes().put(2).put(0).put(1).put(1).text;
    const auto a = exr_attribute;
    std::string file = Bytes().put(0x01312f76).put(2).text + a("channels", "chlist", channels + '\0') +
                       a("compression", "compression", std::string(1, '\0')) + a("dataWindow", "box2i", box(data)) +
                       a("displayWindow", "box2i", box(display)) + a("lineOrder", "lineOrder", std::string(1, '\0')) +
                       a("pixelAspectRatio", "float", Bytes().put(1.0f).text) +
                       a("screenWindowCenter", "v2f", Bytes().put(0.0f).put(0.0f).text) +
                       a("screenWindowWidth", "float", Bytes().put(1.0f).text) + more + '\0';
    const int width = data[2] - data[0] + 1, height = data[3] - data[1] + 1;
    const size_t line_bytes = names.size() * size_t(width) * 4, first = file.size() + 8 * size_t(height);
    for (size_t y = 0; y < size_t(height); ++y) file += Bytes().put(uint64_t(first + y * (8 + line_bytes))).text;
    for (int y = 0; y < height; ++y) {
        Bytes line;
        line.put(int32_t(y + data[1])).put(int32_t(line_bytes));
        for (size_t c = 0; c < names.size(); ++c)
            for (int x = 0; x < width; ++x) line.put(value(c, x, y));
        file += line.text;
    }
    return file;
}

/// An uncompressed OpenEXR file of floats, [height][width][3], row 0 on top. right, bottom: of its data window.
inline std::string encode_exr(int width, int height, const std::vector<float>& values, int32_t right, int32_t bottom) {
    const auto attribute = [](const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + Bytes().put(int32_t(value.size())).text + value;
    };
    std::string channels;
    for (const char* name : {"B", "G", "R"})
        channels += std::string(name) + '\0' + Bytes().put(2).put(0).put(1).put(1).text;
    const std::string box = Bytes().put(0).put(0).put(right).put(bottom).text;
    std::string file = Bytes().put(0x01312f76).put(2).text + attribute("channels", "chlist", channels + '\0') +
                       attribute("compression", "compression", std::string(1, '\0')) +
                       attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box) +
                       attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                       attribute("pixelAspectRatio", "float", Bytes().put(1.0f).text) +
                       attribute("screenWindowCenter", "v2f", Bytes().put(0.0f).put(0.0f).text) +
                       attribute("screenWindowWidth", "float", Bytes().put(1.0f).text) + '\0';
    const size_t row = size_t(width) * 3, first = file.size() + 8 * size_t(height);
    for (size_t y = 0; y < size_t(height); ++y) file += Bytes().put(uint64_t(first + y * (8 + 4 * row))).text;
    for (size_t y = 0; y < size_t(height); ++y) {
        Bytes line;
        line.put(int32_t(y)).put(int32_t(4 * row));
        for (size_t c = 3; c-- > 0;)
            for (size_t x = 0; x < size_t(width); ++x) line.put(values[y * row + 3 * x + c]);
        file += line.text;
    }
    return file;
}

/// EXIF data, or a TIFF's beginning, that say this orientation and nothing else.
inline std::string encode_exif(char orientation) {
    std::string bytes("MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\0\0\0\0\0\0\0", 26);
    bytes[19] = orientation;
    return bytes;
}

/// An ICC profile of three primaries, the columns in CIE XYZ under D50, and one curve. Source: ICC.1:2001-04.
struct IccProfile {
    std::string name = "Test";
    std::string space = "RGB ";
    std::array<double, 9> primaries = {0.43607, 0.22249, 0.01392, 0.38515, 0.71687,
                                       0.09708, 0.14307, 0.06061, 0.71410};  ///< X Y Z of red, green, blue: sRGB's
    double power = 0;                                                        ///< of the curve; 0: sRGB's

    std::string encode() const {
        const auto fixed = [](double v) { return big_endian(uint32_t(int32_t(std::lround(v * 65536)))); };
        const std::string none(4, '\0');
        std::string curve = "para" + none + std::string("\0\3\0\0", 4);
        for (const double v : {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045}) curve += fixed(v);
        if (power > 0) curve = "para" + none + none + fixed(power);
        std::vector<std::pair<std::string, std::string>> tags = {
            {"desc", "desc" + none + big_endian(uint32_t(name.size() + 1)) + name + std::string(79, '\0')},
            {"wtpt", "XYZ " + none + fixed(0.9642) + fixed(1) + fixed(0.8249)}};
        if (space == "GRAY") {
            tags.emplace_back("kTRC", curve);
        } else {
            for (size_t c = 0; c < 3; ++c) {
                const double* p = primaries.data() + 3 * c;
                tags.emplace_back(std::string(1, "rgb"[c]) + "XYZ",
                                  "XYZ " + none + fixed(p[0]) + fixed(p[1]) + fixed(p[2]));
                tags.emplace_back(std::string(1, "rgb"[c]) + "TRC", curve);
            }
        }
        std::string table = big_endian(uint32_t(tags.size())), content;
        for (const auto& [signature, text] : tags) {
            table += signature + big_endian(uint32_t(128 + 4 + 12 * tags.size() + content.size())) +
                     big_endian(uint32_t(text.size()));
            content += text + std::string((4 - text.size() % 4) % 4, '\0');
        }
        std::string head = big_endian(uint32_t(128 + table.size() + content.size())) + none + big_endian(0x02400000) +
                           "mntr" + space + "XYZ " + std::string(12, '\0') + "acsp";
        head += std::string(68 - head.size(), '\0') + fixed(0.9642) + fixed(1) + fixed(0.8249);
        return head + std::string(128 - head.size(), '\0') + table + content;
    }
};

inline IccProfile display_p3() {
    return {
        "Display P3", "RGB ", {0.51512, 0.24120, -0.00105, 0.29198, 0.69225, 0.04189, 0.15710, 0.06657, 0.78407}, 0};
}
inline IccProfile adobe_rgb() {
    return {"Adobe RGB (1998)",
            "RGB ",
            {0.60974, 0.31111, 0.01947, 0.20528, 0.62567, 0.06087, 0.14919, 0.06322, 0.74457},
            2.19921875};
}

/// A PNG's chunk that holds the profile.
inline std::string iccp_chunk(const std::string& profile) {
    return png_chunk("iCCP", std::string("name\0\0", 6) + stored_zlib(profile));
}

}  // namespace radiafit::testing
