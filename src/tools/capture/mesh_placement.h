#pragma once
#include <string>
#include <string_view>

#include "base/linear.h"

namespace radiafit::tools {

/// Where a mesh goes, before anything else is done to it: p' = linear p + shift, in double.
struct MeshPlacement {
    Mat3d linear = Mat3d::Identity();
    Vec3d shift = Vec3d::Zero();
    bool flip_faces = false;  ///< the file's faces turn inward

    /// This, and `next` after it.
    MeshPlacement then(const MeshPlacement& next) const {
        return {next.linear * linear, next.linear * shift + next.shift, flip_faces != next.flip_faces};
    }
    Vec3d apply(const Vec3d& p) const { return linear * p + shift; }
    bool is_identity() const { return linear.isIdentity(0) && shift.isZero(0); }
    /// Whether each triangle's corners change their order: mirrored, faces would turn inward.
    bool turns_faces() const { return flip_faces != (linear.determinant() < 0); }
};

/// From the values of --mesh-turn ("x,z,-y": the new x is the old x, the new y the old z, the new z the old -y; empty:
/// as it is), then --mesh-scale (above 0), then --mesh-shift ("1,2,3"; empty: none). Throws UserError
/// that names the option and what it takes.
MeshPlacement parse_placement(std::string_view turn, double scale, std::string_view shift, bool flip_faces);

/// The options that apply it, such as "--mesh-turn x,z,-y --mesh-scale 0.01"; of another linear part than turns of axes
/// and one scale, its rows: "linear part 1,0.5,0;0,1,0;0,0,1". Empty if nothing changes.
std::string describe_placement(const MeshPlacement& placement);

}  // namespace radiafit::tools
