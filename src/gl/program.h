#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gl/functions.h"

namespace radiafit {

/// Preprocessor definitions put before a shader's text.
using Defines = std::vector<std::pair<std::string, std::string>>;
inline Defines operator+(Defines a, const Defines& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

struct PassCost;

/// A shader with every #include "…" (relative to shaders/) expanded once, and #line kept, so that errors name the real
/// file. Texts are part of the library; those of a folder named by RADIAFIT_SHADERS stand in for them all. Where the
/// name of a file is a definition's, that definition takes its place: "model/MODEL.glsl".
struct ShaderText {
    std::string text;
    std::vector<std::string> files;  ///< #line's second number is an index into this
};
/// `file` begins with a #version line; `defines` follow it. Throws UserError for a file that cannot be read.
ShaderText expand_shader(const std::string& file, const Defines& defines = {});

/// A linked program of the current context. Uniforms are set by explicit location; a location that the program doesn't
/// use is passed over, so that passes which share an interface are set up alike.
class Program {
public:
    Program() = default;
    /// Throw SystemError with the compiler's messages, file names put in.
    static Program draw(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines = {});
    static Program compute(const std::string& file, const Defines& defines = {});
    ~Program();
    Program(Program&& other) noexcept
        : name_(std::exchange(other.name_, 0)),
          locations_(other.locations_),
          label_(std::move(other.label_)),
          cost_(other.cost_) {}
    Program& operator=(Program&& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(locations_, other.locations_);
        std::swap(label_, other.label_);
        std::swap(cost_, other.cost_);
        return *this;
    }

    void use() const { gl().UseProgram(name_); }
    void set(int location, int value) const {
        if (uses(location)) gl().ProgramUniform1i(name_, location, value);
    }
    void set(int location, float value) const {
        if (uses(location)) gl().ProgramUniform1f(name_, location, value);
    }
    void set2(int location, int x, int y) const {
        if (uses(location)) gl().ProgramUniform2i(name_, location, x, y);
    }
    void set2(int location, float x, float y) const {
        if (uses(location)) gl().ProgramUniform2f(name_, location, x, y);
    }
    void set3(int location, float x, float y, float z) const {
        if (uses(location)) gl().ProgramUniform3f(name_, location, x, y, z);
    }
    /// count vec4s of an array uniform.
    void set4(int location, int count, const float* values) const {
        if (uses(location)) gl().ProgramUniform4fv(name_, location, count, values);
    }
    bool uses(int location) const { return location < 64 && (locations_ >> location & 1) != 0; }
    unsigned name() const { return name_; }
    /// The fragment stage and what its cost depends on, such as "gather/look_up.frag STORAGE=0 TERMS=1".
    const std::string& label() const { return label_; }
    /// What a fragment declares to cost; null where none is declared (gl/pass_costs.h).
    const PassCost* cost() const { return cost_; }

private:
    void find_locations();
    GLuint name_ = 0;
    uint64_t locations_ = 0;  ///< bit i: a uniform at location i is active
    std::string label_;
    const PassCost* cost_ = nullptr;
};

}  // namespace radiafit
