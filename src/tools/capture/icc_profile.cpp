#include "capture/icc_profile.h"

#include <fmt/format.h>
#include <lcms2.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "dataset/dataset.h"

namespace radiafit::tools {
namespace {

/// A profile that is open, and what the library keeps for it. Errors are told by null handles alone.
class OpenProfile {
public:
    OpenProfile() : context_(cmsCreateContext(nullptr, nullptr)) {
        cmsSetLogErrorHandlerTHR(context_, [](cmsContext, cmsUInt32Number, const char*) {});
    }
    ~OpenProfile() {
        if (transform_) cmsDeleteTransform(transform_);
        if (profile_) cmsCloseProfile(profile_);
        cmsDeleteContext(context_);
    }
    OpenProfile(const OpenProfile&) = delete;
    OpenProfile& operator=(const OpenProfile&) = delete;

    cmsContext context() const { return context_; }
    cmsHPROFILE profile() const { return profile_; }
    cmsHTRANSFORM transform() const { return transform_; }
    bool open(cmsHPROFILE profile) { return (profile_ = profile) != nullptr; }
    bool open_transform(cmsHTRANSFORM transform) { return (transform_ = transform) != nullptr; }

    /// Null where it is not there, or cannot be read.
    template <class T>
    const T* tag(cmsTagSignature signature) const {
        return static_cast<const T*>(cmsReadTag(profile_, signature));
    }

private:
    cmsContext context_;
    cmsHPROFILE profile_ = nullptr;
    cmsHTRANSFORM transform_ = nullptr;
};

using Matrix = Eigen::Matrix3d;

/// The columns are red, green and blue in CIE XYZ under D50; false where one is missing.
bool read_primaries(const OpenProfile& profile, Matrix& columns) {
    const cmsTagSignature tags[] = {cmsSigRedColorantTag, cmsSigGreenColorantTag, cmsSigBlueColorantTag};
    for (int c = 0; c < 3; ++c) {
        const auto* xyz = profile.tag<cmsCIEXYZ>(tags[c]);
        if (!xyz) return false;
        columns.col(c) << xyz->X, xyz->Y, xyz->Z;
    }
    return columns.allFinite();
}

cmsHPROFILE make_linear_srgb(cmsContext context) {
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE primaries = {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* line = cmsBuildGamma(context, 1.0);
    cmsToneCurve* curves[] = {line, line, line};
    const cmsHPROFILE profile = cmsCreateRGBProfileTHR(context, &white, &primaries, curves);
    cmsFreeToneCurve(line);
    return profile;
}

/// From a profile's primaries to sRGB's, both under D50.
bool to_srgb_primaries(const Matrix& primaries, std::array<float, 9>& matrix) {
    OpenProfile srgb;
    Matrix target;
    if (!srgb.open(make_linear_srgb(srgb.context())) || !read_primaries(srgb, target)) return false;
    const Matrix product = target.inverse() * primaries;
    if (!product.allFinite() || product.cwiseAbs().maxCoeff() > 100) return false;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) matrix[size_t(3 * row + column)] = float(product(row, column));
    return true;
}

// ---- What is checked before the library reads a profile (ICC.1:2010, 7.2, 7.3, 10.8 to 10.10)

uint64_t big_number(std::string_view bytes, size_t at, size_t size) {
    uint64_t value = 0;
    for (size_t i = 0; i < size && at + i < bytes.size(); ++i) value = value << 8 | uint8_t(bytes[at + i]);
    return value;
}

/// A table of `size` bytes a value, between `inputs` and `outputs` channels, lies within the tag.
bool table_fits(std::string_view tag, uint64_t inputs, uint64_t outputs, uint64_t begin, uint64_t size,
                const std::function<uint64_t(uint64_t)>& grid) {
    if (inputs < 1 || inputs > 4 || outputs < 1 || outputs > 4) return false;
    uint64_t values = outputs;
    for (uint64_t i = 0; i < inputs; ++i) {
        if (grid(i) < 1) return false;
        values *= grid(i);  // 255^4 * 4 at most
    }
    return begin <= tag.size() && values * size <= tag.size() - begin;
}

/// The content of a tag that has tables by the number of grid points, curves by their length, or texts by theirs.
bool tag_fits(std::string_view tag) {
    const std::string_view type = tag.substr(0, 4);
    if (type == "mft1" || type == "mft2") {
        const uint64_t points = big_number(tag, 10, 1);
        return tag.size() >= 52 && table_fits(tag, big_number(tag, 8, 1), big_number(tag, 9, 1), 48,
                                              type == "mft1" ? 1 : 2, [&](uint64_t) { return points; });
    }
    if (type == "mAB " || type == "mBA ") {
        const uint64_t begin = big_number(tag, 24, 4);
        if (tag.size() < 32) return false;
        if (begin == 0) return true;
        if (begin > tag.size() || tag.size() - begin < 20) return false;
        return table_fits(tag, big_number(tag, 8, 1), big_number(tag, 9, 1), begin + 20,
                          std::max<uint64_t>(big_number(tag, begin + 16, 1), 1),
                          [&](uint64_t i) { return big_number(tag, begin + i, 1); });
    }
    if (type == "curv") return tag.size() >= 12 && big_number(tag, 8, 4) <= (tag.size() - 12) / 2;
    if (type == "para") return tag.size() >= 12 && big_number(tag, 8, 2) <= 4;
    if (type == "XYZ ") return tag.size() >= 20;
    return true;
}

/// Tags that are read here or by the library on the way to a transform.
bool is_read(std::string_view signature) {
    for (const char* known : {"rTRC", "gTRC", "bTRC", "kTRC", "rXYZ", "gXYZ", "bXYZ", "A2B0", "A2B1", "A2B2", "A2B3",
                              "desc", "wtpt", "chad"})
        if (signature == known) return true;
    return false;
}

/// Why a profile's frame is damaged; empty: it is sound. Whether it has the tables of a printer or scanner.
std::string check_profile(std::string_view bytes, bool& tables) {
    constexpr uint64_t header = 128, entry = 12;
    if (bytes.size() < header + 4 || bytes.substr(36, 4) != "acsp") return "it is damaged";
    if (big_number(bytes, 0, 4) > bytes.size()) return "it is cut off";
    const uint64_t count = big_number(bytes, header, 4);
    if (count > 100 || header + 4 + count * entry > bytes.size()) return "it is damaged";
    for (uint64_t i = 0; i < count; ++i) {
        const uint64_t at = header + 4 + i * entry;
        const std::string_view signature = bytes.substr(at, 4);
        const uint64_t begin = big_number(bytes, at + 4, 4), size = big_number(bytes, at + 8, 4);
        if (begin > bytes.size() || size > bytes.size() - begin) return "it is cut off";
        if (signature.starts_with("D2B") || signature == "MPET") return "it has tables of floats (D2B)";
        if (is_read(signature) && !tag_fits(bytes.substr(begin, size))) return "it is damaged";
        tables |= signature.starts_with("A2B");
    }
    return "";
}

/// What the profile calls itself: printable characters, not too many.
std::string profile_name(const OpenProfile& profile) {
    char text[128] = {};
    cmsGetProfileInfoASCII(profile.profile(), cmsInfoDescription, "en", "US", text, sizeof text - 1);
    std::string name;
    for (const char c : std::string_view(text).substr(0, 60)) name += c >= ' ' && c <= '~' && c != '\'' ? c : ' ';
    while (name.ends_with(' ')) name.pop_back();
    return name;
}

/// By the library, point by point: profiles of printers and scanners, and of cameras' raw converters.
void use_tables(std::shared_ptr<OpenProfile> profile, ColorConversion& out) {
    OpenProfile srgb;
    const cmsUInt32Number format = TYPE_RGB_FLT;
    if (!srgb.open(make_linear_srgb(profile->context())) ||
        !profile->open_transform(cmsCreateTransformTHR(profile->context(), profile->profile(), format, srgb.profile(),
                                                       format, INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOCACHE))) {
        out.refusal = "its tables cannot be used";
        return;
    }
    out.transform = [profile](float* rgb, size_t pixels) {
        cmsDoTransform(profile->transform(), rgb, rgb, cmsUInt32Number(pixels));
    };
}

void use_curves(std::shared_ptr<OpenProfile> profile, ColorConversion& out) {
    const cmsTagSignature rgb[] = {cmsSigRedTRCTag, cmsSigGreenTRCTag, cmsSigBlueTRCTag};
    std::array<const cmsToneCurve*, 3> curves;
    for (size_t c = 0; c < 3; ++c) curves[c] = profile->tag<cmsToneCurve>(out.grey ? cmsSigGrayTRCTag : rgb[c]);
    Matrix primaries;
    const bool whole = std::ranges::count(curves, nullptr) == 0;
    if (!whole || (!out.grey && (!read_primaries(*profile, primaries) || !to_srgb_primaries(primaries, out.matrix)))) {
        out.refusal = "it has neither curves with primaries nor tables";
        return;
    }
    out.curve = [profile, curves](int channel, float stored) {
        const float light = cmsEvalToneCurveFloat(curves[size_t(channel)], stored);
        return std::isfinite(light) ? std::clamp(light, 0.0f, 1.0f) : 0.0f;
    };
}

}  // namespace

ColorConversion read_icc_profile(const std::string& bytes) {
    ColorConversion out;
    bool tables = false;
    out.refusal = check_profile(bytes, tables);
    if (!out.refusal.empty()) return out;
    const auto profile = std::make_shared<OpenProfile>();
    if (!profile->open(cmsOpenProfileFromMemTHR(profile->context(), bytes.data(), cmsUInt32Number(bytes.size())))) {
        out.refusal = "it is damaged";
        return out;
    }
    out.name = profile_name(*profile);
    // From the header itself, since the library's enumerations do not hold whatever may stand there.
    const auto word = [&](size_t at) { return std::string_view(bytes).substr(at, 4); };
    const std::string_view kind = word(12), space = word(16), connection = word(20);
    out.grey = space == "GRAY";
    if (space != "RGB " && !out.grey)
        out.refusal = space == "CMYK" ? "it is of CMYK, not of RGB or grey" : "it is not of RGB or grey";
    else if (kind != "scnr" && kind != "mntr" && kind != "prtr" && kind != "spac")
        out.refusal = "it describes no picture's colours";
    else if (out.grey && (tables || connection != "XYZ "))
        out.refusal = "it is of grey by tables";
    else if (tables)
        use_tables(profile, out);
    else
        use_curves(profile, out);
    return out;
}

ColorConversion make_conversion(const std::array<double, 8>& chromaticities, double gamma) {
    ColorConversion out;
    if (chromaticities != std::array<double, 8>{}) {
        const auto& c = chromaticities;
        const auto usable = [](double x, double y) { return x >= 0 && x <= 1 && y > 1e-3 && y <= 1; };
        OpenProfile profile;
        const cmsCIExyY white = {c[6], c[7], 1};
        const cmsCIExyYTRIPLE primaries = {{c[0], c[1], 1}, {c[2], c[3], 1}, {c[4], c[5], 1}};
        cmsToneCurve* line = cmsBuildGamma(profile.context(), 1.0);
        cmsToneCurve* curves[] = {line, line, line};
        Matrix columns;
        const bool fine = usable(c[0], c[1]) && usable(c[2], c[3]) && usable(c[4], c[5]) && usable(c[6], c[7]) &&
                          profile.open(cmsCreateRGBProfileTHR(profile.context(), &white, &primaries, curves)) &&
                          read_primaries(profile, columns) && to_srgb_primaries(columns, out.matrix);
        cmsFreeToneCurve(line);
        if (!fine) out.refusal = "they are no colours";
    }
    out.curve = [gamma](int, float stored) {
        if (gamma == 0) return float(srgb_decode(double(stored)));
        return gamma == 1 ? stored : std::pow(stored, float(1 / gamma));
    };
    return out;
}

}  // namespace radiafit::tools
