#pragma once
#include <string>
#include <utility>
#include <vector>

#include "gl/functions.h"

namespace radiafit {

/// Preprocessor definitions put before a shader's text.
using Defines = std::vector<std::pair<std::string, std::string>>;

/// Where shader texts live: RADIAFIT_SHADERS if set, else the shaders/ folder of the sources this was built from.
std::string shader_folder();

/// A shader with every #include "…" (relative to shader_folder()) expanded once, and #line kept, so that errors name
/// the real file.
struct ShaderText {
    std::string text;
    std::vector<std::string> files;  ///< #line's second number is an index into this
};
/// `file` begins with a #version line; `defines` follow it. Throws UserError for a file that cannot be read.
ShaderText expand_shader(const std::string& file, const Defines& defines = {});

/// A linked program of the current context. Uniforms are set by explicit location.
class Program {
public:
    Program() = default;
    /// Throw SystemError with the compiler's messages, file names put in.
    static Program draw(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines = {});
    static Program compute(const std::string& file, const Defines& defines = {});
    ~Program();
    Program(Program&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Program& operator=(Program&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }

    void use() const { gl().UseProgram(name_); }
    void set(int location, int value) const { gl().ProgramUniform1i(name_, location, value); }
    void set(int location, unsigned value) const { gl().ProgramUniform1ui(name_, location, value); }
    void set(int location, float value) const { gl().ProgramUniform1f(name_, location, value); }
    void set2(int location, int x, int y) const { gl().ProgramUniform2i(name_, location, x, y); }
    void set2(int location, float x, float y) const { gl().ProgramUniform2f(name_, location, x, y); }
    void set3(int location, float x, float y, float z) const { gl().ProgramUniform3f(name_, location, x, y, z); }
    /// count vec4s of an array uniform.
    void set4(int location, int count, const float* values) const {
        gl().ProgramUniform4fv(name_, location, count, values);
    }
    unsigned name() const { return name_; }

private:
    GLuint name_ = 0;
};

}  // namespace radiafit
