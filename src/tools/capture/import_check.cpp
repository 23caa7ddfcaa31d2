#include "capture/import_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "base/error.h"
#include "base/wording.h"

namespace radiafit::tools {
namespace {

[[noreturn]] void fail_black_masks(const std::vector<Photograph>& photographs, const ImportOptions& options) {
    if (std::ranges::all_of(photographs, [](const Photograph& p) { return p.mask.empty(); }))
        throw UserError(fmt::format(
            "{}: the photographs are transparent throughout: export them without alpha, or opaque where the object is",
            options.images.string()));
    const auto largest = std::ranges::max_element(photographs, {}, &Photograph::largest_mask_value);
    throw UserError(fmt::format(
        "{}: the masks are black throughout, the largest value is {} of 255, in {}: white is to "
        "mean object",
        options.masks.empty() ? options.images.string() : options.masks.string(), largest->largest_mask_value,
        largest->mask.empty() ? largest->image.string() : largest->mask.string()));
}

/// The options that move a mesh as `found` says, which was searched with its origin moved to `origin`.
MeshPlacement placed(const MeshPlacement& given, const Vec3d& origin, const Misplacement& found) {
    const MeshPlacement there{Mat3d::Identity(), -origin}, back{Mat3d::Identity(), origin};
    return given.then(there).then(found.move).then(back);
}

std::string cure_of(const MeshPlacement& given, const Vec3d& origin, const Misplacement& found,
                    const ImportOptions& options) {
    const std::string text = describe_placement(placed(given, origin, found));
    if (text.empty()) return "leave the options out that place the mesh";
    return "give " + text + (found.guessed ? " (about: outlines and cameras suggest it)" : "") +
           (options.apply_transform ? ", and leave " + option_name("apply-transform") + " out" : "");
}

/// Whatever the photographs show: no camera that is outside sees the right side of it.
bool is_inside_out(const MeshFile& file, const Calibration& model) {
    if (!file.orientation.closed || file.orientation.signed_volume >= 0) return false;
    Eigen::AlignedBox3d box;
    for (const Vec3f& p : file.mesh.positions) box.extend(p.cast<double>());
    return std::ranges::none_of(model.images,
                                [&](const CalibratedImage& image) { return box.contains(image.camera.center()); });
}

void describe_labels(const std::vector<Photograph>& photographs, ImportReport& report) {
    const bool others = std::ranges::any_of(photographs, [](const Photograph& p) {
        return !p.mask.empty() && !p.mask_of_labels && p.largest_mask_value > 1;
    });
    if (const auto labels = std::ranges::count_if(photographs, &Photograph::mask_of_labels))
        (others ? report.notes : report.remarks)
            .push_back(fmt::format(
                "{} of {} masks hold labels, values of at most {}: whatever is not 0 is the object{}", labels,
                photographs.size(),
                std::ranges::max_element(
                    photographs, {}, [](const Photograph& p) { return p.mask_of_labels ? p.largest_mask_value : 0; })
                    ->largest_mask_value,
                others ? " there, and 128 or more in the others" : ""));
}

}  // namespace

void check_parts(const std::vector<Photograph>& photographs, const MeshFile& file, const MeshPlacement& placement,
                 const std::vector<SmallView>& views, const ImportOptions& options, const Calibration& model,
                 ImportReport& report) {
    const Mesh& mesh = file.mesh;
    const bool masked =
        std::any_of(photographs.begin(), photographs.end(), [](const Photograph& p) { return p.has_mask; });
    const std::string of_what = masked ? "the masks" : "the images";
    Coverage coverage;
    for (const Photograph& p : photographs)
        if (p.has_mask == masked) coverage += p.coverage;
    report.coverage = coverage.share();
    if (masked && coverage.object == 0) fail_black_masks(photographs, options);
    CaptureCheck check = check_capture(mesh, views, model.hints);
    if (!check.misplacement && !options.least_coverage && is_inside_out(file, model))
        throw UserError(fmt::format(
            "{}: a closed surface whose faces turn inward, seen from outside: {} ({} 0 takes it as it is)",
            options.mesh.string(),
            options.flip_faces ? "leave " + option_name("flip-faces") + " out" : "give " + option_name("flip-faces"),
            option_name("least-coverage")));
    const double least = options.least_coverage.value_or(masked ? 0.2 : 0.01);
    if (check.masks_inverted) {
        const bool files = std::ranges::any_of(photographs, [](const Photograph& p) { return !p.mask.empty(); });
        const std::string text =
            files ? fmt::format("{}: the mesh shows where these masks are black, and white is to mean object: give {}",
                                options.masks.empty() ? model.images_file.string() : options.masks.string(),
                                option_name("invert-masks"))
                  : fmt::format(
                        "{}: the mesh shows where these photographs are transparent: their alpha is inverted, "
                        "export them again",
                        options.images.string());
        if (!options.least_coverage || report.coverage < least) throw UserError(text);
        report.notes.push_back(text);
    }
    constexpr double certain = 0.5;  // of Misplacement::gain()
    const bool covers = report.coverage >= least, chosen = options.least_coverage.has_value();
    if (const auto& other = check.misplacement; other || !covers) {
        const bool seen =
            std::any_of(photographs.begin(), photographs.end(), [](const Photograph& p) { return p.sees_mesh; });
        std::string text = options.mesh.string() + ": ";
        text += seen ? fmt::format("the mesh covers {:.3g} % of {}", 100 * report.coverage, of_what)
                     : fmt::format("no camera of {} sees this mesh", options.model.string());
        if (other) {
            if (seen && other->given.colours.pairs)
                text += fmt::format(", with colours that correlate by {:.2f} between neighbours",
                                    other->given.colours.correlation());
            text += fmt::format("; {} it would cover {:.0f} %", other->what, 100 * other->tried.coverage.share());
            if (other->tried.colours.pairs)
                text += fmt::format(", and colours correlate by {:.2f}", other->tried.colours.correlation());
            text += fmt::format(": {}: {}", other->why,
                                other->cure.empty() ? cure_of(placement, file.origin, *other, options) : other->cure);
        } else {
            text += seen && masked ? ": bring it into the model's frame (in the masks, white is to mean object)"
                                   : ": bring it into the model's frame (and turn its faces outward)";
        }
        if (!covers || (other->gain() >= certain && !chosen))
            throw UserError(covers ? fmt::format("{} ({} 0 takes it as it is)", text, option_name("least-coverage"))
                                   : fmt::format("{}, or lower {} ({})", text, option_name("least-coverage"), least));
        report.notes.push_back(text);
    }
    describe_labels(photographs, report);
    uint64_t pixels = 0;
    bool files = false;
    for (const Photograph& p : photographs) {
        if (p.has_mask) pixels += uint64_t(p.camera.width) * uint64_t(p.camera.height);
        files |= !p.mask.empty();
    }
    if (files && coverage.object == pixels)
        report.notes.push_back(
            "the masks are white throughout: they leave nothing out, and what lies beside the mesh counts as object");
    std::string remark = fmt::format("{} photographs: the mesh covers {:.0f} % of {}", photographs.size(),
                                     100 * report.coverage, of_what);
    if (masked && coverage.mesh)
        remark += fmt::format(", {:.0f} % of what shows of it is inside them",
                              100.0 * double(coverage.both) / double(coverage.mesh));
    report.remarks.push_back(fmt::format("{}; {}", remark, check.summary));
    for (std::string& note : check.notes) report.notes.push_back(std::move(note));
    report.unlike.insert(report.unlike.end(), check.named.begin(), check.named.end());
}

}  // namespace radiafit::tools
