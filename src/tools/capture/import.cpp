#include "capture/import.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/resources.h"
#include "base/wording.h"
#include "capture/colmap.h"
#include "capture/file_names.h"
#include "capture/gain_benefit.h"
#include "capture/gains.h"
#include "capture/image_scale.h"
#include "capture/import_check.h"
#include "capture/llff.h"
#include "capture/mesh_file.h"
#include "capture/photographs.h"
#include "capture/small_view.h"
#include "capture/transforms.h"
#include "dataset/checksums.h"
#include "dataset/split.h"
#include "dataset/stream_views.h"
#include "dataset/view_directions.h"
#include "geometry/raster.h"
#include "image/image_file.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// Drops what sees nothing, and says so. Throws when nothing is left to fit.
void drop_blind_views(std::vector<Photograph>& photographs, const ImportOptions& options, ImportReport& report) {
    const size_t all = photographs.size();
    const bool seen =
        std::any_of(photographs.begin(), photographs.end(), [](const Photograph& p) { return p.sees_mesh; });
    if (!seen)
        throw UserError(
            fmt::format("{}: no camera of {} sees this mesh: bring it into the model's frame (and turn its "
                        "faces outward)",
                        options.mesh.string(), options.model.string()));
    for (const Photograph& p : photographs)
        if (!p.seen_in_mask) report.dropped.push_back(p.name);
    std::erase_if(photographs, [](const Photograph& p) { return !p.seen_in_mask; });
    if (photographs.empty())
        throw UserError(fmt::format("{}: the masks leave nothing of the mesh in any image: white is to mean object",
                                    options.masks.empty() ? options.images.string() : options.masks.string()));
    if (!report.dropped.empty())
        report.notes.push_back(fmt::format("dropped {} of {} images, which see nothing of the mesh: {}",
                                           report.dropped.size(), all, fmt::join(report.dropped, ", ")));
    if (std::all_of(photographs.begin(), photographs.end(), [](const Photograph& p) { return p.held_out; }))
        throw UserError(fmt::format("{}: every image that sees the mesh is held out: change {}", options.model.string(),
                                    option_name("holdout")));
}

bool reads_gains(const ImportOptions& options) {
    return options.gains != "auto" && options.gains != "none" && options.gains != "estimate" &&
           options.gains != "per-channel";
}

/// What the comparison with no gains says, and, where it decides, what follows.
std::string describe_benefit(const GainBenefit& benefit, const ImportOptions& options) {
    const std::optional<double>& other = benefit.lowered_by_other;
    const bool decides = options.gains == "auto";
    std::string line;
    if (benefit.needed())
        line = fmt::format("gains are needed{}: they {}", decides ? ", and applied" : "",
                           describe_lowered(benefit.lowered, false));
    else
        line = fmt::format("gains are not needed{}: they {}", decides ? ", and none are applied" : "",
                           describe_lowered(benefit.lowered, decides));
    if (!decides && !benefit.needed())
        line += fmt::format("; {} none does {}", option_name("gains"), benefit.lowered < 0 ? "better" : "as well");
    if (!other) return line;
    const double more = decides ? *other - std::max(benefit.lowered, 0.0) : benefit.lowered - *other;
    if (!decides) line += fmt::format("; one gain for all channels would {}", describe_lowered(*other, false));
    if (decides && more >= GainBenefit::least)
        line += fmt::format("; {} per-channel would lower it by {:.1f} %", option_name("gains"), 100 * *other);
    if (!decides && benefit.needed() && more < GainBenefit::least)
        line += fmt::format(", so that {} estimate does as well", option_name("gains"));
    return line;
}

std::vector<Gain> choose_gains(std::vector<Photograph>& photographs, const std::optional<GainPoints>& points,
                               const ImportOptions& options, ImportReport& report) {
    const std::vector<Gain> none(photographs.size());
    if (!points) return none;
    GainScene scene{.points = *points, .eyes = {}, .samples = {}, .held_out = {}};
    std::vector<double> table;
    for (Photograph& p : photographs) {
        scene.eyes.push_back(p.camera.center());
        scene.samples.push_back(std::move(p.gain_samples));
        scene.held_out.push_back(p.held_out);
        table.push_back(p.given_gain);
    }
    const auto known = [](const auto& estimate) {
        KnownGains out{{}, estimate.guessed};
        for (const auto& gain : estimate.gains) out.gains.emplace_back(gain);
        return out;
    };
    const GainRule one = [&](const auto& samples) { return known(estimate_gains(samples, scene.held_out)); };
    const GainRule channels = [&](const auto& samples) {
        return known(estimate_channel_gains(samples, scene.held_out));
    };
    normalize_gains(table, scene.held_out);
    const GainRule given = [&](const auto&) { return KnownGains{{table.begin(), table.end()}}; };
    const bool decides = options.gains == "auto", by_channel = options.gains == "per-channel";
    const GainRule& rule = reads_gains(options) ? given : by_channel ? channels : one;
    const auto benefit = gain_benefit(scene, rule, by_channel ? &one : decides ? &channels : nullptr);
    if (benefit) report.remarks.push_back(describe_benefit(*benefit, options));
    if (decides && !benefit)
        report.remarks.push_back(
            "no gains are applied: too few photographs show the same of the surface to tell exposures from gloss");
    if (decides && !(benefit && benefit->needed())) return none;
    KnownGains found = rule(scene.samples);
    for (const size_t i : found.guessed) {
        (decides ? report.remarks : report.notes)
            .push_back(fmt::format(
                "image '{}' shares too little with others to estimate its gain: it is left at the mean exposure",
                photographs[i].name));
        report.unlike.push_back(photographs[i].name);
    }
    return std::move(found.gains);
}

/// The crop rectangle in the dataset's encoding.
std::vector<uint8_t> pack_pixels(const ImageFile& image, const std::array<int, 4>& crop, Encoding encoding) {
    const std::vector<float>& light = linear_table(image.bits, image.linear);
    const size_t row = size_t(crop[2]) * 3;
    std::vector<uint8_t> bytes(row * size_t(crop[3]) * size_t(bytes_per_channel(encoding)));
    for (size_t y = 0; y < size_t(crop[3]); ++y) {
        const size_t first = ((y + size_t(crop[1])) * size_t(image.width) + size_t(crop[0])) * 3;
        if (encoding == Encoding::u8_srgb) {
            std::memcpy(bytes.data() + y * row, image.rgb8.data() + first, row);
            continue;
        }
        if (encoding == Encoding::f32_linear) {
            for (size_t i = 0; i < row; ++i) {
                const float value = image.bits == 32  ? image.rgb32[first + i]
                                    : image.bits == 8 ? light[image.rgb8[first + i]]
                                                      : light[image.rgb16[first + i]];
                std::memcpy(bytes.data() + (y * row + i) * 4, &value, 4);
            }
            continue;
        }
        for (size_t i = 0; i < row; ++i) {
            const size_t stored = image.bits == 8 ? image.rgb8[first + i] : image.rgb16[first + i];
            const auto value = static_cast<uint16_t>(std::lround(65535.0 * double(light[stored])));
            std::memcpy(bytes.data() + (y * row + i) * 2, &value, 2);
        }
    }
    return bytes;
}

std::vector<uint8_t> crop_mask(const std::vector<uint8_t>& mask, int width, const std::array<int, 4>& crop) {
    std::vector<uint8_t> out;
    if (mask.empty()) return out;
    for (int y = crop[1]; y < crop[1] + crop[3]; ++y) {
        const auto first = mask.begin() + ptrdiff_t(y) * width + crop[0];
        out.insert(out.end(), first, first + crop[2]);
    }
    return out;
}

/// Reads the images again.
void pack(const std::vector<Photograph>& photographs, const std::vector<Gain>& gains, const Calibration& model,
          Encoding encoding, DatasetWriter& writer) {
    stream_views("packing images", photographs.size(), writer, [&](size_t i, int, PackedImage& packed) {
        const Photograph& photograph = photographs[i];
        const LoadedPhotograph loaded = load_photograph(photograph, model);
        if (loaded.image.bits != photograph.bits)
            throw UserError(
                fmt::format("{}: had {} bits per channel a moment ago and has {} now: leave the images alone "
                            "until they are imported",
                            photograph.image.string(), photograph.bits, loaded.image.bits));
        packed.pixels = pack_pixels(loaded.image, photograph.crop, encoding);
        packed.mask = crop_mask(loaded.mask, loaded.image.width, photograph.crop);
        View view;
        view.name = photograph.name;
        view.camera =
            photograph.camera.cropped(photograph.crop[0], photograph.crop[1], photograph.crop[2], photograph.crop[3]);
        view.held_out = photograph.held_out;
        view.gain = gains[i];
        view.crop_origin = {photograph.crop[0], photograph.crop[1]};
        view.full_size = {photograph.camera.width, photograph.camera.height};
        return view;
    });
}

/// What all photographs can be stored in without loss.
Encoding choose_encoding(const std::vector<Photograph>& photographs) {
    const auto any = [&](const auto& is) { return std::any_of(photographs.begin(), photographs.end(), is); };
    if (any([](const Photograph& p) { return p.bits == 32; })) return Encoding::f32_linear;
    return any([](const Photograph& p) { return p.bits == 16 || p.linear; }) ? Encoding::u16_linear : Encoding::u8_srgb;
}

/// How the photographs' files were taken.
void tell_pictures(const std::vector<Photograph>& photographs, ImportReport& report) {
    std::vector<PictureFacts> facts;
    for (const Photograph& p : photographs) facts.push_back(p.facts);
    PictureWords words = describe_pictures(
        facts, fmt::format("if their cameras were calibrated upright, give {} apply", option_name("exif-orientation")));
    for (std::string& note : words.notes) report.notes.push_back(std::move(note));
    for (std::string& remark : words.remarks) report.remarks.push_back(std::move(remark));
}

/// What the images need as they are cropped, in memory by several threads at a time.
Needs needs_of(const std::vector<Photograph>& photographs, const Mesh& mesh, Encoding encoding) {
    const uint64_t mesh_bytes = 12 * mesh.vertex_count() + 13 * mesh.triangle_count();
    Needs needs{.memory = 2 * mesh_bytes, .disk = mesh_bytes};
    uint64_t largest = 0;
    for (const Photograph& p : photographs) {
        View view;
        view.camera = p.camera.cropped(p.crop[0], p.crop[1], p.crop[2], p.crop[3]);
        view.mask_offset = 0;
        needs.disk += image_block_bytes(view, encoding) + 1000;
        for (const Camera& camera : {p.taken, p.calibrated})
            largest = std::max(largest, uint64_t(camera.width) * uint64_t(camera.height));
    }
    // As read, with 16 bits or floats, as spread to RGB, scaled, and packed.
    const uint64_t pixel_bytes = encoding == Encoding::f32_linear ? 60 : 30;
    needs.memory += 4 * uint64_t(thread_count()) * largest * pixel_bytes;
    return needs;
}

std::string provenance(const char* format, const ImportOptions& options) {
    std::string text = fmt::format("radiafit import {} --model {} --images {} --mesh {}", format,
                                   options.model.string(), options.images.string(), options.mesh.string());
    const MeshPlacement placement =
        parse_placement(options.mesh_turn, options.mesh_scale, options.mesh_shift, options.flip_faces);
    if (const std::string placed = describe_placement(placement); !placed.empty()) text += " " + placed;
    if (options.apply_transform) text += " --apply-transform";
    if (!options.masks.empty()) text += fmt::format(" --masks {}", options.masks.string());
    if (!options.holdout.empty()) text += fmt::format(" --holdout {}", options.holdout);
    text += fmt::format(" --gains {}", options.gains);
    if (options.least_coverage) text += fmt::format(" --least-coverage {}", *options.least_coverage);
    if (options.max_size) text += fmt::format(" --max-size {}", options.max_size);
    if (options.skip_missing) text += " --skip-missing";
    if (options.invert_masks) text += " --invert-masks";
    if (options.exif_orientation != "auto") text += fmt::format(" --exif-orientation {}", options.exif_orientation);
    return text;
}

void check_options(const ImportOptions& options) {
    parse_placement(options.mesh_turn, options.mesh_scale, options.mesh_shift, options.flip_faces);
    if (options.max_size < 0)
        throw UserError(
            fmt::format("{} {}: give a number of pixels from 1 on", option_name("max-size"), options.max_size));
    if (options.exif_orientation != "auto" && options.exif_orientation != "stored" &&
        options.exif_orientation != "apply")
        throw UserError(fmt::format("{} {}: choose auto, stored or apply", option_name("exif-orientation"),
                                    options.exif_orientation));
    if (options.least_coverage && !(*options.least_coverage >= 0 && *options.least_coverage <= 1))
        throw UserError(
            fmt::format("{} {}: give a share from 0 to 1", option_name("least-coverage"), *options.least_coverage));
}

/// "." of a bare name.
fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

std::vector<uint8_t> held_out_by_calibration(const Calibration& model) {
    std::vector<uint8_t> held_out;
    for (const CalibratedImage& image : model.images) held_out.push_back(image.held_out);
    if (std::find(held_out.begin(), held_out.end(), 0) == held_out.end())
        throw UserError(fmt::format("{}: all its images are held out and none is left to fit: give {}",
                                    model.images_file.string(), option_name("holdout")));
    return held_out;
}

/// In double: what is left is as precise as the calibration.
void move_origin(Calibration& model, const Vec3d& origin) {
    for (CalibratedImage& image : model.images)
        image.camera.cam_from_world_translation += image.camera.cam_from_world_rotation * origin;
    if (model.hints.known_transform)
        model.hints.known_transform->shift += model.hints.known_transform->linear * origin - origin;
}

/// format: of the calibration, as the command line has it.
ImportReport import_calibrated(const char* format, ImportOptions options, Calibration model, const fs::path& out) {
    ImportReport report;
    locate_photographs(model, options.images, options.skip_missing, report.notes);
    const bool own_split = std::any_of(model.images.begin(), model.images.end(),
                                       [](const CalibratedImage& image) { return image.held_out; });
    if (options.holdout.empty() && !own_split) options.holdout = "every:8";
    std::vector<std::string> names;
    for (const CalibratedImage& image : model.images) names.push_back(image.name);
    MeshPlacement placement =
        parse_placement(options.mesh_turn, options.mesh_scale, options.mesh_shift, options.flip_faces);
    if (options.apply_transform) {
        if (!model.hints.known_transform)
            throw UserError(fmt::format("{}: has no applied_transform: leave {} out", model.cameras_file.string(),
                                        option_name("apply-transform")));
        placement = placement.then({model.hints.known_transform->linear, model.hints.known_transform->shift, false});
        model.hints.known_transform.reset();
    } else if (model.hints.known_transform) {
        model.remarks.push_back(
            fmt::format("{}: its frame is another's by applied_transform: a mesh in that one, such as "
                        "COLMAP's own, takes {}",
                        model.cameras_file.string(), option_name("apply-transform")));
    }
    MeshFile mesh = read_mesh_file(options.mesh, placement, Origin::moved);
    if (!mesh.origin.isZero(0)) move_origin(model, mesh.origin);
    const Vec3d centre = surface_centre(mesh.mesh, {});
    std::vector<Vec3d> directions;
    for (const CalibratedImage& image : model.images)
        directions.push_back((image.camera.center() - centre).normalized());
    const std::vector<uint8_t> held_out =
        options.holdout.empty() ? held_out_by_calibration(model) : choose_held_out(names, directions, options.holdout);
    std::vector<double> gain_table;
    if (reads_gains(options)) gain_table = read_gains(options.gains, names);
    for (std::string& note : mesh.notes) report.notes.push_back(std::move(note));
    report.remarks = model.remarks;
    for (std::string& remark : mesh.remarks) report.remarks.push_back(std::move(remark));
    std::vector<Photograph> photographs = list_photographs(options, model, held_out, report);
    for (size_t i = 0; i < gain_table.size(); ++i) photographs[i].given_gain = gain_table[i];
    if (options.invert_masks && std::ranges::none_of(photographs, [](const Photograph& p) { return !p.mask.empty(); }))
        throw UserError(fmt::format("{}: no photograph has a file of its mask: give {}, or leave it out",
                                    option_name("invert-masks"), option_name("masks")));
    report.images = photographs.size();
    DatasetWriter writer(out);  // before the long part: an output that cannot be written shows now

    report.vertices = mesh.mesh.vertex_count();
    report.triangles = mesh.mesh.triangle_count();
    std::optional<GainPoints> points;
    if (options.gains != "none") points.emplace(mesh.mesh);
    {
        std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
        Progress progress("reading images", photographs.size());
        std::vector<SmallView> views(std::min(photographs.size(), most_checked_views));
        parallel_for(photographs.size(), 1, [&](size_t i, int worker) {
            const LoadedPhotograph loaded = load_photograph(photographs[i], model);
            survey(photographs[i], loaded, mesh.mesh, points ? &*points : nullptr, rasters[size_t(worker)]);
            // Those are kept small that are spread over the list.
            const size_t kept = (i * views.size() + photographs.size() - 1) / photographs.size();
            if (kept < views.size() && kept * photographs.size() / views.size() == i)
                views[kept] = small_view(photographs[i], loaded);
            progress.advance();
        });
        progress.finish();
        tell_pictures(photographs, report);
        check_parts(photographs, mesh, placement, views, options, model, report);
    }
    drop_blind_views(photographs, options, report);
    const std::vector<Gain> gains = choose_gains(photographs, points, options, report);

    const Encoding encoding = choose_encoding(photographs);
    announce_needs("import", needs_of(photographs, mesh.mesh, encoding), out, options.force);
    writer.set_encoding(encoding);
    pack(photographs, gains, model, encoding, writer);

    Dataset header;
    header.name = dataset_name(options.name, out);
    header.description = fmt::format("{} photographs, cameras from {}", photographs.size(), model.origin);
    if (!report.undistortion.empty()) header.description += ", " + report.undistortion;
    header.source = provenance(format, options);
    if (!mesh.origin.isZero(0))
        header.description += fmt::format("; origin moved to ({:.10g}, {:.10g}, {:.10g}) of their frame",
                                          mesh.origin.x(), mesh.origin.y(), mesh.origin.z());
    header.encoding = encoding;
    header.mesh = std::move(mesh.mesh);
    writer.finish(header);
    std::vector<View> views(photographs.size());
    for (size_t i = 0; i < views.size(); ++i) {
        views[i].camera = photographs[i].calibrated;
        views[i].held_out = photographs[i].held_out;
    }
    const std::string outside = outside_note(views, angles_outside(centre, views));
    if (!outside.empty()) report.notes.push_back(outside);
    for (const Photograph& p : photographs) ++(p.held_out ? report.held_out : report.training);
    return report;
}

}  // namespace

ImportReport import_colmap(const ImportOptions& options, const fs::path& out) {
    check_options(options);
    return import_calibrated("colmap", options, read_colmap(options.model, Lenses::taken), out);
}

ImportReport import_transforms(const ImportOptions& given, const fs::path& out) {
    check_options(given);
    ImportOptions options = given;
    TransformsFiles files = find_transforms(options.model);
    if (options.images.empty()) options.images = folder_of(files.main);
    const bool test_aside = !options.holdout.empty() && !files.test.empty();
    const std::string aside = files.test.string();
    if (test_aside) files.test.clear();
    Calibration model = read_transforms(files, options.images);
    const fs::path validation = folder_of(files.main) / "transforms_val.json";
    if (files.main.filename() != validation.filename() && path_exists(validation))
        model.remarks.push_back(fmt::format("{} is not read: give it as {} to import its photographs",
                                            validation.string(), option_name("model")));
    if (test_aside)
        model.remarks.push_back(fmt::format("{} is not read: {} says what is held out", aside, option_name("holdout")));
    return import_calibrated("transforms", options, std::move(model), out);
}

ImportReport import_llff(const ImportOptions& given, const fs::path& out) {
    check_options(given);
    ImportOptions options = given;
    const fs::path file = folder_exists(options.model) ? options.model / "poses_bounds.npy" : options.model;
    if (options.images.empty()) options.images = folder_of(file) / "images";
    return import_calibrated("llff", options, read_llff(file, options.images), out);
}

}  // namespace radiafit::tools
