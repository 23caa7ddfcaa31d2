#pragma once
#include <array>
#include <span>

#include "geometry/atlas.h"
#include "geometry/camera.h"
#include "gl/pixel_uploads.h"
#include "gl/program.h"
#include "gl/texture.h"

namespace radiafit {

/// A triangle atlas on the device: three vertices per triangle that is not degenerate, each with all three positions,
/// its tile and its triangle's three vertex indices, so that one array draws the mesh into images and into SLS.
/// Attributes: 0-2 positions, 3 tile, 4 vertex indices.
class SlsMesh {
public:
    /// cull: whether select() does anything.
    explicit SlsMesh(const TriangleAtlas& atlas, bool cull = true);
    /// Leaves out of what draw() draws the triangles that surely face away from every camera; none: draws all again.
    void select(std::span<const Camera* const> cameras);
    void draw() const;  ///< as triangles, with whatever program is in use
    /// With what hides them, where the atlas's mesh is a part: those triangles have the tile 0xffffffff.
    void draw_visible() const;
    const TriangleAtlas& atlas() const { return *atlas_; }
    const std::vector<uint32_t>& drawn_tiles() const { return drawn_tiles_; }
    /// SIDE and RECTANGLES for shaders/distribute/tiles.glsl.
    Defines defines() const {
        return {{"SIDE", std::to_string(atlas_->side())}, {"RECTANGLES", std::to_string(atlas_->rectangles_per_row())}};
    }
    /// Those, and PART for shaders/distribute/item.* where the atlas's mesh is a part.
    Defines item_defines() const { return part() ? defines() + Defines{{"PART", ""}} : defines(); }
    /// For shaders/distribute/*: the texels of the layout once, the camera per image.
    void set_layout(const Program& program) const {
        program.set("layout_size", float(atlas_->width()), float(atlas_->height()));
    }
    static void set_camera(const Program& program, const Camera& camera);
    /// The rows that shaders/distribute/camera.glsl describes.
    static std::array<float, 12> camera_rows(const Camera& camera);

private:
    /// Which of the triangles are drawn, as an array of them alone.
    struct Drawn {
        VertexArray array;
        Buffer elements;
        std::vector<uint32_t> selected;
        void make(const SlsMesh& mesh, size_t most);
        void add(uint32_t triangle) {
            selected.insert(selected.end(), {3 * triangle, 3 * triangle + 1, 3 * triangle + 2});
        }
        void write();
        void draw() const;
    };
    bool part() const { return atlas_->mesh().surroundings != nullptr; }
    bool may_face(uint32_t triangle) const;

    const TriangleAtlas* atlas_;
    Buffer positions_[3], tiles_, vertices_;
    Drawn own_, visible_;                  ///< visible_: of a part
    std::vector<Vec3f> normals_, points_;  ///< per triangle here: any length, and one of its vertices
    std::vector<uint32_t> tile_of_;        ///< per triangle here: its tile
    std::vector<uint32_t> drawn_tiles_;
    std::vector<Vec3f> eyes_;
    bool cull_;
};

/// Pass 1 of Section 5.1.1. Items are row * layout width + column of a texel's place in SLS; 0xffffffff is none.
class ItemBuffer {
public:
    /// `bits` 8 or 16: items carry their pixels' colours, RG32UI (item, r | g << 8 | b << 16) or RGBA32UI (item, r | g
    /// << 16, b), and a pixel outside the mask is none. 0: items alone, R32UI.
    /// layers: 0, or that many in an array, which one depth buffer serves.
    ItemBuffer(const SlsMesh& mesh, int max_width, int max_height, int bits = 0, int layers = 0);
    /// Draws into rows [0, height) and columns [0, width); image row 0 is framebuffer row 0. Colours come from what the
    /// program has as its image.
    void draw(const Camera& camera, int layer = 0) const;
    const Texture& items() const { return items_; }
    const Framebuffer& framebuffer(int layer) const { return framebuffers_[size_t(layer)]; }
    const Program& program() const { return program_; }

private:
    const SlsMesh* mesh_;
    Texture items_, depth_;
    std::vector<Framebuffer> framebuffers_;  ///< [layer]
    Program program_;
};

/// A slot for one image of the stream: unsigned integers, RGBA8UI or RGBA16UI, so that targets are the very numbers of
/// the file.
class ImageSlot {
public:
    ImageSlot(int max_width, int max_height, int bits);
    void upload(const struct TargetImage& image);
    void take(PixelUploads& uploads, int width, int height);  ///< what was written since begin()
    const Texture& texture() const { return texture_; }

private:
    GLenum type() const { return texture_.format() == GL_RGBA8UI ? GL_UNSIGNED_BYTE : GL_UNSIGNED_SHORT; }
    Texture texture_;
};

}  // namespace radiafit
