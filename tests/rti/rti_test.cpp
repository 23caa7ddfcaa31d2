// Files of RTI by other programs: what is read of them shows what their bytes mean by the formats' descriptions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "dataset/dataset.h"
#include "eval/pixel_areas.h"
#include "eval/render.h"
#include "fitting/family.h"
#include "image/image_file.h"
#include "image/web/jpeg_image.h"
#include "picture_bytes.h"
#include "rti/import_rti.h"
#include "rti/rti_fit.h"
#include "rti_writer.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace tools;
using namespace fits;
namespace {

using testing::HshBytes;
using testing::PtmBytes;
using Value = std::function<double(size_t pixel, size_t channel, const Vec3d& lamp)>;

class RtiFiles : public ::testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        write_file(folder_.path() / name, bytes);
        return folder_.path() / name;
    }
    /// What the file says in double is what was read of it.
    static void expect_values(const RtiFile& file, const Value& value) {
        for (const Vec3d& lamp : testing::some_lamps(20, 3)) {
            const LampMatrix at = file.functions(lamp);
            for (size_t p = 0; p < file.values.size() / file.numbers; ++p)
                for (size_t c = 0; c < 3; ++c) {
                    double sum = at(int(c), 0);
                    for (size_t k = 0; k < file.numbers; ++k)
                        sum += at(int(c), 1 + int(k)) * double(file.values[p * file.numbers + k]);
                    ASSERT_NEAR(sum, value(p, c, lamp), 2e-6 * (1 + std::abs(value(p, c, lamp)))) << "pixel " << p;
                }
        }
    }
    /// The fit shows, under lamps amid the made ones, the light whose sRGB that is; or with `curve`, on that.
    void expect_shown(const std::filesystem::path& file, const Value& value, double error,
                      ValueCurve curve = ValueCurve::srgb, std::optional<ValueCurve> chosen = {}) const {
        const auto out = folder_.path() / "fit", lamps = folder_.path() / "fit-lamps";
        import_rti(
            {.file = file, .dataset = {}, .images = lamps, .curve = chosen, .provenance_json = {}, .force = true}, out);
        Fitted fit = open_fit(out);
        const Dataset& dataset = fit.dataset();
        const Contestant contestant = contestant_of(fit);
        for (const Vec3d& lamp : testing::some_lamps(12, 5)) {
            View view = dataset.views.front();
            view.light->place = lamp;
            const LightImage shown = render(contestant, dataset, view);
            for (size_t i = 0; i < shown.rgb.size(); ++i) {
                const auto stored = float(std::clamp(value(i / 3, i % 3, lamp), 0.0, 1.0));
                const double light = double(from_curve(curve, stored));
                ASSERT_NEAR(std::min(1.0f, shown.rgb[i]), light, error)
                    << "lamp " << lamp.transpose() << ", value " << i;
            }
        }
    }
    TemporaryFolder folder_;
};

PtmBytes some_ptm(size_t planes) {
    PtmBytes ptm{7, 5, {1, 0.5, 2, 1, 1.5, 1}, {200, 180, 128, 100, 127, 0}, {}};
    ptm.planes = testing::random_planes(planes, ptm.pixels(), planes, 100, 220);
    return ptm;
}
Value value_of(const PtmBytes& ptm) {
    return [=](size_t p, size_t c, const Vec3d& l) { return ptm.value(p, c, l); };
}
HshBytes some_hsh(size_t terms) {
    HshBytes hsh{6, 4, {}, {}, {}};
    for (size_t k = 0; k < terms; ++k) hsh.scale.push_back(0.4f + 0.02f * float(k)), hsh.bias.push_back(-0.2f);
    hsh.bias[0] = 0.9f;
    hsh.planes = testing::random_planes(3 * terms, 24, terms);
    return hsh;
}
Value value_of(const HshBytes& hsh) {
    return [=](size_t p, size_t c, const Vec3d& l) { return hsh.value(p, c, l); };
}

TEST_F(RtiFiles, PolynomialTextureMaps) {
    for (const size_t planes : {9u, 18u}) {
        const PtmBytes ptm = some_ptm(planes);
        const auto file = write("a.ptm", ptm.uncompressed());
        expect_values(read_rti(file), value_of(ptm));
        expect_shown(file, value_of(ptm), 2e-5);
    }
    const PtmBytes older = some_ptm(9);
    expect_values(read_rti(write("older.ptm", older.uncompressed("PTM_1.1"))), value_of(older));
}

/// A plane may be what another one leaves, or that one turned over, and have single values put right.
TEST_F(RtiFiles, PredictedPlanes) {
    const PtmBytes ptm = some_ptm(9);
    PtmBytes stored = ptm;  // rows as in the file, from the bottom
    for (size_t k = 0; k < 9; ++k)
        for (size_t p = 0; p < ptm.pixels(); ++p) stored.planes[k][p] = ptm.planes[k][(4 - p / 7) * 7 + p % 7];
    auto residuals = stored.planes;
    for (size_t p = 0; p < ptm.pixels(); ++p) {
        residuals[2][p] = uint8_t(stored.planes[2][p] - stored.planes[4][p] + 128);
        residuals[7][p] = uint8_t(stored.planes[7][p] - (255 - stored.planes[2][p]) + 128);
    }
    residuals[5][16] = uint8_t(~residuals[5][16]);  // and is put right
    std::string head =
        ptm.head("PTM_1.2", "PTM_FORMAT_JPEG_LRGB") + "90\n0 0 0 0 0 0 0 1 0\n0 0 0 0 0 0 0 0 0\n0 0 0 0 0 0 0 0 0\n";
    head += "3 2 1 4 0 5 6 8 7\n-1 -1 4 -1 -1 -1 -1 2 -1\n";
    std::string planes, sizes;
    for (size_t k = 0; k < 9; ++k) {
        // A picture that loses nothing stands for the JPEG, whose loss is not what is tested.
        const std::string picture = testing::encode_tiff(testing::tiff_entries(7, 5, 1, 8),
                                                         std::string(residuals[k].begin(), residuals[k].end()));
        sizes += fmt::format("{}{}", picture.size(), k < 8 ? " " : "\n");
        planes += picture;
        if (k == 5) planes += std::string("\0\0\0\x10", 4) + char(stored.planes[5][16]);
    }
    const std::string corrections = "0 0 0 0 0 5 0 0 0\n";
    const auto file = write("a.ptm", head + sizes + corrections + planes);
    expect_values(read_rti(file), value_of(ptm));
    expect_shown(file, value_of(ptm), 2e-5);
}

TEST_F(RtiFiles, HemisphericalHarmonics) {
    for (const size_t terms : {4u, 9u, 16u}) {
        const HshBytes hsh = some_hsh(terms);
        const auto file = write("a.rti", hsh.bytes(terms == 9 ? "\r\n" : "\n"));
        expect_values(read_rti(file), value_of(hsh));
        expect_shown(file, value_of(hsh), 5e-5);
    }
}

/// relight's info.json with planes whose bytes are known after JPEG's loss.
struct RelightFolder {
    std::filesystem::path folder;
    int width = 16, height = 8;
    nlohmann::json info;
    std::vector<std::vector<uint8_t>> planes;  ///< as they are read again

    RelightFolder(const std::filesystem::path& to, const char* type, const char* colours, size_t count)
        : folder(to),
          info({{"width", 16},
                {"height", 8},
                {"format", "jpg"},
                {"type", type},
                {"colorspace", colours},
                {"nplanes", count}}) {
        std::filesystem::create_directories(folder);
        Rng rng(count);
        nlohmann::json scale, bias, range;
        for (size_t k = 0; k < count; ++k) {
            scale.push_back(0.3 + 0.01 * double(k));
            bias.push_back(0.02 * double(k));
            range.push_back(150 + 5.0 * double(k));
        }
        info["materials"] = {{{"scale", scale}, {"bias", bias}, {"range", range}}};
        for (size_t k = 0; k < count; k += 3) {
            std::vector<uint8_t> rgb(size_t(3 * width * height));
            for (size_t p = 0; p < rgb.size() / 3; ++p)
                for (size_t c = 0; c < 3; ++c) rgb[3 * p + c] = uint8_t(90 + 60 * rng.uniform());
            const auto file = folder / fmt::format("plane_{}.jpg", k / 3);
            write_file(file, jpeg_bytes(width, height, rgb, 95));
            const ImageFile read = read_image(file);
            for (size_t c = 0; c < 3; ++c) {
                planes.emplace_back();
                for (size_t p = 0; p < rgb.size() / 3; ++p) planes.back().push_back(read.rgb8[3 * p + c]);
            }
        }
    }
    double number(size_t plane, size_t pixel) const {
        const auto& m = info["materials"][0];
        return m["scale"][plane].get<double>() * (planes[plane][pixel] / 255.0 - m["bias"][plane].get<double>());
    }
    std::filesystem::path write() const {
        write_file(folder / "info.json", info.dump());
        return folder;
    }
};

TEST_F(RtiFiles, RelightsSums) {
    const auto polynomial = [](const Vec3d& l) {
        return std::vector<double>{1, l.x(), l.y(), l.x() * l.x(), l.x() * l.y(), l.y() * l.y()};
    };
    {
        const RelightFolder ptm(folder_.path() / "ptm", "ptm", "rgb", 18);
        const Value value = [&](size_t p, size_t c, const Vec3d& l) {
            double sum = 0;
            for (size_t k = 0; k < 6; ++k) sum += polynomial(l)[k] * ptm.number(3 * k + c, p);
            return sum;
        };
        expect_values(read_rti(ptm.write()), value);
        expect_shown(ptm.folder / "info.json", value, 2e-5);
    }
    {
        const RelightFolder lrgb(folder_.path() / "lrgb", "ptm", "lrgb", 9);
        const Value value = [&](size_t p, size_t c, const Vec3d& l) {
            double sum = 0;
            for (size_t k = 0; k < 6; ++k) sum += polynomial(l)[k] * lrgb.number(3 + k, p);
            return sum * lrgb.planes[c][p] / 255.0;  // the colour has no scale
        };
        expect_values(read_rti(lrgb.write()), value);
        expect_shown(lrgb.folder, value, 2e-5);
    }
    {
        const RelightFolder plain(folder_.path() / "plain", "ptm", "rgb", 9);
        const Value value = [&](size_t p, size_t c, const Vec3d& l) {
            return plain.number(c, p) + l.x() * plain.number(3 + c, p) + l.y() * plain.number(6 + c, p);
        };
        expect_values(read_rti(plain.write()), value);
        expect_shown(plain.folder, value, 2e-5);
    }
    const RelightFolder hsh(folder_.path() / "hsh", "hsh", "rgb", 27);
    const Value value = [&](size_t p, size_t c, const Vec3d& l) {
        double sum = 0;
        for (size_t k = 0; k < 9; ++k) sum += HshBytes::functions(l)[k] * hsh.number(3 * k + c, p);
        return sum;
    };
    expect_values(read_rti(hsh.write()), value);
    expect_shown(hsh.folder, value, 2e-5);
}

/// Mean and components under lamps, as bytes: random, but smooth over the lamps.
std::vector<int> smooth_basis(const std::vector<Vec3d>& lamps, size_t planes) {
    Rng rng(8);
    std::vector<int> bytes;
    for (size_t p = 0; p <= planes; ++p) {
        Vec3d slope[3];
        for (Vec3d& s : slope) s = Vec3d(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform());
        for (const Vec3d& l : lamps)
            for (const Vec3d& s : slope)
                bytes.push_back(int(std::lround(p == 0 ? 60 + 100 * s.dot(l) : 127 + 80 * s.dot(l))));
    }
    return bytes;
}

/// Values are light where info.json or the user says so.
TEST_F(RtiFiles, LightItself) {
    RelightFolder relight(folder_.path() / "plain", "ptm", "rgb", 9);
    const Value value = [&](size_t p, size_t c, const Vec3d& l) {
        return relight.number(c, p) + l.x() * relight.number(3 + c, p) + l.y() * relight.number(6 + c, p);
    };
    relight.info["colorprofile"] = "RGB";
    expect_shown(relight.write(), value, 1e-5, ValueCurve::linear);
    expect_shown(relight.folder, value, 1e-5, ValueCurve::srgb, ValueCurve::srgb);
    relight.info["colorprofile"] = "sRGB";
    expect_shown(relight.write(), value, 1e-5, ValueCurve::srgb);
    expect_shown(relight.folder, value, 1e-5, ValueCurve::linear, ValueCurve::linear);
    relight.info["colorprofile"] = "P3";
    EXPECT_THROW(read_rti(relight.write()), UserError);
}

/// What components are of a lamp, c, as relight says: byte / 255 of the mean, (byte - 127) / range of the others.
double component(const RelightFolder& relight, size_t lamps, size_t plane, size_t lamp, size_t c) {
    const double byte = relight.info["basis"][(plane * lamps + lamp) * 3 + c].get<double>();
    return plane == 0 ? byte / 255 : (byte - 127) / relight.info["materials"][0]["range"][plane - 1].get<double>();
}

TEST_F(RtiFiles, RelightsComponentsOnAGrid) {
    constexpr int side = 5;
    RelightFolder relight(folder_.path() / "bilinear", "bilinear", "mrgb", 9);
    std::vector<Vec3d> lamps;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const double s = 2.0 * i / (side - 1) - 1, t = 2.0 * j / (side - 1) - 1;
            Vec3d l((s - t) / 2, (s + t) / 2, 0);
            l.z() = 1 - std::abs(l.x()) - std::abs(l.y());
            lamps.push_back(l.normalized());
        }
    relight.info["resolution"] = side;
    relight.info["basis"] = smooth_basis(lamps, 9);
    const auto folder = relight.write();
    const RtiFile file = read_rti(folder);
    EXPECT_EQ(file.model, nullptr);
    for (size_t l = 0; l < lamps.size(); ++l) {  // at the grid's lamps
        const LampMatrix at = file.functions(lamps[l]);
        for (size_t k = 0; k <= 9; ++k)
            for (size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(at(int(c), int(k)), component(relight, 25, k, l, c), 1e-9) << "lamp " << l;
    }
    Vec3d between(0.25, 0.25, 0.5);  // s = 0.5, t = 0: amid two lamps of the octahedron
    const LampMatrix at = file.functions(between.normalized());
    for (size_t k = 0; k <= 9; ++k) ASSERT_NEAR(at(1, int(k)), (component(relight, 25, k, 13, 1)), 1e-9);
    between = Vec3d(0.125, 0.125, 0.75);  // s = 0.25
    ASSERT_NEAR(file.functions(between.normalized())(2, 4),
                (component(relight, 25, 4, 12, 2) + component(relight, 25, 4, 13, 2)) / 2, 1e-9);
}

TEST_F(RtiFiles, RelightsComponentsUnderLamps) {
    const std::vector<Vec3d> lamps = testing::some_lamps(40, 2);
    RelightFolder relight(folder_.path() / "rbf", "rbf", "mrgb", 6);
    relight.info["sigma"] = 0.2;
    for (const Vec3d& l : lamps)
        for (int c = 0; c < 3; ++c) relight.info["lights"].push_back(l[c]);
    relight.info["basis"] = smooth_basis(lamps, 6);
    const Value value = [&](size_t p, size_t c, const Vec3d& l) {
        double sum = 0, weights = 0;
        for (size_t i = 0; i < lamps.size(); ++i) {
            const double weight = std::exp(-(l - lamps[i]).squaredNorm() / 0.04);
            double shown = component(relight, 40, 0, i, c);
            for (size_t k = 0; k < 6; ++k) shown += component(relight, 40, k + 1, i, c) * relight.number(k, p);
            sum += weight * shown;
            weights += weight;
        }
        return sum / weights;
    };
    expect_values(read_rti(relight.write()), value);

    // as older versions of relight have it
    std::string bytes;
    for (const auto& byte : relight.info["basis"]) bytes.push_back(char(byte.get<int>()));
    relight.info.erase("basis");
    write_file(relight.folder / "materials.bin", bytes);
    const RtiFile older = read_rti(relight.write());
    write_file(relight.folder / "materials.bin", bytes.substr(1));
    EXPECT_THROW(read_rti(relight.folder), UserError);
    EXPECT_EQ(older.numbers, 6u);
}

/// Luminance and chroma: Y of the first planes' turns and of those behind, Co and Cg.
TEST_F(RtiFiles, RelightsLuminanceAndChroma) {
    const std::vector<Vec3d> lamps = testing::some_lamps(12, 2);
    RelightFolder relight(folder_.path() / "mycc", "rbf", "mycc", 6);
    relight.info.erase("nplanes");
    relight.info["yccplanes"] = {4, 1, 1};
    for (const Vec3d& l : lamps)
        for (int c = 0; c < 3; ++c) relight.info["lights"].push_back(l[c]);
    relight.info["basis"] = smooth_basis(lamps, 6);
    const Value value = [&](size_t p, size_t c, const Vec3d& l) {
        double ycc[3] = {}, weights = 0;
        for (size_t i = 0; i < lamps.size(); ++i) {
            const double weight = std::exp(-(l - lamps[i]).squaredNorm() / (0.125 * 0.125));
            weights += weight;
            for (size_t k = 0; k < 3; ++k) ycc[k] += weight * component(relight, 12, 0, i, k);
            for (size_t k = 0; k < 6; ++k) {
                const size_t of = k < 3 ? k : 0;
                ycc[of] += weight * component(relight, 12, k + 1, i, of) * relight.number(k, p);
            }
        }
        const double y = ycc[0] / weights, co = ycc[1] / weights, cg = ycc[2] / weights;
        const double without = y - cg / 2;
        return c == 1 ? cg + without : c == 2 ? without - co / 2 : without - co / 2 + co;
    };
    expect_values(read_rti(relight.write()), value);
}

/// The figure that an import tells is how far renders are from the file, on its curve.
TEST_F(RtiFiles, TellsHowNearALightBasisComes) {
    const std::vector<Vec3d> lamps = testing::some_lamps(60, 2);
    RelightFolder relight(folder_.path() / "rbf", "rbf", "mrgb", 6);
    for (const Vec3d& l : lamps)
        for (int c = 0; c < 3; ++c) relight.info["lights"].push_back(l[c]);
    relight.info["basis"] = smooth_basis(lamps, 6);
    for (const char* profile : {"sRGB", "RGB"}) {
        relight.info["colorprofile"] = profile;
        const RtiFile file = read_rti(relight.write());
        const auto images = folder_.path() / "fit-lamps";
        const RtiImportReport report =
            import_rti({.file = relight.folder, .dataset = {}, .images = images, .provenance_json = {}, .force = true},
                       folder_.path() / "fit");
        EXPECT_EQ(report.model, "lightbasis");
        Fitted fit = open_fit(folder_.path() / "fit");
        const Contestant contestant = contestant_of(fit);
        double squares = 0, count = 0;
        for (const Vec3d& lamp : testing::some_lamps(60, 9)) {
            View view = fit.dataset().views.front();
            view.light->place = lamp;
            const LightImage shown = render(contestant, fit.dataset(), view);
            const LampMatrix at = file.functions(lamp);
            for (size_t i = 0; i < shown.rgb.size(); ++i, ++count) {
                double value = at(int(i % 3), 0);
                for (size_t k = 0; k < 6; ++k) value += at(int(i % 3), int(k) + 1) * double(file.values[i / 3 * 6 + k]);
                squares += std::pow(double(on_curve(file.curve, shown.rgb[i])) - std::max(0.0, value), 2);
            }
        }
        EXPECT_LT(std::sqrt(squares / count), 2 * report.difference) << profile;
        EXPECT_GT(std::sqrt(squares / count), report.difference / 2) << profile;
        EXPECT_LT(report.difference, 0.02) << profile;
    }
}

TEST_F(RtiFiles, DatasetsThatDoNotFit) {
    const PtmBytes ptm = some_ptm(9);
    const RtiFile file = read_rti(write("a.ptm", ptm.uncompressed()));
    Dataset dataset;
    dataset.folder = "set";
    dataset.grid = Grid::centered(7, 5, 1);
    dataset.views.emplace_back();
    dataset.views[0].light.emplace();
    EXPECT_NO_THROW(check_rti_dataset(file, "a.ptm", dataset));
    const auto refused = [&](const std::function<void(Dataset&)>& damage, const std::string& says) {
        Dataset other = dataset;
        damage(other);
        try {
            check_rti_dataset(file, "a.ptm", other);
            ADD_FAILURE() << says;
        } catch (const UserError& e) {
            EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
        }
    };
    refused([](Dataset& d) { d.grid.width = 8; }, "at the same size");
    refused([](Dataset& d) { d.views[0].light->kind = Light::Kind::near; }, "near lamp");
    refused([](Dataset& d) { d.views[0].light->intensity = Vec3d(1, 1, 2); }, "intensity");
    refused([](Dataset& d) { d.views[0].gain = Gain(2); }, "gain");
    refused([](Dataset& d) { d.views[0].light.reset(); }, "light");
    refused([](Dataset& d) { d.grid.texel_normals.assign(35, Vec3f(0.6f, 0, 0.8f)); }, "normals of their own");
    dataset.grid.texel_normals.assign(35, Vec3f::UnitZ());
    dataset.grid.texel_normals[3].setZero();
    EXPECT_NO_THROW(check_rti_dataset(file, "a.ptm", dataset));
}

}  // namespace
}  // namespace radiafit
