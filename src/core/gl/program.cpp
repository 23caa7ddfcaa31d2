#include "gl/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "base/error.h"

namespace radiafit {
namespace {

// "2:17(5): error" (Mesa) and "2(17) : error" (NVIDIA) get the file's name in place of its number.
std::string name_files(const std::string& log, const std::vector<std::string>& files) {
    static const std::regex place("^([0-9]+)([:(][0-9]+)");
    std::istringstream stream(log);
    std::string line, result;
    while (std::getline(stream, line)) {
        std::smatch match;
        if (std::regex_search(line, match, place) && std::stoul(match[1]) < files.size())
            line = files[std::stoul(match[1])] + match[2].str() + match.suffix().str();
        result += "\n  " + line;
    }
    return result;
}

GLuint compile(GLenum stage, const std::string& file, const Defines& defines) {
    const ShaderText shader_text = expand_shader(file, defines);
    const GLuint shader = gl().CreateShader(stage);
    const char* text = shader_text.text.c_str();
    gl().ShaderSource(shader, 1, &text, nullptr);
    gl().CompileShader(shader);
    int compiled = 0, length = 0;
    gl().GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    gl().GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), 0);
    gl().GetShaderInfoLog(shader, length, &length, log.data());
    log.resize(static_cast<size_t>(length));
    gl().DeleteShader(shader);
    throw SystemError("glCompileShader failed:" + name_files(log, shader_text.files));
}

GLuint link(std::initializer_list<GLuint> shaders, const std::string& what) {
    const GLuint program = gl().CreateProgram();
    for (GLuint shader : shaders) gl().AttachShader(program, shader);
    gl().LinkProgram(program);
    for (GLuint shader : shaders) {
        gl().DetachShader(program, shader);
        gl().DeleteShader(shader);
    }
    int linked = 0, length = 0;
    gl().GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) return program;
    gl().GetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), 0);
    gl().GetProgramInfoLog(program, length, &length, log.data());
    log.resize(static_cast<size_t>(length));
    gl().DeleteProgram(program);
    throw SystemError(fmt::format("glLinkProgram failed for {}: {}", what, log));
}

}  // namespace

Program Program::draw(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines) {
    Program program;
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_file, defines);
    const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_file, defines);
    program.name_ = link({vertex, fragment}, vertex_file + " and " + fragment_file);
    program.find_inputs();
    program.file_ = fragment_file;
    program.defines_ = defines;
    return program;
}

Program Program::compute(const std::string& file, const Defines& defines) {
    Program program;
    program.name_ = link({compile(GL_COMPUTE_SHADER, file, defines)}, file);
    program.find_inputs();
    program.file_ = file;
    program.defines_ = defines;
    return program;
}

// Gives samplers their units, one after another, and storage blocks theirs.
void Program::find_inputs() {
    constexpr GLenum plain[] = {GL_FLOAT, GL_FLOAT_VEC2, GL_FLOAT_VEC4, GL_INT};  // all others are samplers
    constexpr GLenum properties[] = {GL_LOCATION, GL_TYPE, GL_ARRAY_SIZE};
    int count = 0;
    gl().GetProgramInterfaceiv(name_, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
    for (GLuint i = 0; i < GLuint(count); ++i) {
        int values[3] = {};
        char name[64];
        gl().GetProgramResourceiv(name_, GL_UNIFORM, i, 3, properties, 3, nullptr, values);
        gl().GetProgramResourceName(name_, GL_UNIFORM, i, sizeof name, nullptr, name);
        Input input{std::string(name, std::strcspn(name, "[")), values[0]};
        if (std::ranges::find(plain, GLenum(values[1])) == std::end(plain)) {
            input.unit = int(textures_.size());
            std::vector<int> units(static_cast<size_t>(values[2]));
            input.count = units.size();
            textures_.resize(textures_.size() + units.size());
            std::iota(units.begin(), units.end(), input.unit);
            gl().ProgramUniform1iv(name_, input.location, values[2], units.data());
        }
        inputs_.push_back(std::move(input));
    }
    gl().GetProgramInterfaceiv(name_, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
    buffers_.resize(size_t(count));
    for (GLuint i = 0; i < GLuint(count); ++i) {
        char name[64];
        gl().GetProgramResourceName(name_, GL_SHADER_STORAGE_BLOCK, i, sizeof name, nullptr, name);
        inputs_.push_back({.name = name, .unit = int(i)});
        gl().ShaderStorageBlockBinding(name_, i, i);
    }
}

Program::Input* Program::find(std::string_view name) const {
    const auto found = std::ranges::find(inputs_, name, &Input::name);
    return found == inputs_.end() ? nullptr : &*found;
}

Program::Input* Program::used(std::string_view name) const {
    Input* input = find(name);
    if (!input && detail::check_gl_calls) throw std::logic_error(fmt::format("{} uses no {}", file_, name));
    if (input) input->given = true;
    return input;
}

void Program::set(std::string_view uniform, float value) const {
    if (const Input* input = used(uniform)) gl().ProgramUniform1f(name_, input->location, value);
}

void Program::set(std::string_view uniform, float x, float y) const {
    if (const Input* input = used(uniform)) gl().ProgramUniform2f(name_, input->location, x, y);
}

void Program::set(std::string_view uniform, std::span<const int> values) const {
    if (const Input* input = used(uniform))
        gl().ProgramUniform1iv(name_, input->location, GLsizei(values.size()), values.data());
}

void Program::set(std::string_view uniform, std::span<const float> vec4s) const {
    if (const Input* input = used(uniform))
        gl().ProgramUniform4fv(name_, input->location, GLsizei(vec4s.size() / 4), vec4s.data());
}

void Program::bind(std::string_view sampler, const Texture& texture, size_t index) const {
    const Input* input = used(sampler);
    if (input && index < input->count) textures_.at(size_t(input->unit) + index) = texture.name();
}

void Program::bind(std::string_view block, const Buffer& buffer) const {
    if (const Input* input = used(block)) buffers_.at(size_t(input->unit)) = buffer.name();
}

void Program::dispatch(size_t groups) const {
    constexpr size_t most = 65535;  // of a dimension, in any implementation
    use();
    const size_t rows = (groups + most - 1) / most;
    gl().DispatchCompute(GLuint(std::min(groups, most)), GLuint(rows), 1);
    gl().MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void Program::use() const {
    gl().UseProgram(name_);
    for (GLuint unit = 0; unit < buffers_.size(); ++unit)
        gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, unit, buffers_[unit]);
    for (GLuint unit = 0; unit < textures_.size(); ++unit) gl().BindTextureUnit(unit, textures_[unit]);
    if (!detail::check_gl_calls) return;
    for (const Input& input : inputs_)
        if (!input.given) throw std::logic_error(fmt::format("{} draws without its {}", file_, input.name));
}

Program::~Program() {
    if (name_) gl().DeleteProgram(name_);
}

}  // namespace radiafit
