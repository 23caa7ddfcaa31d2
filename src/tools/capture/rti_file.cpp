#include "capture/rti_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/read_file.h"
#include "capture/rti_formats.h"

namespace radiafit::tools {
namespace fs = std::filesystem;

void check_quantization(const fs::path& file, const char* what, double value) {
    constexpr double most = 1e6;  // white being 1 or 255
    if (!(std::abs(value) <= most))
        throw UserError(fmt::format("{}: truncated or corrupt (a {} of {:g}); copy it again from where it was made",
                                    file.string(), what, value));
}

void check_quantization(const fs::path& file, std::span<const float> scale, std::span<const float> bias) {
    for (const float value : scale) check_quantization(file, "scale", double(value));
    for (const float value : bias) check_quantization(file, "bias", double(value));
    if (std::ranges::all_of(scale, [](float value) { return value == 0; }))
        throw UserError(
            fmt::format("{}: each scale is 0, as a program writes that fails to set them, so the lamp makes no "
                        "difference; export it again, or from another program",
                        file.string()));
}

RtiFile read_rti(const fs::path& file, const RtiSizeCheck& check) {
    const fs::path path = folder_exists(file) ? file / "info.json" : file;
    const std::string bytes = read_file(path, "file of RTI");
    if (bytes.starts_with("PTM_")) return read_ptm(path, bytes, check);
    if (bytes.starts_with("#HSH")) return read_hsh(path, bytes, check);
    if (const size_t first = bytes.find_first_not_of(" \t\r\n"); first != std::string::npos && bytes[first] == '{')
        return read_relight(path, bytes, check);
    throw UserError(
        fmt::format("{}: neither a .ptm nor an .rti of hemispherical harmonics nor relight's info.json: name one "
                    "of these",
                    path.string()));
}

}  // namespace radiafit::tools
