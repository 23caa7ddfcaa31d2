// .rti: lines that begin with #, then the kind (3), width, height and channels, terms, kind of terms and bytes of each;
// then floats, a scale and a bias for each term, and the bytes: row by row from the top, pixel by pixel, the terms of
// red, of green, of blue.
#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "capture/file_head.h"
#include "capture/lamp_functions.h"
#include "capture/rti_formats.h"
#include "image/image_header.h"

namespace radiafit::tools {
namespace {

constexpr int harmonics_kind = 3;  ///< the kind that is read

const char* name_of_rti_kind(int kind) {
    constexpr const char* names[] = {"a reserved kind", "a polynomial texture map", "spherical harmonics",
                                     "hemispherical harmonics", "an adaptive basis"};
    return kind >= 0 && kind <= 4 ? names[kind] : "an unknown kind";
}

/// Little-endian, as this program's machines are.
std::vector<float> hsh_floats(FileHead& head, size_t count) {
    const std::string_view bytes = head.bytes(count * sizeof(float));
    std::vector<float> out(count);
    std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
}

}  // namespace

RtiFile read_hsh(const std::filesystem::path& file, std::string_view bytes, const RtiSizeCheck& check) {
    FileHead head(file, bytes);
    while (head.rest().starts_with('#')) head.line();
    const int kind = head.whole("kind", 0, 1000);
    if (kind != harmonics_kind)
        throw UserError(
            fmt::format("{}: an .rti of kind {}, {}: only hemispherical harmonics (kind 3) are read; fit the "
                        "photographs themselves, or export them as HSH",
                        file.string(), kind, name_of_rti_kind(kind)));
    RtiFile out;
    out.width = head.whole("width", 1, int(largest_image_side));
    out.height = head.whole("height", 1, int(largest_image_side));
    const int channels = head.whole("number of channels", 0, 1000);
    const int terms = head.whole("number of terms", 0, 1000), term_kind = head.whole("kind of terms", 0, 1000);
    const int term_bytes = head.whole("bytes of a term", 0, 1000);
    head.end_line();
    out.model = hsh_model(size_t(terms));
    if (channels != 3 || term_kind != 2 || term_bytes != 1 || !out.model)
        throw UserError(
            fmt::format("{}: {} channels of {} terms of kind {}, {} bytes each: only 3 channels of 4, 9 or 16 terms "
                        "of kind 2, a byte each, are read; export it as HSH of order 2, 3 or 4",
                        file.string(), channels, terms, term_kind, term_bytes));
    out.kind = fmt::format("HSH of {} terms", terms);
    const size_t count = size_t(terms);
    const std::vector<float> scale = hsh_floats(head, count), bias = hsh_floats(head, count);
    check_quantization(file, scale, bias);
    const size_t pixels = size_t(out.width) * size_t(out.height);
    out.numbers = 3 * count;
    const std::string_view stored = head.bytes(pixels * out.numbers);
    if (check) check(out.width, out.height, out.numbers);
    out.values.resize(pixels * out.numbers);
    parallel_for(pixels, 4096, [&](size_t p, int) {
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < count; ++k)
                out.values[p * out.numbers + 3 * k + c] =
                    float(uint8_t(stored[p * out.numbers + c * count + k])) / 255 * scale[k] + bias[k];
    });
    out.functions = [count](const Vec3d& lamp) { return in_each_channel(hsh_functions(lamp, count)); };
    return out;
}

}  // namespace radiafit::tools
