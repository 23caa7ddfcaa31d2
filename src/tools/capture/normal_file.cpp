#include "capture/normal_file.h"

#include <fmt/format.h>

#include "base/error.h"

namespace radiafit::tools {

NormalFile read_normal_file(const std::filesystem::path& file, const HeaderCheck& check) {
    const ImageFile image = read_image(file, true, check);
    const size_t count = size_t(image.width) * size_t(image.height);
    const auto component = [&](size_t i) {
        if (image.bits == 8) return float(image.rgb8[i]) / 127.5f - 1;
        if (image.bits == 16) return float(image.rgb16[i]) / 32767.5f - 1;
        return image.rgb32[i];
    };
    NormalFile result{image.width, image.height, std::vector<Vec3f>(count, Vec3f::Zero())};
    for (size_t i = 0; i < count; ++i) {
        const Vec3f n(component(3 * i), component(3 * i + 1), component(3 * i + 2));
        if (!n.allFinite())
            throw UserError(
                fmt::format("{}: the normal at column {}, row {} is not finite: write 0 0 0 where there is "
                            "none",
                            file.string(), i % size_t(image.width), i / size_t(image.width)));
        const float length = n.norm();
        if (length > 0.5f && length < 1.5f) result.normals[i] = n / length;
    }
    return result;
}

}  // namespace radiafit::tools
