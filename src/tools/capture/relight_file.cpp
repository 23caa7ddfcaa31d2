// relight (CNR-ISTI): info.json says what planes mean; plane_0.jpg, ... have three of them each, as red, green and
// blue. A plane's number is scale (byte / 255 - bias).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "capture/lamp_functions.h"
#include "capture/rti_formats.h"
#include "image/image_file.h"
#include "image/image_header.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int most_planes = 300;  ///< as many numbers as a light basis may have for a texel
constexpr int most_lamps = 10000;

/// info.json, and what is wrong with it.
class RelightInfo {
public:
    RelightInfo(fs::path file, std::string_view text) : file_(std::move(file)), json_(parse_json<Json>(text)) {
        if (!json_.is_object()) fail("no JSON object");
        const Json& materials = at(json_, "materials");
        if (!materials.is_array() || materials.size() != 1 || !materials[0].is_object()) fail("not one of materials");
    }

    int whole(const char* key, int least, int most) const {
        const Json& value = at(json_, key);
        if (!value.is_number_integer() || value < least || value > most)
            fail(fmt::format("{} is no whole number from {} to {}", key, least, most));
        return value.get<int>();
    }
    std::string word(const char* key) const {
        const Json& value = at(json_, key);
        if (!value.is_string()) fail(fmt::format("{} is no text", key));
        return value.get<std::string>();
    }
    double number_or(const char* key, double otherwise) const {
        return json_.contains(key) ? number(json_.at(key), key) : otherwise;
    }
    bool has(const char* key) const { return json_.contains(key); }
    std::vector<double> numbers(const char* key, size_t count) const { return numbers(json_, key, count); }
    /// As many as there are.
    std::vector<double> numbers(const char* key) const {
        const Json& list = at(json_, key);
        return numbers(json_, key, list.is_array() ? list.size() : 0);
    }
    /// Of the planes.
    std::vector<double> material(const char* key, size_t count) const {
        return numbers(json_.at("materials")[0], key, count);
    }

    [[noreturn]] void fail(const std::string& why) const {
        throw UserError(
            fmt::format("{}: truncated or corrupt ({}); copy it again from where it was made", file_.string(), why));
    }
    /// What it is, is not read.
    [[noreturn]] void refuse(const std::string& what, const char* cure) const {
        throw UserError(fmt::format("{}: {}, which is not read: {}", file_.string(), what, cure));
    }
    const fs::path& file() const { return file_; }

private:
    const Json& at(const Json& object, const char* key) const {
        if (!object.contains(key)) fail(fmt::format("no {}", key));
        return object.at(key);
    }
    double number(const Json& value, const char* key) const {
        if (!value.is_number()) fail(fmt::format("{} has no number", key));
        check_quantization(file_, key, value.get<double>());
        return value.get<double>();
    }
    std::vector<double> numbers(const Json& object, const char* key, size_t count) const {
        const Json& list = at(object, key);
        if (!list.is_array() || list.size() != count) fail(fmt::format("{} is no list of {} numbers", key, count));
        std::vector<double> out;
        for (const Json& value : list) out.push_back(number(value, key));
        return out;
    }

    fs::path file_;
    Json json_;
};

struct RelightPlanes {
    size_t count = 0;
    std::vector<double> scale, bias;
};

fs::path picture_of(const RelightInfo& info, size_t picture) {
    return info.file().parent_path() / fmt::format("plane_{}.jpg", picture);
}

/// Throws UserError where a picture has another size than info.json says.
HeaderCheck size_check(const RelightInfo& info, const RtiFile& out, const fs::path& file) {
    return [&info, &out, file](int width, int height) {
        if (width != out.width || height != out.height)
            throw UserError(fmt::format("{}: {} x {} pixels, but {} says {} x {}: take both from one folder",
                                        file.string(), width, height, info.file().string(), out.width, out.height));
    };
}

/// Before memory is taken for so many pixels: that there are pictures of them.
void check_first_picture(const RelightInfo& info, const RtiFile& out) {
    const fs::path file = picture_of(info, 0);
    for (const char* tiled : {"plane_0.tzi", "plane_0.dzi", "plane_0_files", "plane_0"})
        if (!path_exists(file) && path_exists(file.parent_path() / tiled))
            info.refuse(fmt::format("its planes are cut into tiles ({})", tiled),
                        "build it with whole pictures, plane_0.jpg and so on, beside it");
    const ImageHeader header = read_image_header(file, read_file(file, "plane"));
    size_check(info, out, file)(int(header.width), int(header.height));
}

/// store(pixel, plane, value) of every plane.
void read_relight_planes(const RelightInfo& info, const RtiFile& out, const RelightPlanes& planes, const auto& store) {
    parallel_for((planes.count + 2) / 3, 1, [&](size_t picture, int) {
        const fs::path file = picture_of(info, picture);
        const ImageFile image = read_image(file, false, size_check(info, out, file));
        if (image.bits != 8)
            throw UserError(
                fmt::format("{}: {} bits a channel, not 8: take relight's own JPEG", file.string(), image.bits));
        for (size_t c = 0; c < 3 && 3 * picture + c < planes.count; ++c) {
            const size_t plane = 3 * picture + c;
            const auto scale = float(planes.scale[plane]), bias = float(planes.bias[plane]);
            for (size_t p = 0; p < image.rgb8.size() / 3; ++p)
                store(p, plane, scale * (float(image.rgb8[3 * p + c]) / 255 - bias));
        }
    });
}

// Planes of functions of the lamp: coefficients themselves, or with a colour in front.

using LampFunctions = std::vector<double> (*)(const Vec3d& lamp, size_t terms);

/// 1, x, y, x^2, x y, y^2, or the first three of them.
std::vector<double> relight_polynomial(const Vec3d& lamp, size_t terms) {
    const auto [xx, yy, xy, x, y, one] = ptm_functions(lamp);
    std::vector<double> all = {one, x, y, xx, xy, yy};
    all.resize(terms);
    return all;
}
const TexelModel* polynomial_model(size_t terms) {
    return terms == 3 || terms == 6 ? find_texel_model("ptm") : nullptr;
}

void read_coefficients(const RelightInfo& info, const RelightPlanes& planes, LampFunctions functions, size_t terms,
                       bool colour, RtiFile& out) {
    out.numbers = 3 * terms;
    out.functions = [=](const Vec3d& lamp) { return in_each_channel(functions(lamp, terms)); };
    const size_t pixels = size_t(out.width) * size_t(out.height);
    out.values.resize(pixels * out.numbers);
    if (!colour) {
        read_relight_planes(info, out, planes,
                            [&](size_t p, size_t plane, float value) { out.values[p * out.numbers + plane] = value; });
        return;
    }
    std::vector<float> stored(pixels * planes.count);
    read_relight_planes(info, out, planes,
                        [&](size_t p, size_t plane, float value) { stored[p * planes.count + plane] = value; });
    parallel_for(pixels, 4096, [&](size_t p, int) {
        const float* own = &stored[p * planes.count];
        for (size_t k = 0; k < terms; ++k)
            for (size_t c = 0; c < 3; ++c) out.values[p * out.numbers + 3 * k + c] = own[3 + k] * own[c];
    });
}

// Planes of principal components: what these are under lamps, and how one sees between the lamps.

/// How much each lamp's colours count at a direction.
using LampWeights = std::function<Eigen::VectorXd(const Vec3d& lamp)>;

/// A Gaussian of the distance to each.
LampWeights radial(const RelightInfo& info, size_t& lamps) {
    const std::vector<double> list = info.numbers("lights");
    if (list.empty() || list.size() % 3 != 0 || list.size() > 3 * most_lamps)
        info.fail("lights are no list of directions");
    lamps = list.size() / 3;
    const double sigma = info.number_or("sigma", 0.125);  // relight's own
    if (!(sigma >= 1e-3)) info.fail("sigma is no number above 0");
    std::vector<Vec3d> directions;
    for (size_t i = 0; i < lamps; ++i) directions.emplace_back(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
    return [directions, sigma](const Vec3d& lamp) {
        Eigen::VectorXd squares(Eigen::Index(directions.size()));
        for (size_t i = 0; i < directions.size(); ++i) squares[Eigen::Index(i)] = (lamp - directions[i]).squaredNorm();
        Eigen::VectorXd weights = (-(squares.array() - squares.minCoeff()) / (sigma * sigma)).exp();
        return Eigen::VectorXd(weights / weights.sum());
    };
}

/// Lamp i + side j lies at ((s - t) / 2, (s + t) / 2) of the octahedron's plane, s and t from -1 to 1.
LampWeights between_grid(const RelightInfo& info, size_t& lamps) {
    const int side = info.whole("resolution", 2, 100);
    lamps = size_t(side) * size_t(side);
    return [side](const Vec3d& lamp) {
        const double sum = lamp.cwiseAbs().sum();
        const double s = (lamp.x() + lamp.y()) / sum, t = (lamp.y() - lamp.x()) / sum;
        const double x = (s + 1) / 2 * (side - 1), y = (t + 1) / 2 * (side - 1);
        const int i = std::clamp(int(x), 0, side - 2), j = std::clamp(int(y), 0, side - 2);
        const double right = x - i, down = y - j;
        Eigen::VectorXd weights = Eigen::VectorXd::Zero(Eigen::Index(side) * side);
        weights[i + side * j] = (1 - right) * (1 - down);
        weights[i + 1 + side * j] = right * (1 - down);
        weights[i + side * (j + 1)] = (1 - right) * down;
        weights[i + 1 + side * (j + 1)] = right * down;
        return weights;
    };
}

/// Bytes, in info.json, or as older versions had them, in materials.bin.
std::vector<double> basis_bytes(const RelightInfo& info, size_t count) {
    if (info.has("basis")) return info.numbers("basis", count);
    const fs::path file = info.file().parent_path() / "materials.bin";
    if (!path_exists(file)) info.fail("no basis, and no materials.bin beside it");
    const std::string bytes = read_file(file, "basis");
    if (bytes.size() != count)
        throw UserError(fmt::format("{}: {} bytes, but the basis of {} has {}: take both from one folder",
                                    file.string(), bytes.size(), info.file().string(), count));
    std::vector<double> out;
    for (const char byte : bytes) out.push_back(uint8_t(byte));
    return out;
}

/// Of luminance and chroma: which of Y, Co, Cg (0, 1, 2) each plane is of. The first three times as many as there are
/// of Co take turns, the others are of Y.
std::vector<int> components_of_planes(const RelightInfo& info) {
    const std::vector<double> counts = info.numbers("yccplanes", 3);
    const double planes = counts[0] + 2 * counts[1];
    if (counts[1] != counts[2] || !(counts[1] >= 0) || !(counts[0] >= counts[1]) ||
        !(planes >= 1 && planes <= most_planes))
        info.fail("yccplanes are no numbers of planes");
    std::vector<int> out;
    for (int p = 0; p < int(planes); ++p) out.push_back(p < 3 * int(counts[1]) ? p % 3 : 0);
    return out;
}

/// Red, green and blue of Y, Co, Cg.
Eigen::Matrix3d rgb_of_chroma() {
    Eigen::Matrix3d out;
    out << 1, 0.5, -0.5,  //
        1, 0, 0.5,        //
        1, -0.5, -0.5;
    return out;
}

struct RelightType {
    const char* name;
    // Of sums of functions
    LampFunctions functions = nullptr;
    const TexelModel* (*model)(size_t terms) = nullptr;
    // Of components
    LampWeights (*weights)(const RelightInfo& info, size_t& lamps) = nullptr;

    bool takes(const std::string& colours) const {
        return functions ? colours == "rgb" || colours == "lrgb" : colours == "mrgb" || colours == "mycc";
    }
};
constexpr RelightType relight_types[] = {{.name = "ptm", .functions = relight_polynomial, .model = polynomial_model},
                                         {.name = "hsh", .functions = hsh_functions, .model = hsh_model},
                                         {.name = "rbf", .weights = radial},
                                         {.name = "bilinear", .weights = between_grid}};

/// relight names the profile since 2026; before, it left values as pictures stored them.
ValueCurve curve_of(const RelightInfo& info) {
    if (!info.has("colorprofile")) return ValueCurve::srgb;
    const std::string profile = info.word("colorprofile");
    if (profile == "RGB") return ValueCurve::linear;
    if (profile != "sRGB")
        info.refuse("colour profile " + profile, "build it again with the profile sRGB (relight-cli -I srgb)");
    return ValueCurve::srgb;
}

}  // namespace

RtiFile read_relight(const fs::path& file, std::string_view text, const RtiSizeCheck& check) {
    const RelightInfo info(file, text);
    RtiFile out;
    out.width = info.whole("width", 1, int(largest_image_side));
    out.height = info.whole("height", 1, int(largest_image_side));
    const std::string name = info.word("type"), colours = info.word("colorspace");
    const auto* type = std::ranges::find(relight_types, name, &RelightType::name);
    if (type == std::end(relight_types) || !type->takes(colours))
        info.refuse(fmt::format("type {} in colour space {}", name, colours),
                    "build it as ptm or hsh in rgb or lrgb, or as rbf or bilinear in mrgb or mycc");
    out.kind = fmt::format("relight's {}, {}", name, colours);
    out.curve = curve_of(info);
    RelightPlanes planes;
    const std::vector<int> component = colours == "mycc" ? components_of_planes(info) : std::vector<int>();
    planes.count = component.empty() ? size_t(info.whole("nplanes", 1, most_planes)) : component.size();
    planes.scale = info.material("scale", planes.count);
    planes.bias = info.material("bias", planes.count);
    check_first_picture(info, out);

    if (type->functions) {
        const bool colour = colours == "lrgb";
        for (size_t c = 0; c < 3 && colour && c < planes.count; ++c)  // as they are, whatever older versions wrote
            planes.scale[c] = 1, planes.bias[c] = 0;
        const size_t terms = colour ? planes.count - std::min<size_t>(3, planes.count) : planes.count / 3;
        out.model = type->model(terms);
        if (!out.model || planes.count != (colour ? terms + 3 : 3 * terms))
            info.refuse(fmt::format("{} planes of type {} in colour space {}", planes.count, name, colours),
                        "build it with 3 or 6 terms of ptm, or 4, 9 or 16 of hsh");
        if (check) check(out.width, out.height, 3 * terms + (colour ? planes.count : 0));
        read_coefficients(info, planes, type->functions, terms, colour, out);
        return out;
    }

    size_t lamps = 0;
    const LampWeights weights = type->weights(info, lamps);
    const std::vector<double> range = info.material("range", planes.count);
    for (const double r : range)
        if (!(r > 0)) info.fail("a range is no number above 0");
    const std::vector<double> bytes = basis_bytes(info, (planes.count + 1) * lamps * 3);
    // [3 lamps][1 + planes] colours under each lamp
    const auto basis = std::make_shared<Eigen::MatrixXd>(Eigen::Index(3 * lamps), Eigen::Index(1 + planes.count));
    for (size_t p = 0; p <= planes.count; ++p)
        for (size_t i = 0; i < 3 * lamps; ++i) {
            double value = bytes[p * 3 * lamps + i];
            value = p == 0 ? value / 255 : (value - 127) / range[p - 1];
            if (p > 0 && !component.empty() && int(i % 3) != component[p - 1]) value = 0;
            (*basis)(Eigen::Index(i), Eigen::Index(p)) = value;
        }
    if (!component.empty())
        for (size_t l = 0; l < lamps; ++l) {
            auto rows = basis->middleRows(Eigen::Index(3 * l), 3);
            rows = (rgb_of_chroma() * rows).eval();
        }
    out.numbers = planes.count;
    out.functions = [weights, basis](const Vec3d& lamp) {
        const Eigen::VectorXd w = weights(lamp);
        LampMatrix at = LampMatrix::Zero(3, basis->cols());
        for (Eigen::Index l = 0; l < w.size(); ++l)
            if (w[l] > 0) at += w[l] * basis->middleRows(3 * l, 3);
        return at;
    };
    if (check) check(out.width, out.height, out.numbers);
    out.values.resize(size_t(out.width) * size_t(out.height) * out.numbers);
    read_relight_planes(info, out, planes,
                        [&](size_t p, size_t plane, float value) { out.values[p * out.numbers + plane] = value; });
    return out;
}

}  // namespace radiafit::tools
