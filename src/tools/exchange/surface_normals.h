#pragma once
#include <optional>
#include <vector>

#include "eval/contestant.h"
#include "geometry/atlas.h"

namespace radiafit::tools {

struct SurfaceNormals {
    /// [texels] unit, or 0 where there is none. Of a grid: x right, y up, z out of its plane; of a mesh: in the mesh's
    /// coordinates.
    std::vector<Vec3f> normals;
    size_t lamps = 0;  ///< that they were found from; 0: they are the dataset's

    /// Those of `others`, which has as many texels, where there is none.
    std::vector<Vec3f> or_else(const SurfaceNormals& others) const;
};
/// From a grid's axes, as SurfaceNormals has them, to the world's; a mesh's are there already.
std::vector<Vec3f> in_world(std::vector<Vec3f> normals, const Dataset& dataset);

/// Those that a fit of the dataset is shaded with; 0 for texels that aren't usable.
SurfaceNormals normals_of_dataset(const Atlas& atlas, const Dataset& dataset);
/// Whether a grid has others than its plane's.
bool has_own_normals(const Dataset& dataset);

/// Lambertian photometric stereo (model/photometric_stereo.h) on what `contestant` shows of every texel to the views
/// that were fitted, 64 of them evenly at most, over the light that the texel gets of the view's lamp: so gloss, cast
/// shadows and what neighbours reflect bend the normals little. Nothing where so few lamps, or lamps in one plane, tell
/// no normals. The dataset's views have lamps. [texels] 0 also where too little is lit.
/// training: the views that were fitted. contestant: of linear light, over the atlas.
std::optional<SurfaceNormals> normals_of_fit(const Contestant& contestant, const Atlas& atlas, const Dataset& dataset,
                                             const std::vector<uint32_t>& training);

/// Those that tell most of a surface: a grid's own; else those of the fit, and the dataset's where that has none.
/// Arguments as those of normals_of_fit().
SurfaceNormals finest_normals(const Contestant& contestant, const Atlas& atlas, const Dataset& dataset,
                              const std::vector<uint32_t>& training);

}  // namespace radiafit::tools
