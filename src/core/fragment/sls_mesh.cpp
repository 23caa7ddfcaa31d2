#include "fragment/sls_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/error.h"
#include "dataset/image_stream.h"
#include "geometry/mesh_part.h"

namespace radiafit {

SlsMesh::SlsMesh(const TriangleAtlas& atlas, bool cull) : atlas_(&atlas), cull_(cull) {
    if (!atlas.one_side()) throw UserError("in OpenGL all surface maps have one side; choose it, or fit on the CPU");
    const Mesh& mesh = visible_mesh(atlas.mesh());
    std::vector<Vec3f> positions[3];
    std::vector<uint32_t> tiles;
    std::vector<std::array<uint32_t, 3>> vertices;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        if (is_degenerate(mesh, t)) continue;
        const uint32_t tile = fitted_triangle(atlas.mesh(), t);
        const auto& [i0, i1, i2] = mesh.triangles[t];
        tile_of_.push_back(tile);
        points_.push_back(mesh.positions[i0]);
        normals_.push_back((mesh.positions[i1] - mesh.positions[i0]).cross(mesh.positions[i2] - mesh.positions[i0]));
        for (int repeat = 0; repeat < 3; ++repeat) {
            for (int c = 0; c < 3; ++c) positions[c].push_back(mesh.positions[mesh.triangles[t][c]]);
            tiles.push_back(tile);
            vertices.push_back(tile == no_triangle ? std::array<uint32_t, 3>{} : atlas.mesh().triangles[tile]);
        }
    }
    for (int c = 0; c < 3; ++c) positions_[c] = Buffer(positions[c]);
    tiles_ = Buffer(tiles);
    vertices_ = Buffer(vertices);
    own_.make(*this, part() ? 3 * atlas.tile_count() : tiles.size());
    if (part()) visible_.make(*this, tiles.size());
    select({});
}

void SlsMesh::Drawn::make(const SlsMesh& mesh, size_t most) {
    elements = Buffer(most * sizeof(uint32_t), nullptr, true);
    array.elements(elements);
    selected.reserve(most);
    for (int c = 0; c < 3; ++c) array.floats(static_cast<unsigned>(c), 3, mesh.positions_[c]);
    array.integers(3, 1, mesh.tiles_);
    array.integers(4, 3, mesh.vertices_);
}

void SlsMesh::Drawn::write() { elements.write(0, selected.size() * sizeof(uint32_t), selected.data()); }

void SlsMesh::Drawn::draw() const {
    array.bind();
    if (!selected.empty()) gl().DrawElements(GL_TRIANGLES, int(selected.size()), GL_UNSIGNED_INT, nullptr);
}

bool SlsMesh::may_face(uint32_t i) const {
    return eyes_.empty() || std::any_of(eyes_.begin(), eyes_.end(), [&](const Vec3f& eye) {
               const Vec3f to_eye = eye - points_[i];
               // Rounding must not lose a triangle that OpenGL would draw: one seen edge-on stays.
               const float facing = normals_[i].dot(to_eye);
               return !(facing < 0 && facing * facing > 1e-8f * normals_[i].squaredNorm() * to_eye.squaredNorm());
           });
}

void SlsMesh::select(std::span<const Camera* const> cameras) {
    eyes_.clear();
    if (cull_)
        for (const Camera* camera : cameras) eyes_.push_back(camera->center().cast<float>());
    own_.selected.clear();
    visible_.selected.clear();
    drawn_tiles_.clear();
    for (uint32_t i = 0; i < points_.size(); ++i) {
        if (!may_face(i)) continue;
        if (part()) visible_.add(i);
        if (tile_of_[i] == no_triangle) continue;
        own_.add(i);
        drawn_tiles_.push_back(tile_of_[i]);
    }
    own_.write();
    if (part()) visible_.write();
}

void SlsMesh::draw() const { own_.draw(); }

void SlsMesh::draw_visible() const { (part() ? visible_ : own_).draw(); }

std::array<float, 12> SlsMesh::camera_rows(const Camera& camera) {
    Mat3d intrinsics;
    intrinsics << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
    const Mat3d rotation = intrinsics * camera.cam_from_world_rotation;
    const Vec3d translation = intrinsics * camera.cam_from_world_translation;
    std::array<float, 12> rows;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) rows[size_t(4 * r + c)] = float(rotation(r, c));
        rows[size_t(4 * r + 3)] = float(translation(r));
    }
    return rows;
}

void SlsMesh::set_camera(const Program& program, const Camera& camera) {
    program.set("camera", camera_rows(camera));
    program.set("image_size", float(camera.width), float(camera.height));
}

ItemBuffer::ItemBuffer(const SlsMesh& mesh, int max_width, int max_height, int bits, int layers)
    : mesh_(&mesh),
      items_(bits == 16  ? GL_RGBA32UI
             : bits == 8 ? GL_RG32UI
                         : GL_R32UI,
             max_width, max_height, layers),
      depth_(GL_DEPTH_COMPONENT32F, max_width, max_height),
      program_(
          Program::draw("distribute/item.vert", "distribute/item.frag",
                        bits ? mesh.item_defines() + Defines{{"COLOUR", std::to_string(bits)}} : mesh.item_defines())) {
    for (int layer = 0; layer < std::max(1, layers); ++layer)
        framebuffers_.push_back(Framebuffer({{&items_, layer}}, &depth_));
}

void ItemBuffer::draw(const Camera& camera, int layer) const {
    const Framebuffer& framebuffer = framebuffers_[size_t(layer)];
    mesh_->set_camera(program_, camera);
    framebuffer.bind(camera.width, camera.height);
    const GLuint none[4] = {no_texel, no_texel, no_texel, no_texel};
    const float far = 0;
    gl().DepthMask(GL_TRUE);
    gl().ClearNamedFramebufferuiv(framebuffer.name(), GL_COLOR, 0, none);
    gl().ClearNamedFramebufferfv(framebuffer.name(), GL_DEPTH, 0, &far);
    gl().ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_GREATER);
    gl().Enable(GL_CULL_FACE);
    gl().FrontFace(GL_CW);  // image y points down
    program_.use();
    mesh_->draw_visible();
    gl().Disable(GL_CULL_FACE);
    gl().Disable(GL_DEPTH_TEST);
}

ImageSlot::ImageSlot(int max_width, int max_height, int bits)
    : texture_(bits == 8 ? GL_RGBA8UI : GL_RGBA16UI, max_width, max_height) {}

void ImageSlot::upload(const TargetImage& image) {
    texture_.upload_part(image.width, image.height, GL_RGBA_INTEGER, type(),
                         image.bits == 8 ? static_cast<const void*>(image.rgba8.data()) : image.rgba16.data());
}

void ImageSlot::take(PixelUploads& uploads, int width, int height) {
    uploads.end(texture_, width, height, GL_RGBA_INTEGER, type());
}

}  // namespace radiafit
