#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/image_file.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"

/// One linear gain per image, for captures with automatic exposure: gain * linear pixel value is comparable between
/// images. Only ratios mean anything; normalize_gains fixes the rest.
namespace radiafit {

/// A table with an image name in the first column and its linear gain in the last one; # comments. Returns the gains in
/// the order of `names`. Throws UserError (file:line) for a gain that is not positive or a name given twice, and when
/// an image is not in the table; rows of other images are passed over.
std::vector<double> read_gains(const std::filesystem::path& file, const std::vector<std::string>& names);

/// Scales to geometric mean 1 over the training views.
void normalize_gains(std::vector<double>& gains, const std::vector<uint8_t>& held_out);

/// What one image says about one surface point.
struct GainSample {
    uint32_t point;
    float log_value;  ///< natural logarithm of the mean linear value of the 3 x 3 pixels around it
};

/// Points on a mesh at which images are compared: about 20,000, spread over its triangles.
class GainPoints {
public:
    explicit GainPoints(const Mesh& mesh);
    /// Samples of the points that one image shows unoccluded, no more than 72 degrees from the surface normal, with
    /// none of the pixels outside the mask (may be empty), clipped or dark. raster has drawn the mesh with camera.
    std::vector<GainSample> observe(const Camera& camera, const Rasterizer& raster, const ImageFile& image,
                                    const std::vector<uint8_t>& mask) const;
    size_t size() const { return points_.size(); }

private:
    struct Point {
        Vec3d position, normal;
    };
    std::vector<Point> points_;
};

struct GainEstimate {
    std::vector<double> gains;    ///< [views], normalized
    std::vector<size_t> guessed;  ///< views that share too few points with others: left at the mean
};

/// Robust least squares in the logarithm: minimizes sum rho(log_value + log gain_view - m_point) over training views'
/// gains and the points' brightness m, rho Cauchy's with its scale from the residuals. A held-out view does not take
/// part; its gain is then the median over the points that the training views have settled.
GainEstimate estimate_gains(const std::vector<std::vector<GainSample>>& samples, const std::vector<uint8_t>& held_out);

}  // namespace radiafit
