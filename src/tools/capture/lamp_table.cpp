#include "capture/lamp_table.h"

#include <fmt/format.h>

namespace radiafit::tools {
namespace {

/// As RFC 4180 has it.
std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + '"';
}

std::string digits(double value) { return fmt::format("{:.3g}", value); }

}  // namespace

std::string lamp_table(const LampCalibration& calibration, const std::vector<std::string>& names) {
    std::string out =
        "image,kind,x,y,z,red,green,blue,degrees,distance_share,red_share,green_share,blue_share,highlight_pixels,"
        "spheres\n";
    for (size_t k = 0; k < calibration.lamps.size(); ++k) {
        const CalibratedLamp& lamp = calibration.lamps[k];
        const Vec3d &place = lamp.light.place, &rgb = lamp.light.intensity;
        const bool near = lamp.light.kind == Light::Kind::near;
        std::string shares = ",,";
        if (!calibration.deviations.empty()) {
            const Vec3d& d = calibration.deviations[k];
            shares = fmt::format("{},{},{}", digits(d.x()), digits(d.y()), digits(d.z()));
        }
        out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(names[k]),
                           near ? "position" : "direction", place.x(), place.y(), place.z(), rgb.x(), rgb.y(), rgb.z(),
                           digits(lamp.deviation_degrees()), near ? digits(lamp.deviation_of_distance()) : "", shares,
                           lamp.spheres ? digits(lamp.residual) : "", lamp.spheres);
    }
    return out;
}

}  // namespace radiafit::tools
