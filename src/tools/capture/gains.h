#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/surface_points.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"
#include "image/image_file.h"

/// Linear gains of images, one for each or one for each of its channels, for captures with automatic exposure: gain *
/// linear pixel value is comparable between images. Only ratios mean anything; normalize_gains fixes the rest.
namespace radiafit::tools {

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
    std::array<float, 3> log_channels = {};  ///< the same of each channel; not a number for a dark one
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
    const Vec3d& position(size_t point) const { return points_[point].position; }

private:
    std::vector<SurfacePoint> points_;
};

struct GainEstimate {
    std::vector<double> gains;    ///< [views], normalized
    std::vector<size_t> guessed;  ///< views that share too few points with others: left at the mean
};

/// Robust least squares in the logarithm: minimizes sum rho(log_value + log gain_view - m_point) over training views'
/// gains and the points' brightness m, rho Cauchy's with its scale from the residuals. A held-out view does not take
/// part; its gain is then the median over the points whose brightness is known from training views.
GainEstimate estimate_gains(const std::vector<std::vector<GainSample>>& samples, const std::vector<uint8_t>& held_out);

struct ChannelGainEstimate {
    std::vector<std::array<double, 3>> gains;  ///< [views], each channel's normalized
    std::vector<size_t> guessed;               ///< as in GainEstimate
};
/// The same channel by channel, for captures whose white balance changed, too. A view of which a channel shows too few
/// points that are not dark has for it what estimate_gains() says.
ChannelGainEstimate estimate_channel_gains(const std::vector<std::vector<GainSample>>& samples,
                                           const std::vector<uint8_t>& held_out);

}  // namespace radiafit::tools
