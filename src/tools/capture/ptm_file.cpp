// .ptm (Malzbender and Gelb, "Polynomial Texture Map (.ptm) File Format", version 1.2, 2001): lines of version and
// format; width, height, six scales, six biases; then bytes, or pictures in their place, row by row from the bottom. A
// number is scale (byte - bias), of x^2, y^2, x y, x, y, 1; white is 255.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/parallel.h"
#include "capture/file_head.h"
#include "capture/lamp_functions.h"
#include "capture/rti_formats.h"
#include "image/image_file.h"
#include "image/image_header.h"

namespace radiafit::tools {
namespace {

constexpr size_t ptm_terms = 6;

struct PtmFormat {
    const char* name;
    bool luminance;  ///< a polynomial of luminance, and a colour that it is multiplied by; else one of each channel
    bool jpeg;
    size_t planes() const { return luminance ? ptm_terms + 3 : 3 * ptm_terms; }
};
constexpr PtmFormat ptm_formats[] = {{"PTM_FORMAT_LRGB", true, false},
                                     {"PTM_FORMAT_RGB", false, false},
                                     {"PTM_FORMAT_JPEG_LRGB", true, true},
                                     {"PTM_FORMAT_JPEG_RGB", false, true}};

const PtmFormat& ptm_format_of(const std::filesystem::path& file, std::string_view name) {
    const auto* found = std::ranges::find(ptm_formats, name, &PtmFormat::name);
    if (found == std::end(ptm_formats))
        throw UserError(
            fmt::format("{}: a .ptm of format '{}': PTM_FORMAT_LRGB, PTM_FORMAT_RGB and their JPEG kinds "
                        "are read; export it as one of these",
                        file.string(), name));
    return *found;
}

/// How a plane that was stored as a picture comes of it: the picture itself; or it is what another plane, perhaps
/// turned over, leaves.
struct PtmPlane {
    int transform, order, reference;
    uint64_t bytes, corrections;  ///< of the picture; of the values behind it that replace some of its own
};

std::vector<PtmPlane> read_ptm_planes(FileHead& head, size_t count) {
    constexpr int far = 1 << 30;
    std::vector<PtmPlane> planes(count);
    head.number("compression parameter");
    for (PtmPlane& p : planes) p.transform = head.whole("transform", 0, far);
    for (size_t i = 0; i < 2 * count; ++i)
        if (head.whole("motion vector", -far, far) != 0)
            throw UserError(
                fmt::format("{}: its planes are predicted with motion vectors, which is not read; export it "
                            "without compression",
                            head.file().string()));
    for (PtmPlane& p : planes) p.order = head.whole("order of planes", 0, int(count) - 1);
    for (PtmPlane& p : planes) p.reference = head.whole("reference plane", -1, int(count) - 1);
    for (PtmPlane& p : planes) p.bytes = uint64_t(head.whole("size of a plane", 0, far));
    for (PtmPlane& p : planes) p.corrections = uint64_t(head.whole("size of corrections", 0, far));
    head.end_line();
    return planes;
}

/// Places (four bytes, the highest first) and the values there.
void correct_plane(const FileHead& head, std::string_view corrections, std::vector<uint8_t>& plane) {
    constexpr size_t entry = 5;
    for (size_t i = 0; i + entry <= corrections.size(); i += entry) {
        uint64_t place = 0;
        for (size_t j = 0; j < 4; ++j) place = place << 8 | uint8_t(corrections[i + j]);
        if (place >= plane.size()) head.fail("a correction lies outside the image");
        plane[place] = uint8_t(corrections[i + 4]);
    }
}

/// [plane][pixel], rows as in the file.
std::vector<std::vector<uint8_t>> decode_ptm_planes(FileHead& head, const std::vector<PtmPlane>& stored, int width,
                                                    int height) {
    std::vector<std::vector<uint8_t>> planes;
    std::vector<std::string_view> corrections;
    for (const PtmPlane& s : stored) {
        const ImageFile image = decode_image(head.file(), std::string(head.bytes(s.bytes)), [&](int w, int h) {
            if (w != width || h != height)
                head.fail(fmt::format("a plane has {} x {} pixels, not {} x {}", w, h, width, height));
        });
        if (!image.grey || image.bits != 8) head.fail("a plane is no grey picture of 8 bits");
        corrections.push_back(head.bytes(s.corrections));
        std::vector<uint8_t>& plane = planes.emplace_back(image.rgb8.size() / 3);
        for (size_t i = 0; i < plane.size(); ++i) plane[i] = image.rgb8[3 * i];
    }
    std::vector<bool> done(stored.size());
    for (int turn = 0; turn < int(stored.size()); ++turn) {
        const auto next = std::ranges::find(stored, turn, &PtmPlane::order);
        if (next == stored.end()) head.fail("the order of its planes leaves one out");
        std::vector<uint8_t>& plane = planes[size_t(next - stored.begin())];
        if (next->reference >= 0) {
            if (!done[size_t(next->reference)]) head.fail("a plane is predicted from one that comes later");
            const std::vector<uint8_t>& from = planes[size_t(next->reference)];
            const bool turned = (next->transform & 1) != 0;
            for (size_t i = 0; i < plane.size(); ++i)
                plane[i] = uint8_t(plane[i] + (turned ? 255 - from[i] : from[i]) - 128);
        }
        correct_plane(head, corrections[size_t(next - stored.begin())], plane);
        done[size_t(next - stored.begin())] = true;
    }
    return planes;
}

}  // namespace

RtiFile read_ptm(const std::filesystem::path& file, std::string_view bytes, const RtiSizeCheck& check) {
    FileHead head(file, bytes);
    const std::string_view version = head.line();
    if (version != "PTM_1.2" && version != "PTM_1.1")
        throw UserError(
            fmt::format("{}: a .ptm of version '{}': PTM_1.1 and PTM_1.2 are read; export it as one of these",
                        file.string(), version));
    const PtmFormat& format = ptm_format_of(file, head.line());
    RtiFile out;
    out.kind = format.name;
    out.model = find_texel_model("ptm");
    out.numbers = 3 * ptm_terms;
    out.functions = [](const Vec3d& lamp) { return in_each_channel(ptm_functions(lamp)); };
    out.width = head.whole("width", 1, int(largest_image_side));
    out.height = head.whole("height", 1, int(largest_image_side));
    std::array<float, ptm_terms> scale{}, bias{};
    for (float& value : scale) value = float(head.number("scale"));
    for (float& value : bias) value = float(head.number("bias"));
    check_quantization(file, scale, bias);
    const auto width = size_t(out.width), height = size_t(out.height), pixels = width * height;

    // stored(plane, pixel): a byte; planes: coefficients, then the colour, or coefficients channel by channel
    const auto take = [&](const auto& stored) {
        const auto coefficient = [&](size_t plane, size_t pixel) {
            return scale[plane % ptm_terms] * (float(stored(plane, pixel)) - bias[plane % ptm_terms]) / 255;
        };
        out.values.resize(pixels * out.numbers);
        parallel_for(height, 1, [&](size_t row, int) {
            for (size_t column = 0; column < width; ++column) {
                const size_t pixel = (height - 1 - row) * width + column;
                float* values = &out.values[(row * width + column) * out.numbers];
                for (size_t k = 0; k < ptm_terms; ++k)
                    for (size_t c = 0; c < 3; ++c)
                        values[3 * k + c] = format.luminance
                                                ? coefficient(k, pixel) * float(stored(ptm_terms + c, pixel)) / 255
                                                : coefficient(c * ptm_terms + k, pixel);
            }
        });
    };
    if (format.jpeg) {
        const std::vector<PtmPlane> stored = read_ptm_planes(head, format.planes());
        if (check) check(out.width, out.height, out.numbers + format.planes() / sizeof(float));
        const auto planes = decode_ptm_planes(head, stored, out.width, out.height);
        take([&](size_t plane, size_t pixel) { return planes[plane][pixel]; });
        return out;
    }
    head.end_line();
    const std::string_view stored = head.bytes(pixels * format.planes());
    if (check) check(out.width, out.height, out.numbers);
    if (!format.luminance)
        take([&](size_t plane, size_t pixel) {
            return uint8_t(stored[(plane / ptm_terms * pixels + pixel) * ptm_terms + plane % ptm_terms]);
        });
    else if (version == "PTM_1.1")
        take([&](size_t plane, size_t pixel) { return uint8_t(stored[pixel * (ptm_terms + 3) + plane]); });
    else
        take([&](size_t plane, size_t pixel) {
            return uint8_t(plane < ptm_terms ? stored[pixel * ptm_terms + plane]
                                             : stored[pixels * ptm_terms + pixel * 3 + plane - ptm_terms]);
        });
    return out;
}

}  // namespace radiafit::tools
