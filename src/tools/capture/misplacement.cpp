#include "capture/misplacement.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/wording.h"

namespace radiafit::tools {
namespace {

// By how much MeshAgreement::value() is to be better in another frame: by a quarter, or by less where half of what
// lacks to 2 is gained.
constexpr double least_gain = 0.25, least_gain_if_halved = 0.08;
constexpr double least_guessed_gain = 0.04;
constexpr double nearly_as_good = 0.06;  // within this of the best, the plainer frame is reported
constexpr size_t point_count = 4000;     // at which colours are compared; for guesses a part of them is enough
constexpr size_t guessed_points = 1200;
constexpr size_t neighbours = 2;  // of each view

struct Try {
    Mat3d linear = Mat3d::Identity();
    Vec3d shift = Vec3d::Zero();
    bool turned_over = false;
    std::function<Camera(const Camera&)> other_pose = {};  ///< none: as given
    bool turned = false;                                   ///< its axes
    bool guessed = false;
    bool plain = true;  ///< of a kind that outlines alone may suggest
    std::string what, why, cure;
};

/// Of a camera whose centre is written where its translation belongs.
Camera with_centre_read(Camera camera) {
    camera.cam_from_world_translation = -(camera.cam_from_world_rotation * camera.cam_from_world_translation);
    return camera;
}

/// Turns and, where `mirrored`, mirror images of the axes but for leaving them as they are, with the option's text.
std::vector<std::pair<Mat3d, std::string>> signed_permutations(bool mirrored) {
    std::vector<std::pair<Mat3d, std::string>> result;
    std::array<int, 3> order = {0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Mat3d m = Mat3d::Zero();
            std::string text;
            for (int row = 0; row < 3; ++row) {
                const bool negative = (signs >> row) & 1;
                m(row, order[size_t(row)]) = negative ? -1 : 1;
                text += fmt::format("{}{}{}", row ? "," : "", negative ? "-" : "", "xyz"[order[size_t(row)]]);
            }
            if ((m.determinant() < 0) == mirrored && !m.isIdentity()) result.emplace_back(m, text);
        }
    } while (std::ranges::next_permutation(order).found);
    return result;
}

class Search {
public:
    Search(const Mesh& mesh, std::span<const SmallView> views, const FrameHints& hints)
        : mesh_(mesh),
          views_(views),
          points_(surface_points(mesh, point_count)),
          fewer_points_(surface_points(mesh, guessed_points)),
          masked_(has_masks(views)),
          target_(looked_at(views)),
          known_(hints.known_transform),
          poses_(hints.poses) {
        for (const Vec3f& p : mesh.positions) centroid_ += p.cast<double>();
        centroid_ /= double(mesh.vertex_count());
        given_ = measure({});
        guessing_ = given_.value(masked_) > 1;
        if (guessing_) guess_ = guess({});
    }

    std::optional<Misplacement> find() {
        if (fits_well(given_, masked_)) return {};
        try_plain_mistakes();
        if (!is_better(best_value()) || best_value() < 1.5) try_turns_elsewhere();
        const double best = best_value();
        if (!is_better(best)) return {};
        const double least = best - nearly_as_good;
        // Of the first kind that fits nearly as well; of turns, which are equally plain, the best.
        const std::pair<Try, MeshAgreement>* found = nullptr;
        for (const auto& attempt : tried_) {
            const double value = attempt.second.value(masked_);
            if (value < least) continue;
            const bool as_plain = found && attempt.first.turned && attempt.first.why == found->first.why;
            if (!found || (as_plain && value > found->second.value(masked_))) found = &attempt;
        }
        if (!found) return {};
        const Try& t = found->first;
        return Misplacement{t.what,    t.why,  t.cure,        {t.linear, t.shift, t.turned_over},
                            t.guessed, given_, found->second, masked_};
    }

private:
    static std::optional<Vec3d> looked_at(std::span<const SmallView> views) {
        std::vector<Camera> cameras;
        std::vector<Vec2d> aims;
        for (const SmallView& view : views) {
            Vec2d sum = Vec2d::Zero();
            double count = 0;
            for (size_t i = 0; i < view.mask.size(); ++i)
                if (view.mask[i]) {
                    const auto width = size_t(view.camera.width);
                    sum += Vec2d(double(i % width) + 0.5, double(i / width) + 0.5);
                    ++count;
                }
            cameras.push_back(view.camera);
            aims.push_back(count > 0 ? Vec2d(sum / count) : Vec2d(view.camera.cx, view.camera.cy));
        }
        return meeting_point(cameras, aims);
    }

    /// What a try makes of points and views.
    struct Setting {
        std::vector<SurfacePoint> points;
        std::vector<SmallView> changed;
        std::span<const SmallView> views;
        Pairs pairs;
    };
    Setting setting(const Try& attempt, const std::vector<SurfacePoint>& points) const {
        Setting s;
        s.points = points;
        for (SurfacePoint& point : s.points) {
            point.position = attempt.linear * point.position + attempt.shift;
            point.normal = (attempt.linear * point.normal).normalized() * (attempt.turned_over ? -1 : 1);
        }
        s.views = views_;
        if (attempt.other_pose) {
            s.changed.assign(views_.begin(), views_.end());
            for (SmallView& view : s.changed) view.camera = attempt.other_pose(view.camera);
            s.views = s.changed;
        }
        // Neighbours are those about what the cameras look at, which the mesh may be away from.
        const Vec3d centre =
            !attempt.other_pose && target_ ? *target_ : Vec3d(attempt.linear * centroid_ + attempt.shift);
        s.pairs = neighbour_pairs(s.views, centre, neighbours);
        return s;
    }

    MeshAgreement measure(const Try& attempt) const {
        Mesh mesh;
        mesh.triangles = mesh_.triangles;
        const bool over = attempt.turned_over != (attempt.linear.determinant() < 0);
        if (over)
            for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
        for (const Vec3f& p : mesh_.positions)
            mesh.positions.push_back((attempt.linear * p.cast<double>() + attempt.shift).cast<float>());
        const Setting s = setting(attempt, points_);
        return measure_agreement(mesh, s.points, s.views, s.pairs);
    }

    double guess(const Try& attempt) const {
        const Setting s = setting(attempt, fewer_points_);
        return guess_agreement(s.points, s.views, s.pairs);
    }

    void attempt(Try attempt) {
        if (guessing_ && guess(attempt) < guess_ + least_guessed_gain) return;
        MeshAgreement agreement = measure(attempt);
        // Of so many turns and poses some cover the images by chance.
        constexpr double evidence = 0.3;
        const bool colours = agreement.colours.correlation() >= evidence;
        const bool outlines = masked_ && agreement.coverage.overlap() >= given_.coverage.overlap() + evidence;
        // From inside a huge mesh, its other side is always seen.
        const bool contradicted = attempt.turned_over && cameras_inside() && !colours;
        if ((attempt.plain && !contradicted) || colours || outlines) tried_.emplace_back(std::move(attempt), agreement);
    }

    bool cameras_inside() const {
        Eigen::AlignedBox3f box;
        for (const Vec3f& p : mesh_.positions) box.extend(p);
        const auto inside = [&](const SmallView& view) { return box.contains(view.camera.center().cast<float>()); };
        return 2 * std::ranges::count_if(views_, inside) > ptrdiff_t(views_.size());
    }

    bool is_better(double value) const {
        const double given = given_.value(masked_), gain = value - given;
        return gain >= least_gain || (gain >= least_gain_if_halved && 2 - value <= 0.5 * (2 - given));
    }

    double best_value() const {
        double best = 0;
        for (const auto& [attempt, agreement] : tried_) best = std::max(best, agreement.value(masked_));
        return best;
    }

    void try_plain_mistakes() {
        attempt({.turned_over = true, .what = "with its faces turned over", .why = "they face inward", .cure = ""});
        if (poses_ == colmap_poses)
            attempt({.other_pose = with_centre_read,
                     .plain = false,
                     .what = "with the cameras' translations taken for their centres",
                     .why = "they are camera centres C, where translations T = -R C belong",
                     .cure = "write T = -R C"});
        try_other_forms();
        if (known_)
            attempt({.linear = known_->linear,
                     .shift = known_->shift,
                     .what = "moved as the calibration's file says",
                     .why = "it is in the frame from before",
                     .cure = known_->cure});
        for (const double unit : units) try_move(Mat3d::Identity(), "", unit, false);
        for (const double unit : rare_units) try_move(Mat3d::Identity(), "", unit, false);
        for (const bool mirrored : {false, true})
            for (const auto& [turn, text] : signed_permutations(mirrored)) try_move(turn, text, 1, false);
        if (!target_) return;
        try_move(Mat3d::Identity(), "", 1, true);
        for (const double unit : units) try_move(Mat3d::Identity(), "", unit, true);
        if (const double scale = fitting_scale(); scale > 0) {
            fitted_scale_ = scale;
            try_move(Mat3d::Identity(), "", scale, false);
            try_move(Mat3d::Identity(), "", scale, true);
        }
    }

    /// Poses that another format writes so.
    void try_other_forms() {
        std::vector<PoseForm> forms = {{!poses_.to_world, poses_.axes}};
        for (const CameraAxes axes : {CameraAxes::opencv, CameraAxes::opengl, CameraAxes::llff}) {
            if (axes == poses_.axes || (axes == CameraAxes::llff && poses_ == colmap_poses)) continue;
            forms.push_back({poses_.to_world, axes});
            forms.push_back({!poses_.to_world, axes});
        }
        const auto direction = [](bool to_world) { return to_world ? "cameras to the world" : "the world to cameras"; };
        for (const PoseForm form : forms) {
            const bool inverted = form.to_world != poses_.to_world, turned = form.axes != poses_.axes;
            const std::string axes = std::string("axes taken as ") + describe_axes(form.axes);
            Try t;
            t.other_pose = [form, given = poses_](const Camera& camera) { return read_otherwise(camera, given, form); };
            t.plain = false;
            t.what = inverted ? "with the cameras' poses inverted" + (turned ? ", and their " + axes : "")
                              : "with the cameras' " + axes;
            t.why = inverted ? std::string("they take ") + direction(form.to_world) : "they have";
            if (turned) t.why += std::string(inverted ? ", with" : "") + " axes " + describe_axes(form.axes);
            t.cure = inverted ? std::string("write those that take ") + direction(poses_.to_world) : "write them";
            if (turned) t.cure += std::string(inverted ? "," : "") + " with axes " + describe_axes(poses_.axes);
            attempt(std::move(t));
        }
    }

    void try_turns_elsewhere() {
        const double scale = target_ ? fitting_scale() : 0;
        for (const bool mirrored : {false, true})
            for (const auto& [turn, text] : signed_permutations(mirrored)) {
                for (const double unit : units) try_move(turn, text, unit, false);
                if (!target_) continue;
                try_move(turn, text, 1, true);
                if (scale > 0) try_move(turn, text, scale, true);
            }
    }

    /// To what is written of it.
    static double rounded(double number) { return std::stod(fmt::format("{:.6g}", number)); }

    /// The mesh turned and scaled about the origin, then left there or moved to what the cameras look at.
    void try_move(const Mat3d& turn, const std::string& turn_text, double scale, bool moved) {
        Try t;
        scale = rounded(scale);
        t.linear = scale * turn;
        t.turned = !turn_text.empty();
        t.plain = !t.turned;
        t.guessed = scale == fitted_scale_;
        std::vector<std::string> what, why;
        if (!turn_text.empty()) {
            const bool mirrored = turn.determinant() < 0;
            what.push_back((mirrored ? "mirrored by " : "turned by ") + turn_text);
            why.push_back(mirrored ? "mirrored axes" : "other axes");
        }
        if (scale != 1) {
            what.push_back(fmt::format("scaled by {:.4g}", scale));
            why.push_back("another unit");
        }
        if (moved) {
            t.shift = *target_ - t.linear * centroid_;
            for (double& number : t.shift.reshaped()) number = rounded(number);
            t.guessed = true;
            what.push_back("shifted to what the cameras look at");
            why.push_back("another origin");
        }
        const auto join = [](const std::vector<std::string>& parts, const char* between) {
            std::string text;
            for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
            return text;
        };
        t.what = join(what, ", then ");
        t.why = "it has " + join(why, " and ");
        attempt(std::move(t));
    }

    /// At which the outline has the masks' area, moved to what the cameras look at; 0: unknown.
    double fitting_scale() const {
        if (!masked_) return 0;
        double radius = 0, wanted = 0;
        for (const Vec3f& p : mesh_.positions) radius = std::max(radius, (p.cast<double>() - centroid_).norm());
        for (const SmallView& view : views_) {
            const auto area = double(std::ranges::count_if(view.mask, [](uint8_t m) { return m != 0; }));
            wanted += std::sqrt(area / M_PI) * (view.camera.center() - *target_).norm() / view.camera.fx;
        }
        double scale = wanted / double(views_.size()) / radius;
        for (int step = 0; step < 3; ++step) {  // the first guess takes the mesh for a ball
            if (!(scale > 0 && std::isfinite(scale))) return 0;
            Try t;
            t.linear *= scale;
            t.shift = *target_ - scale * centroid_;
            const Coverage now = measure(t).coverage;
            if (now.mesh == 0) return 0;
            scale *= std::sqrt(double(now.object) / double(now.mesh));
        }
        return rounded(scale);
    }

    static constexpr std::array<double, 4> units = {100.0, 1000.0, 0.01, 0.001};
    static constexpr std::array<double, 8> rare_units = {10.0,   0.1,    1e4,        1e-4,
                                                         0.0254, 0.3048, 1 / 0.0254, 1 / 0.3048};  // inches and feet
    const Mesh& mesh_;
    std::span<const SmallView> views_;
    std::vector<SurfacePoint> points_, fewer_points_;
    bool masked_;
    std::optional<Vec3d> target_;
    std::optional<KnownTransform> known_;
    PoseForm poses_;
    Vec3d centroid_ = Vec3d::Zero();
    MeshAgreement given_;
    double fitted_scale_ = 0;  ///< to the masks' areas; 0: not yet
    bool guessing_ = false;    ///< what is given is not so bad: what isn't promising is not measured
    double guess_ = 0;         ///< of what is given
    std::vector<std::pair<Try, MeshAgreement>> tried_;  ///< from the plainest mistake to the most involved
};

}  // namespace

bool fits_well(const MeshAgreement& agreement, bool masked) {
    return agreement.colours.correlation() > 0.9 &&
           (masked ? agreement.coverage.overlap() > 0.93 : agreement.seeing > 0.5);
}

std::optional<Misplacement> find_misplacement(const Mesh& mesh, std::span<const SmallView> views,
                                              const FrameHints& hints) {
    if (views.empty() || mesh.triangles.empty()) return {};
    return Search(mesh, views, hints).find();
}

}  // namespace radiafit::tools
