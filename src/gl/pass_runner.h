#pragma once
#include <cstdint>

#include "gl/sls_mesh.h"

namespace radiafit {

/// What passes cost, counted as they are issued; later figures multiply by measured rates.
struct PassCounters {
    uint64_t draws = 0;
    uint64_t framebuffer_switches = 0;
    uint64_t program_switches = 0;
    uint64_t cleared_texels = 0;
};

/// Issues passes: one framebuffer, one program, one draw. Blending is off unless asked for.
class PassRunner {
public:
    explicit PassRunner(const SlsMesh& mesh) : mesh_(&mesh) {}

    void bind(const Framebuffer& target, const Program& program) {
        target.bind();
        program.use();
        ++counters.framebuffer_switches;
        ++counters.program_switches;
    }
    void clear(const Framebuffer& target) {
        target.clear();
        counters.cleared_texels += uint64_t(target.width()) * target.height();
    }
    /// Every texel of the target.
    void draw_whole() {
        empty_.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        ++counters.draws;
    }
    /// The tiles of the mesh (those that the program's vertex stage doesn't cull).
    void draw_tiles() {
        mesh_->draw();
        ++counters.draws;
    }
    /// Points of the size that the vertex stage gives them.
    void draw_points(size_t count) {
        empty_.bind();
        gl().Enable(GL_PROGRAM_POINT_SIZE);
        gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
        ++counters.draws;
    }
    void blend(GLenum equation = GL_FUNC_ADD) {
        gl().Enable(GL_BLEND);
        gl().BlendFunc(GL_ONE, GL_ONE);
        gl().BlendEquation(equation);
    }
    /// Adds into attachments [first, end), overwrites the others.
    void blend_from(unsigned first, unsigned end) {
        blend();
        gl().Disable(GL_BLEND);
        for (unsigned i = first; i < end; ++i) gl().Enablei(GL_BLEND, i);
    }
    void no_blend() { gl().Disable(GL_BLEND); }

    PassCounters counters;

private:
    const SlsMesh* mesh_;
    VertexArray empty_;
};

}  // namespace radiafit
