#include "eval/outliers.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace radiafit {

std::vector<std::string> outlying_images(const JudgeResult& judged) {
    constexpr double deviations = 5, least_factor = 3, least_error = 1e-12;
    std::vector<double> errors;  // logarithms, of images with pixels
    std::vector<const ImageFigures*> images;
    for (const ImageFigures& image : judged.images) {
        if (image.stored.values == 0 || image.stored.not_finite > 0) continue;
        errors.push_back(std::log(image.stored.squared / double(image.stored.values) + least_error));
        images.push_back(&image);
    }
    if (images.size() < 5) return {};
    const double middle = median(errors);
    std::vector<double> distances;
    for (const double error : errors) distances.push_back(std::abs(error - middle));
    const double most = middle + std::max(deviations * 1.4826 * median(distances), std::log(least_factor));
    std::vector<std::string> out;
    for (size_t i = 0; i < images.size(); ++i)
        if (errors[i] > most) out.push_back(images[i]->name);
    return out;
}

}  // namespace radiafit
