#pragma once
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gl/shader_text.h"
#include "gl/texture.h"

namespace radiafit {

/// A linked program of the current context. Its inputs go by the names in its text: uniforms are set, textures and
/// buffers are bound, and each stays until it is set or bound again. While a debugging context is current, a name that
/// the linked program doesn't use is a std::logic_error, and so is a draw with an input never set or bound; else either
/// is passed over, for compilers differ in which names remain in use. What is set in several programs, of which not all
/// use it, goes by ..._if_used().
class Program {
public:
    Program() = default;
    /// Throws SystemError with the compiler's messages, file names put in.
    static Program draw(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines = {});
    /// As draw(), for a compute shader. Buffers are bound by the names of their blocks.
    static Program compute(const std::string& file, const Defines& defines = {});
    ~Program();
    Program(Program&& other) noexcept { *this = std::move(other); }
    Program& operator=(Program&& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(inputs_, other.inputs_);
        std::swap(textures_, other.textures_);
        std::swap(buffers_, other.buffers_);
        std::swap(file_, other.file_);
        std::swap(defines_, other.defines_);
        return *this;
    }

    void set(std::string_view uniform, int value) const { set(uniform, {&value, 1}); }
    void set(std::string_view uniform, float value) const;
    void set(std::string_view uniform, float x, float y) const;
    void set(std::string_view uniform, std::span<const int> values) const;   ///< of an array
    void set(std::string_view uniform, std::span<const float> vec4s) const;  ///< a vec4, or several of an array
    /// For a sampler, or one of an array of them; one that the compiler has left out is passed over. The texture may
    /// move, and must live at every draw to come.
    void bind(std::string_view sampler, const Texture& texture, size_t index = 0) const;
    /// For a storage block, "Name", or one of an array of them, "Name[2]". As textures.
    void bind(std::string_view block, const Buffer& buffer) const;
    void set_if_used(std::string_view uniform, const auto&... values) const {
        if (find(uniform)) set(uniform, values...);
    }
    void bind_if_used(std::string_view name, const auto& texture_or_buffer) const {
        if (find(name)) bind(name, texture_or_buffer);
    }
    /// Draws are with this program, its uniforms, textures and buffers, all of which must have been set or bound.
    void use() const;
    /// So many work groups, of a program for computing. What they write to storage buffers, later programs read there
    /// and by buffer textures, and Buffer::read().
    void dispatch(size_t groups) const;

    explicit operator bool() const { return name_ != 0; }
    /// The file of the fragment or compute stage, under shaders/.
    const std::string& file() const { return file_; }
    const Defines& defines() const { return defines_; }

private:
    /// A uniform in use, samplers in an array, or a storage block.
    struct Input {
        std::string name;
        int location = 0, unit = -1;  ///< unit: of its first texture, or of its buffer; -1 for a uniform
        size_t count = 1;             ///< of an array's elements in use: compilers leave out the last ones that aren't
        bool given = false;           ///< has been set or bound
    };
    void find_inputs();
    Input* find(std::string_view name) const;
    Input* used(std::string_view name) const;  ///< the same; null only where that is passed over

    GLuint name_ = 0;
    // What the program's object holds is not this handle's.
    mutable std::vector<Input> inputs_;
    mutable std::vector<GLuint> textures_, buffers_;  ///< by unit
    std::string file_;
    Defines defines_;
};

}  // namespace radiafit
