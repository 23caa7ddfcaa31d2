#pragma once
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES  // declarations only, for their types: no entry point is ever linked
#endif
#include <GL/glcorearb.h>

#include <string>

/// Every OpenGL entry point this project calls, loaded through the library that made the context: one table per
/// context, so that an EGL and an OSMesa context live side by side in one process.
namespace radiafit {

// clang-format off
#define RADIAFIT_GL_FUNCTIONS(X) \
    /* state */ \
    X(BlendEquation) X(BlendFunc) X(ClipControl) X(DepthFunc) X(DepthMask) X(Disable) \
    X(Enable) X(Enablei) X(Finish) X(FrontFace) X(GetError) X(GetGraphicsResetStatus) X(GetIntegerv) X(GetInteger64v) \
    X(GetString) X(GetStringi) X(PixelStorei) X(Scissor) X(TextureBarrier) X(Viewport) \
    /* textures */ \
    X(BindTextureUnit) X(ClearTexImage) X(CreateTextures) X(DeleteTextures) \
    X(GetTextureLevelParameteriv) X(GetTextureParameteriv) X(GetTextureSubImage) X(IsTexture) X(TextureBuffer) X(TextureParameteri) X(TextureStorage2D) \
    X(TextureStorage3D) X(TextureSubImage2D) X(TextureSubImage3D) \
    /* framebuffers */ \
    X(BindFramebuffer) X(CheckNamedFramebufferStatus) X(ClearNamedFramebufferfv) \
    X(ClearNamedFramebufferuiv) X(CreateFramebuffers) X(DeleteFramebuffers) X(NamedFramebufferDrawBuffers) \
    X(NamedFramebufferTexture) X(NamedFramebufferTextureLayer) \
    /* buffers and vertex arrays */ \
    X(BindVertexArray) \
    X(BindBuffer) X(BindBufferBase) X(ClearNamedBufferData) X(CopyNamedBufferSubData) X(CreateBuffers) X(CreateVertexArrays) X(DeleteBuffers) X(DeleteVertexArrays) \
    X(EnableVertexArrayAttrib) X(GetNamedBufferParameteri64v) X(InvalidateBufferData) X(GetNamedBufferSubData) X(IsBuffer) \
    X(MapNamedBufferRange) X(NamedBufferStorage) X(NamedBufferSubData) X(UnmapNamedBuffer) \
    X(VertexArrayAttribBinding) X(VertexArrayAttribFormat) X(VertexArrayAttribIFormat) \
    X(VertexArrayBindingDivisor) X(VertexArrayElementBuffer) X(VertexArrayVertexBuffer) \
    /* programs */ \
    X(AttachShader) X(CompileShader) X(CreateProgram) X(CreateShader) X(DeleteProgram) X(DeleteShader) X(DetachShader) \
    X(GetProgramInfoLog) X(GetProgramInterfaceiv) X(GetProgramResourceName) X(GetProgramResourceiv) X(GetProgramiv) \
    X(GetShaderInfoLog) X(GetShaderiv) X(LinkProgram) X(ProgramUniform1f) X(ProgramUniform1iv) X(ProgramUniform2f) \
    X(ProgramUniform4fv) X(ShaderSource) X(UseProgram) \
    /* drawing */ \
    X(DrawArrays) X(DrawElements) \
    /* compute */ \
    X(DispatchCompute) X(MemoryBarrier) X(ShaderStorageBlockBinding) \
    /* queries, synchronization, debugging */ \
    X(BeginQuery) X(ClientWaitSync) X(DebugMessageCallback) X(DeleteQueries) X(DeleteSync) \
    X(EndQuery) X(FenceSync) X(GenQueries) X(GetQueryObjectui64v)
// clang-format on

namespace detail {
extern thread_local bool check_gl_calls;  ///< set while a debugging context is current
void after_gl_call(const char* name);     ///< throws SystemError that quotes the call if it failed
}  // namespace detail

/// One entry point. While a debugging context is current, a failing call throws a SystemError that quotes it.
template <class Pointer>
struct GlEntry;
template <class Result, class... Args>
struct GlEntry<Result (*)(Args...)> {
    Result (*pointer)(Args...) = nullptr;
    const char* name = "";

    Result operator()(Args... args) const {
        if (!detail::check_gl_calls) return pointer(args...);
        if constexpr (std::is_void_v<Result>) {
            pointer(args...);
            detail::after_gl_call(name);
        } else {
            Result result = pointer(args...);
            detail::after_gl_call(name);
            return result;
        }
    }
};

struct GlFunctions {
#define RADIAFIT_GL_MEMBER(name) GlEntry<decltype(&::gl##name)> name;
    RADIAFIT_GL_FUNCTIONS(RADIAFIT_GL_MEMBER)
#undef RADIAFIT_GL_MEMBER

    /// Resolves every name. Throws SystemError that names the first one `library` doesn't have.
    void load(void* (*resolve)(const char* name), const std::string& library);
};

/// The table of the context that is current on this thread. Throws SystemError if there is none.
const GlFunctions& gl();

}  // namespace radiafit
