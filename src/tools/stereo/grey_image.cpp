#include "stereo/grey_image.h"

#include "base/error.h"

namespace radiafit::tools {

GreyImage grey_of(const ImageFile& image, const Camera& camera) {
    if (image.width != camera.width || image.height != camera.height)
        throw SystemError("grey_of(): the image has another size than its camera");
    GreyImage grey{camera, std::vector<float>(size_t(image.width) * size_t(image.height))};
    for (size_t i = 0; i < grey.values.size(); ++i) {
        float sum = 0;
        for (size_t c = 0; c < 3; ++c)
            sum += image.bits == 8 ? float(image.rgb8[3 * i + c]) / 255 : float(image.rgb16[3 * i + c]) / 65535;
        grey.values[i] = sum / 3;
    }
    return grey;
}

GreyImage halved(const GreyImage& image) {
    const int width = image.camera.width / 2, height = image.camera.height / 2;
    GreyImage half{image.camera, std::vector<float>(size_t(width) * size_t(height))};
    half.camera.width = width;
    half.camera.height = height;
    for (double* number : {&half.camera.fx, &half.camera.fy, &half.camera.cx, &half.camera.cy}) *number /= 2;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float* above = image.values.data() + size_t(2 * y) * size_t(image.camera.width) + size_t(2 * x);
            const float* below = above + image.camera.width;
            half.values[size_t(y) * size_t(width) + size_t(x)] = (above[0] + above[1] + below[0] + below[1]) / 4;
        }
    return half;
}

}  // namespace radiafit::tools
