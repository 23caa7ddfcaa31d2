#include "capture/import_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/resources.h"
#include "base/wording.h"
#include "capture/file_names.h"
#include "capture/image_scale.h"
#include "capture/image_set.h"
#include "capture/lamp_calibration.h"
#include "capture/lamp_picture.h"
#include "capture/lamp_table.h"
#include "capture/light_file.h"
#include "capture/light_list.h"
#include "capture/normal_file.h"
#include "capture/picture_facts.h"
#include "dataset/checksums.h"
#include "dataset/dataset_json.h"
#include "dataset/split.h"
#include "dataset/stream_views.h"
#include "dataset/view_directions.h"
#include "image/image_file.h"
#include "model/photometric_stereo.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// One image on its way into the dataset.
struct Source {
    fs::path file;
    View view;
};

void check_scale(const LightImportOptions& o) {
    if (!(o.sample_width >= 0 && std::isfinite(o.sample_width)))
        throw UserError(fmt::format("{} {}: give what an image's width covers, above 0", option_name("sample-width"),
                                    o.sample_width));
    if (!(o.sphere_radius >= 0 && std::isfinite(o.sphere_radius)))
        throw UserError(
            fmt::format("{} {}: give the spheres' radius, above 0", option_name("sphere-radius"), o.sphere_radius));
    const bool near = !o.light_positions.empty() || !o.camera_positions.empty();
    const bool scaled = o.sample_width > 0 || o.sphere_radius > 0;
    if (o.sphere_radius > 0 && (o.spheres.empty() || o.sample_width > 0))
        throw UserError(fmt::format("{} says how large things are by the spheres ({}): {}",
                                    option_name("sphere-radius"), option_name("spheres"),
                                    o.spheres.empty() ? "leave it out, or have lamps found by them"
                                                      : "leave it or " + option_name("sample-width") + " out"));
    if (near && !scaled)
        throw UserError(
            fmt::format("places of lights or cameras mean nothing without the sample's size: give {}, what an image's "
                        "width covers in the same unit",
                        option_name("sample-width")));
    if (!near && o.spheres.empty() && o.sample_width > 0)
        throw UserError(
            fmt::format("{} says nothing about directions: give places, or leave it out", option_name("sample-width")));
}

void check_options(const LightImportOptions& o) {
    const bool ways[] = {!o.lights.empty(), !o.light_positions.empty(), !o.spheres.empty()};
    if (std::ranges::count(ways, true) != 1)
        throw UserError(
            fmt::format("give the lights either as directions ({}) or as places ({}), or have them found by "
                        "glossy spheres in the images ({})",
                        option_name("lights"), option_name("light-positions"), option_name("spheres")));
    check_spheres(o.spheres);
    if (!(o.refine_lamps >= 0 && o.refine_lamps <= 90))
        throw UserError(fmt::format("{} {}: give degrees from 0 to 90", option_name("refine-lamps"), o.refine_lamps));
    if (!o.light_axes.empty() && !o.spheres.empty())
        throw UserError(fmt::format("{} means nothing with {}, which read no light file: leave it out",
                                    option_name("light-axes"), option_name("spheres")));
    if (o.refine_lamps > 0 && !o.spheres.empty())
        throw UserError(
            fmt::format("{} means nothing with {}, whose lamps are refined by how sure they are: leave it "
                        "out",
                        option_name("refine-lamps"), option_name("spheres")));
    check_scale(o);
    if (o.transfer != "auto" && o.transfer != "linear" && o.transfer != "srgb")
        throw UserError(fmt::format("{} {}: choose auto, linear or srgb", option_name("transfer"), o.transfer));
    if (o.max_size < 0)
        throw UserError(fmt::format("{} {}: give a number of pixels from 1 on", option_name("max-size"), o.max_size));
    if (o.depth != 0 && o.depth != 8 && o.depth != 16 && o.depth != 32)
        throw UserError(fmt::format("{} {}: choose 8, 16 or 32 (floats)", option_name("depth"), o.depth));
    if (!folder_exists(o.images))
        throw UserError(
            fmt::format("{}: no such folder of images: check {}", o.images.string(), option_name("images")));
}

/// Lamps by spheres, or refined; none if they are taken as they are given.
std::optional<LampCalibration> calibrate(const LightImportOptions& o, const NamedImages& images,
                                         const std::vector<Vec3d>& intensities, const ImageSetFormat& format,
                                         const std::vector<uint8_t>& mask, LightImportReport& report) {
    if (o.spheres.empty() && o.refine_lamps == 0) return {};
    LitImages lit{.folder = o.images,
                  .files = images.files,
                  .format = format,
                  .mask = mask,
                  .width = o.sample_width > 0 ? o.sample_width : format.width,
                  .eye = {},
                  .intensities = intensities};
    if (!o.spheres.empty() && !o.camera_positions.empty()) {
        const std::vector<Vec3d> eyes = read_vectors(o.camera_positions, "camera position");
        if (eyes.size() != 1)
            throw UserError(
                fmt::format("{}: {} camera positions, but spheres ({}) are seen by a camera that stands "
                            "still: write one line",
                            o.camera_positions.string(), eyes.size(), option_name("spheres")));
        Grid::centered(format.width, format.height, 1).camera_at(eyes[0], o.camera_positions.string());
        lit.eye = eyes[0];
    }
    LampCalibration out = o.spheres.empty()
                              ? refine_on_surface(lit, given_lights(o, images, intensities), o.refine_lamps)
                              : calibrate_by_spheres(lit, {o.spheres, o.sphere_radius});
    report.notes.insert(report.notes.end(), out.notes.begin(), out.notes.end());
    report.remarks.insert(report.remarks.end(), out.remarks.begin(), out.remarks.end());
    return out;
}

std::vector<Source> make_sources(const LightImportOptions& o, const NamedImages& images,
                                 const std::vector<Light>& lights) {
    std::vector<Vec3d> directions;  // from the surface's centre, where the world has its origin
    for (const Light& light : lights) directions.push_back(light.place.normalized());
    const std::vector<uint8_t> held_out = choose_held_out(images.names, directions, o.holdout);
    std::vector<Source> sources(images.files.size());
    for (size_t i = 0; i < sources.size(); ++i) {
        sources[i].file = images.files[i];
        View& view = sources[i].view;
        view.name = images.files[i].filename().string();
        view.held_out = held_out[i] != 0;
        view.light = lights[i];
    }
    return sources;
}

/// Those of the images whose lamps are known, and these lamps.
std::vector<Source> calibrated_sources(const LightImportOptions& o, const NamedImages& images,
                                       const LampCalibration& calibration) {
    NamedImages kept;
    std::vector<Light> lights;
    for (size_t k = 0; k < calibration.images.size(); ++k) {
        kept.names.push_back(images.names[calibration.images[k]]);
        kept.files.push_back(images.files[calibration.images[k]]);
        lights.push_back(calibration.lamps[k].light);
    }
    return make_sources(o, kept, lights);
}

/// What people may want to see of a calibration, beside the images.
void write_calibration(const LampCalibration& calibration, const std::vector<Source>& sources, const fs::path& folder) {
    std::vector<std::string> names;
    for (const Source& s : sources) names.push_back(s.view.name);
    write_file(folder / dataset_lamps_name, lamp_table(calibration, names));
    if (!calibration.spheres.empty()) write_file(folder / dataset_lamp_picture_name, lamp_picture(calibration));
}

void pack(const std::vector<Source>& sources, const std::vector<uint8_t>& mask, const ImageSetFormat& format,
          DatasetWriter& writer, LightImportReport& report) {
    std::vector<PictureFacts> facts(sources.size());
    stream_views("packing images", sources.size(), writer, [&](size_t i, int, PackedImage& packed) {
        packed = read_packed(sources[i].file, format, mask, &facts[i]);
        return sources[i].view;
    });
    PictureWords words = describe_pictures(facts, "turn those files that do not lie on the others");
    for (std::string& note : words.notes) report.notes.push_back(std::move(note));
    report.remarks.insert(report.remarks.begin(), words.remarks.begin(), words.remarks.end());
}

/// Each view's camera, near or far away along +z.
void place_cameras(const LightImportOptions& o, const Grid& grid, std::vector<Source>& sources,
                   LightImportReport& report) {
    std::vector<Vec3d> places;
    if (!o.camera_positions.empty()) {
        places = read_vectors(o.camera_positions, "camera position");
        expect_entries(o.camera_positions, "camera positions", places.size(), sources.size(), report);
    }
    for (size_t i = 0; i < sources.size(); ++i) {
        View& view = sources[i].view;
        if (places.empty()) {
            view.camera.width = grid.width;
            view.camera.height = grid.height;
            view.camera_direction = Vec3d::UnitZ();
        } else {
            view.camera = grid.camera_at(entry_for(places, i), o.camera_positions.string());
            check_camera(view.camera, o.camera_positions.string());
        }
    }
}

/// [file_height][file_width]; empty: all.
std::vector<uint8_t> read_common_mask(const LightImportOptions& o, const ImageSetFormat& format) {
    if (o.mask.empty()) return {};
    MaskFile mask = read_mask(o.mask, [&](int width, int height) {
        if (width != format.file_width || height != format.file_height)
            throw UserError(fmt::format("{}: {} x {} pixels, but the images have {} x {}: give the mask at their size",
                                        o.mask.string(), width, height, format.file_width, format.file_height));
    });
    const auto is_black = [](const std::vector<uint8_t>& values) {
        return std::all_of(values.begin(), values.end(), [](uint8_t v) { return v == 0; });
    };
    if (is_black(mask.values))
        throw UserError(fmt::format("{}: the mask is black throughout: white is to mean object", o.mask.string()));
    if (is_black(scaled_mask(mask.values, format)))
        throw UserError(fmt::format("{}: nothing is left of the mask at {} x {} pixels: raise {}", o.mask.string(),
                                    format.width, format.height, option_name("max-size")));
    return std::move(mask.values);
}

bool is_flat(const LightImportOptions& o) { return o.normals == "flat"; }

/// Means of what each texel covers, of length 1 again; 0 where there is none.
std::vector<Vec3f> scale_normals(const NormalFile& file, const ImageSetFormat& format) {
    ImageFile image{file.width, file.height, 32, true, {}, {}, {}, {}};
    image.rgb32.resize(3 * file.normals.size());
    std::memcpy(image.rgb32.data(), file.normals.data(), file.normals.size() * sizeof(Vec3f));
    const ImageFile scaled = scale_down(image, format.width, format.height);
    std::vector<Vec3f> normals(scaled.rgb32.size() / 3);
    for (size_t i = 0; i < normals.size(); ++i) {
        const Vec3f mean(scaled.rgb32[3 * i], scaled.rgb32[3 * i + 1], scaled.rgb32[3 * i + 2]);
        normals[i] = mean.norm() > 1e-3f ? mean.normalized() : Vec3f(Vec3f::Zero());
    }
    return normals;
}

std::vector<Vec3f> read_normals(const LightImportOptions& o, const ImageSetFormat& format) {
    const auto check_size = [&](int width, int height) {
        if (width != format.file_width || height != format.file_height)
            throw UserError(fmt::format(
                "{}: normals for {} x {} pixels, but the images have {} x {}: give the normals at their size",
                o.normals.string(), width, height, format.file_width, format.file_height));
    };
    NormalFile file = read_normal_file(o.normals, check_size);
    return format.is_scaled() ? scale_normals(file, format) : std::move(file.normals);
}

bool has_near_light(const std::vector<Source>& sources) {
    return std::ranges::any_of(sources, [](const Source& s) { return s.view.light->kind == Light::Kind::near; });
}

/// The images that normals are found from: fitted ones, never those held out, under distant lamps.
std::vector<size_t> images_for_normals(const LightImportOptions& o, const std::vector<Source>& sources,
                                       LightImportReport& report) {
    if (!o.normals.empty() || has_near_light(sources)) return {};
    std::vector<size_t> chosen;
    std::vector<Vec3d> directions;
    for (size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].view.held_out) continue;
        chosen.push_back(i);
        directions.push_back(sources[i].view.light->place);
    }
    if (lamps_give_normals(directions)) return chosen;
    report.remarks.push_back(fmt::format(
        "no normals, and the lamps of {} training images (fewer than three, or all in one plane) tell none: "
        "the surface is taken to be flat; give {}",
        chosen.size(), option_name("normals")));
    return {};
}

/// Linear light over the lamp's intensity, mean of the channels; not a number where it is left out or clipped.
std::vector<float> grey_values(const PackedImage& image, const ImageSetFormat& format, const Vec3d& intensity) {
    const StoredLight light(format);
    std::vector<float> grey(size_t(format.width) * size_t(format.height), std::numeric_limits<float>::quiet_NaN());
    for (size_t p = 0; p < grey.size(); ++p) {
        if (!image.mask.empty() && !image.mask[p]) continue;
        double sum = 0;
        float largest = 0;
        int lit = 0;
        for (size_t c = 0; c < 3; ++c) {
            const float value = light.at(image.pixels, 3 * p + c);
            largest = std::max(largest, value);
            if (intensity[ptrdiff_t(c)] <= 0) continue;
            sum += double(value) / intensity[ptrdiff_t(c)];
            ++lit;
        }
        if (lit && largest < light.clipped()) grey[p] = static_cast<float>(sum / lit);
    }
    return grey;
}

/// Normals by photometric stereo from these images; towards the camera where it finds none. mask: of the files' size.
std::vector<Vec3f> compute_normals(const std::vector<Source>& sources, const std::vector<size_t>& chosen,
                                   const std::vector<uint8_t>& mask, const ImageSetFormat& format,
                                   LightImportReport& report) {
    const std::vector<uint8_t> object_mask = scaled_mask(mask, format);
    const size_t count = chosen.size(), pixels = size_t(format.width) * size_t(format.height);
    std::vector<Vec3d> directions(count);
    std::vector<float> values(count * pixels);  // [pixel][image]
    Progress progress("normals from the lights", count);
    parallel_for(count, 1, [&](size_t k, int) {
        const Source& source = sources[chosen[k]];
        directions[k] = source.view.light->place;
        const auto grey = grey_values(read_packed(source.file, format, mask), format, source.view.light->intensity);
        for (size_t p = 0; p < pixels; ++p) values[p * count + k] = grey[p];
        progress.advance();
    });
    std::vector<Vec3f> normals(pixels);
    parallel_for(pixels, 256, [&](size_t p, int) {
        normals[p] = photometric_normal(directions, std::span(values).subspan(p * count, count));
    });
    size_t none = 0, object = 0;
    for (size_t p = 0; p < pixels; ++p) {
        if (!object_mask.empty() && !object_mask[p]) continue;
        ++object;
        if (normals[p] != Vec3f::Zero()) continue;
        normals[p] = Vec3f::UnitZ();
        ++none;
    }
    report.computed_normals = true;
    std::string remark = fmt::format("no normals given: computed from {} training images by photometric stereo", count);
    if (none)
        remark += fmt::format("; {:.1f} % of the pixels, too dark or clipped, are taken to face the camera",
                              100.0 * double(none) / double(object));
    report.remarks.push_back(remark + fmt::format("; {} FILE gives better ones, {} flat the plane's",
                                                  option_name("normals"), option_name("normals")));
    return normals;
}

/// The grid's normals: from the file, from the lights, or the plane's; 0 outside the mask. Empty if they are the
/// plane's and there is no mask. file_mask: [file_height][file_width], or empty.
std::vector<Vec3f> choose_normals(const LightImportOptions& o, const std::vector<Source>& sources,
                                  const std::vector<size_t>& for_normals, const ImageSetFormat& format,
                                  const std::vector<uint8_t>& file_mask, LightImportReport& report) {
    const std::vector<uint8_t> mask = scaled_mask(file_mask, format);
    std::vector<Vec3f> normals;
    if (!o.normals.empty() && !is_flat(o))
        normals = read_normals(o, format);
    else if (!for_normals.empty())
        normals = compute_normals(sources, for_normals, file_mask, format, report);
    else if (!mask.empty())
        normals.assign(mask.size(), Vec3f::UnitZ());
    size_t missing = 0, away = 0, usable = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        if (!mask.empty() && !mask[i]) {
            normals[i].setZero();
            continue;
        }
        const bool none = normals[i] == Vec3f::Zero();
        missing += none;
        usable += !none;
        away += normals[i].z() < 0;
    }
    if (!normals.empty() && usable == 0)
        throw UserError(fmt::format("{}: no pixel has a normal: give x, y, z in red, green, blue, of length 1",
                                    o.normals.string()));
    if (missing) report.notes.push_back(fmt::format("{} pixels have no normal and are left out", missing));
    if (2 * away > usable)
        report.notes.push_back(
            fmt::format("{} of {} normals face away from the camera: they are to have z towards it", away, usable));
    return normals;
}

/// for_normals: images that normals are found from; calibrated: whether lamps are.
Needs needs_of(size_t images, size_t for_normals, bool calibrated, const ImageSetFormat& format) {
    View view;
    view.camera.width = format.width;
    view.camera.height = format.height;
    view.mask_offset = 0;
    const uint64_t pixels = uint64_t(format.width) * uint64_t(format.height);
    const uint64_t file_pixels = uint64_t(format.file_width) * uint64_t(format.file_height);
    const uint64_t normals = pixels * sizeof(Vec3f);
    constexpr uint64_t pixel_bytes = 40;        // as read, floats perhaps, as spread to RGB, and packed
    constexpr uint64_t calibration_bytes = 24;  // sums over the images
    // 16 matrices of a number for each pair of images (lamps/lamp_order), of 16 for each pair of lamps
    // (lamps/refine_lamps)
    const uint64_t pairs = images * images * 16 * sizeof(double) * (calibrated ? 16 : 1);
    return {.memory = 4 * uint64_t(thread_count()) * file_pixels * pixel_bytes + 2 * normals +
                      for_normals * pixels * sizeof(float) + (calibrated ? file_pixels * calibration_bytes : 0) + pairs,
            .disk = images * (image_block_bytes(view, format.encoding) + 1000) + normals};
}

std::string provenance(const LightImportOptions& o) {
    std::string text = "radiafit import lights";
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) text += fmt::format(" {} {}", option, value);
    };
    add("--images", o.images.string());
    add("--lights", o.lights.string());
    add("--light-positions", o.light_positions.string());
    add("--spheres", o.spheres);
    if (o.sphere_radius > 0) add("--sphere-radius", fmt::format("{}", o.sphere_radius));
    if (o.refine_lamps > 0) add("--refine-lamps", fmt::format("{}", o.refine_lamps));
    add("--names", o.names.string());
    add("--light-axes", o.light_axes);
    if (o.by_order) text += " --by-order";
    add("--intensities", o.intensities.string());
    add("--camera-positions", o.camera_positions.string());
    if (o.sample_width > 0) add("--sample-width", fmt::format("{}", o.sample_width));
    add("--mask", o.mask.string());
    add("--normals", o.normals.string());
    if (o.max_size) add("--max-size", fmt::format("{}", o.max_size));
    add("--transfer", o.transfer);
    if (o.depth) add("--depth", fmt::format("{}", o.depth));
    add("--holdout", o.holdout);
    return text;
}

}  // namespace

LightImportReport import_lights(const LightImportOptions& options, const fs::path& out) {
    check_options(options);
    LightImportReport report;
    const NamedImages images = list_named(options, report);
    const std::vector<Vec3d> intensities = given_intensities(options, images.files.size(), report);
    const ImageSetFormat format = learn_format(images.files[0], options.transfer, options.depth, options.max_size);
    std::vector<uint8_t> mask = read_common_mask(options, format);
    DatasetWriter writer(out);
    const bool calibrated = !options.spheres.empty() || options.refine_lamps > 0;
    const bool finds_normals = options.normals.empty() && options.light_positions.empty();
    announce_needs("import", needs_of(images.files.size(), finds_normals ? images.files.size() : 0, calibrated, format),
                   out, options.force);

    const std::optional<LampCalibration> calibration = calibrate(options, images, intensities, format, mask, report);
    std::vector<Source> sources = calibration
                                      ? calibrated_sources(options, images, *calibration)
                                      : make_sources(options, images, given_lights(options, images, intensities));
    double width = options.sample_width > 0 ? options.sample_width : format.width;  // world units
    if (calibration) {
        width = calibration->width;
        mask = without_spheres(std::move(mask), calibration->spheres, format.file_width, format.file_height);
        write_calibration(*calibration, sources, writer.temporary_folder());
    }
    Dataset header;
    header.grid = Grid::centered(format.width, format.height, width / format.width);
    place_cameras(options, header.grid, sources, report);
    const std::vector<size_t> for_normals = images_for_normals(options, sources, report);
    header.grid.texel_normals = choose_normals(options, sources, for_normals, format, mask, report);
    writer.set_encoding(format.encoding);
    pack(sources, mask, format, writer, report);
    header.name = dataset_name(options.name, out);
    header.description = fmt::format("{} images of one real surface, pixel on pixel, under one {} lamp each; camera{}",
                                     sources.size(), has_near_light(sources) ? "near" : "distant",
                                     options.camera_positions.empty() ? " fixed and distant" : "s near");
    header.source = provenance(options);
    writer.finish(header);
    std::vector<View> views;
    for (const Source& s : sources) views.push_back(s.view);
    const std::string outside = outside_note(views, angles_outside(surface_centre({}, header.grid), views));
    if (!outside.empty()) report.notes.push_back(outside);
    for (const Source& s : sources) ++(s.view.held_out ? report.held_out : report.training);
    return report;
}

}  // namespace radiafit::tools
