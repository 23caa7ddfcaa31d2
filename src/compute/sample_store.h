#pragma once
#include <array>

#include "dataset/dataset.h"
#include "gl/program.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

namespace radiafit {

/// A buffer, and the buffer texture that passes fetch it by.
struct FetchedBuffer {
    Buffer buffer;
    Texture texture;

    FetchedBuffer() = default;
    /// `format`: of the texture's texels, such as GL_RGBA32F. data: null, or so many bytes. Throws UserError, naming
    /// what it is, where the device fetches from none so large.
    FetchedBuffer(const char* what, GLenum format, size_t bytes, const void* data, bool dynamic = false);
};
/// A buffer that passes write to, all zero. Throws UserError, naming what it is, where the device writes to none so
/// large.
Buffer storage_buffer(const char* what, size_t bytes);

/// The samples of a light field map in buffers, and the tables that lead from vertices to them: what
/// shaders/compute/samples.glsl reads. Samples stand there twice: by tile, image and texel, which is how the views of a
/// vertex add up what they see, and by tile, texel and image, which is how a texel adds up its own. So every sum has
/// one invocation that makes it, in one order. A sample takes four bytes in either order, or eight: of colours with
/// more than 8 bits, tiles of more than 256 texels, and tiles that more than 256 images see.
class SampleStore {
public:
    /// Nothing of the arguments is kept. Throws UserError where a buffer would be larger than the device allows.
    SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout,
                const SampleList& samples, const LfmOptions& options);

    Defines defines() const { return wide_ ? Defines{{"WIDE", ""}} : Defines{}; }
    /// Tells a program of all buffers and uniforms that it uses of these.
    void bind_to(const Program& program) const;
    /// Cameras' views of vertices: one for each vertex and each image in which some texel of its ring takes a pixel.
    size_t pair_count() const { return pair_count_; }

private:
    /// As shaders/compute/vertices.glsl numbers them.
    enum Table {
        vertices,
        maps,
        sites,
        neighbours,
        cell_first,
        cell_pairs,
        groups_of_images,
        pairs_of_groups,
        group_first,
        texel_first,
        target_weights,
        table_count
    };

    size_t pair_count_ = 0;
    bool wide_ = false;
    int vertex_count_, view_neighbours_ = 0;
    std::array<int, table_count> table_begin_{};
    FetchedBuffer tables_, pairs_, by_image_, by_texel_;
};

}  // namespace radiafit
