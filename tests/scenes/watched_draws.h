#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "fragment/pass_runner.h"

namespace radiafit {

/// Draws, and those that bind what a chip of 2003 could not.
struct DrawCounts {
    int draws = 0;
    int several_targets = 0;  ///< more than one colour is drawn to
    int vertex_look_ups = 0;  ///< the vertex program has a texture
    int own_target_read = 0;  ///< a texture that is looked up is drawn to
    int unknown = 0;          ///< of a program or framebuffer that was made before
};

/// Counts draws of the current context while one of these lives. It knows the framebuffers, textures and programs that
/// are made and bound in its lifetime.
class WatchedDraws {
public:
    WatchedDraws() {
        counts_ = {};
        colours_.clear(), units_.clear(), bound_.clear();
        program_ = framebuffer_ = 0;
        saved_ = table();
        table().NamedFramebufferTextureLayer.pointer = [](GLuint framebuffer, GLenum attachment, GLuint texture,
                                                          GLint level, GLint layer) {
            attach(framebuffer, attachment, texture);
            saved_.NamedFramebufferTextureLayer.pointer(framebuffer, attachment, texture, level, layer);
        };
        table().NamedFramebufferTexture.pointer = [](GLuint framebuffer, GLenum attachment, GLuint texture,
                                                     GLint level) {
            attach(framebuffer, attachment, texture);
            saved_.NamedFramebufferTexture.pointer(framebuffer, attachment, texture, level);
        };
        table().ProgramUniform1iv.pointer = [](GLuint program, GLint location, GLsizei count, const GLint* values) {
            units_[{program, location}] = {values, values + count};
            saved_.ProgramUniform1iv.pointer(program, location, count, values);
        };
        table().BindTextureUnit.pointer = [](GLuint unit, GLuint texture) {
            bound_[int(unit)] = texture;
            saved_.BindTextureUnit.pointer(unit, texture);
        };
        table().BindFramebuffer.pointer = [](GLenum target, GLuint framebuffer) {
            framebuffer_ = framebuffer;
            saved_.BindFramebuffer.pointer(target, framebuffer);
        };
        table().UseProgram.pointer = [](GLuint program) {
            program_ = program;
            saved_.UseProgram.pointer(program);
        };
        table().DrawArrays.pointer = [](GLenum mode, GLint first, GLsizei count) {
            look();
            saved_.DrawArrays.pointer(mode, first, count);
        };
        table().DrawElements.pointer = [](GLenum mode, GLsizei count, GLenum type, const void* indices) {
            look();
            saved_.DrawElements.pointer(mode, count, type, indices);
        };
    }
    ~WatchedDraws() { table() = saved_; }
    WatchedDraws(const WatchedDraws&) = delete;
    WatchedDraws& operator=(const WatchedDraws&) = delete;
    const DrawCounts& counts() const { return counts_; }

private:
    static GlFunctions& table() { return const_cast<GlFunctions&>(Context::current().functions()); }
    static void attach(GLuint framebuffer, GLenum attachment, GLuint texture) {
        if (attachment < GL_COLOR_ATTACHMENT0 || attachment > GL_COLOR_ATTACHMENT15) return;
        auto& colours = colours_[framebuffer];
        if (attachment == GL_COLOR_ATTACHMENT0) colours.clear();  // the name may come again
        colours[attachment] = texture;
    }
    static void look() {
        ++counts_.draws;
        const auto colours = colours_.find(framebuffer_);
        if (colours == colours_.end()) {
            ++counts_.unknown;
            return;
        }
        counts_.several_targets += colours->second.size() > 1;
        std::set<GLuint> targets;
        for (const auto& [attachment, texture] : colours->second) targets.insert(texture);
        bool vertex = false, own = false;
        constexpr GLenum plain[] = {GL_FLOAT, GL_FLOAT_VEC2, GL_FLOAT_VEC4, GL_INT};  // all others are samplers
        constexpr GLenum properties[] = {GL_LOCATION, GL_TYPE, GL_REFERENCED_BY_VERTEX_SHADER};
        int count = 0;
        gl().GetProgramInterfaceiv(program_, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
        for (GLuint i = 0; i < GLuint(count); ++i) {
            int values[3] = {};
            gl().GetProgramResourceiv(program_, GL_UNIFORM, i, 3, properties, 3, nullptr, values);
            if (std::ranges::find(plain, GLenum(values[1])) != std::end(plain)) continue;
            vertex |= values[2] != 0;
            const auto units = units_.find({program_, values[0]});
            if (units == units_.end()) {
                ++counts_.unknown;
                continue;
            }
            for (const int unit : units->second) own |= targets.contains(bound_[unit]);
        }
        counts_.vertex_look_ups += vertex;
        counts_.own_target_read += own;
    }

    inline static DrawCounts counts_;
    inline static std::map<GLuint, std::map<GLenum, GLuint>> colours_;          ///< of framebuffers, by attachment
    inline static std::map<std::pair<GLuint, GLint>, std::vector<int>> units_;  ///< of programs' samplers, by location
    inline static std::map<int, GLuint> bound_;                                 ///< textures by unit
    inline static GLuint program_ = 0, framebuffer_ = 0;
    inline static GlFunctions saved_;
};

/// One target and 16 look-ups at most, by what the passes that were tallied declare, and no loop whose length the
/// program doesn't know.
inline void expect_costs_of_the_chip(const PassRunner& run) {
    EXPECT_FALSE(run.tallies().empty());
    for (const auto& [label, tally] : run.tallies()) {
        ASSERT_NE(tally.cost, nullptr) << label << " declares no cost";
        EXPECT_EQ(tally.cost->targets, 1) << label;
        EXPECT_LE(tally.cost->fragment.reads, 16u) << label;
        EXPECT_EQ(tally.cost->entry.operations, 0u) << label;
    }
}

}  // namespace radiafit
