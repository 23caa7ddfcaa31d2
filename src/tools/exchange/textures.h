#pragma once
#include <memory>
#include <optional>

#include "dataset/dataset.h"
#include "exchange/padded_tiles.h"
#include "exchange/surface_look.h"

namespace radiafit::tools {

/// A look as textures of one size: of a mesh in the layout of PaddedTiles, of a grid a texel for each of the grid's.
struct LookTextures {
    std::optional<PaddedTiles> tiles;  ///< of a mesh
    TextureImage base_colour;  ///< R, G, B: linear light; of a grid with texels that aren't fitted also A, 0 or 1
    std::optional<TextureImage> roughness;  ///< one channel
    /// Of a grid with normals: unit vectors right, up and out of its plane; straight out where a texel isn't fitted.
    std::optional<TextureImage> normals;
};
/// The look's atlas and the dataset must outlive it. Throws UserError as PaddedTiles does.
LookTextures textures_of(const SurfaceLook& look, const Dataset& dataset);
/// Unit vectors in the layout of `textures`, of normals [texels] of the look's atlas; those of a grid are straight out
/// where they are 0, and those of a mesh 0 where no triangle is.
TextureImage normals_texture(const std::vector<Vec3f>& normals, const SurfaceLook& look, const LookTextures& textures);

/// As PNG files' bytes, 8 bits: sRGB of linear light, clamped, and of the normals 0.5 n + 0.5; of roughness glTF's
/// image, in which green is the roughness and blue, the metalness, is 0.
std::string base_colour_png(const LookTextures& textures);
std::string roughness_png(const TextureImage& roughness);
std::string normals_png(const TextureImage& normals);

}  // namespace radiafit::tools
