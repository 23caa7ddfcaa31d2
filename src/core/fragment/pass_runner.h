#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fragment/pass_costs.h"
#include "fragment/sls_mesh.h"

namespace radiafit {

/// Counted as passes are issued; later figures multiply by measured rates.
struct PassCounters {
    uint64_t draws = 0, framebuffer_switches = 0;
};

/// What the draws of one program amount to: its declared cost times what was measured.
struct PassTally {
    const PassCost* cost = nullptr;  ///< null: none is declared, and the work is unknown
    uint64_t draws = 0;
    uint64_t fragments = 0;  ///< that reached their targets
    uint64_t entries = 0;    ///< turns of the program's loop
    uint64_t written_bytes = 0, blended_bytes = 0;
    Work work() const { return cost ? Work(cost->fragment * fragments) += cost->entry * entries : Work(); }
};

/// Several results of one place: drawn by one program into as many targets, or by one program each, into one target
/// (ONLY, shaders/common/output.glsl). What is defined for each program.
std::vector<Defines> result_defines(int results, bool one_target);
/// And the framebuffer of each.
std::vector<Framebuffer> result_targets(const std::vector<Target>& results, bool one_target);

/// Issues passes: one framebuffer, one program, one draw. Blending is off unless asked for.
class PassRunner {
public:
    PassRunner() = default;  ///< of passes that draw no tiles
    explicit PassRunner(const SlsMesh& mesh) : mesh_(&mesh) {}
    ~PassRunner();
    PassRunner(const PassRunner&) = delete;
    PassRunner& operator=(const PassRunner&) = delete;

    void clear(const Framebuffer& target) {
        target.clear();
        if (tallying_) cleared_bytes_ += uint64_t(target.texel_bytes()) * target.width() * target.height();
    }
    /// Every texel of the target. entries: turns of the program's loop in all fragments together, if it has one.
    void draw_whole(const Framebuffer& target, const Program& program, uint64_t entries = 0) {
        use(target, program);
        empty_.bind();
        draw(entries, [] { gl().DrawArrays(GL_TRIANGLES, 0, 3); });
    }
    /// The tiles of the mesh (those that the program's vertex stage doesn't cull).
    void draw_tiles(const Framebuffer& target, const Program& program) {
        use(target, program);
        draw(0, [&] { mesh_->draw(); });
    }
    /// Points of the size that the vertex stage gives them.
    void draw_points(const Framebuffer& target, const Program& program, size_t count) {
        use(target, program);
        empty_.bind();
        gl().Enable(GL_PROGRAM_POINT_SIZE);
        draw(0, [&] { gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count)); });
    }
    /// One layer of an item buffer.
    void draw_items(const ItemBuffer& items, const Camera& camera, int layer = 0) {
        target_ = &items.framebuffer(layer);
        program_ = &items.program();
        ++counters.framebuffer_switches;
        draw(0, [&] { items.draw(camera, layer); });
    }
    void blend(GLenum equation = GL_FUNC_ADD) {
        gl().Enable(GL_BLEND);
        gl().BlendFunc(GL_ONE, GL_ONE);
        gl().BlendEquation(equation);
        first_blended_ = 0, last_blended_ = all_targets;
    }
    /// Adds into attachments [first, end), overwrites the others.
    void blend_from(unsigned first, unsigned end) {
        blend();
        gl().Disable(GL_BLEND);
        for (unsigned i = first; i < end; ++i) gl().Enablei(GL_BLEND, i);
        first_blended_ = int(first), last_blended_ = int(end);
    }
    void no_blend() {
        gl().Disable(GL_BLEND);
        first_blended_ = last_blended_ = 0;
    }
    /// Texels that every drawn tile of the mesh has, over all: turns of the loop where a fragment sums its tile's
    /// texels.
    uint64_t tile_texels() const { return mesh_->drawn_tiles().size() * uint64_t(mesh_->atlas().texels_per_tile()); }

    /// Starts over a tally of every pass, or ends it. Fragments are those that occlusion queries count, exact on
    /// llvmpipe too, where pipeline statistics count blocks of 4 x 4: fragments of texels that are covered and, in the
    /// item buffer, nearest so far. Each draw waits for its query, so that times taken meanwhile mean
    /// nothing.
    void tally(bool on);
    /// By pass_label(). Depth is left out.
    const std::map<std::string, PassTally>& tallies() const { return tallies_; }
    uint64_t cleared_bytes() const { return cleared_bytes_; }

    PassCounters counters;

private:
    static constexpr int all_targets = 1 << 10;
    void use(const Framebuffer& target, const Program& program) {
        target.bind();
        program.use();
        target_ = &target;
        program_ = &program;
        ++counters.framebuffer_switches;
    }
    template <class Draw>
    void draw(uint64_t entries, const Draw& issue) {
        ++counters.draws;
        if (!tallying_) return issue();
        gl().BeginQuery(GL_SAMPLES_PASSED, query_);
        issue();
        gl().EndQuery(GL_SAMPLES_PASSED);
        add_draw(entries);
    }
    void add_draw(uint64_t entries);

    const SlsMesh* mesh_ = nullptr;
    VertexArray empty_;
    const Framebuffer* target_ = nullptr;
    const Program* program_ = nullptr;
    int first_blended_ = 0, last_blended_ = 0;
    bool tallying_ = false;
    GLuint query_ = 0;
    std::map<std::string, PassTally> tallies_;
    uint64_t cleared_bytes_ = 0;
};

}  // namespace radiafit
