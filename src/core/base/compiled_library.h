#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/embedded_text.h"

namespace radiafit {

/// What a compiler calls the part of a source that a user wrote: after `#line 1 "model.glsl"`.
inline constexpr const char* users_text_name = "model.glsl";

struct LibrarySource {
    std::string name;                         ///< of the user's text, in messages
    std::string text;                         ///< C++
    std::vector<std::string> flags;           ///< of the compiler
    std::vector<EmbeddedText> files;          ///< that it includes
    std::vector<std::string> folders;         ///< of these: where the compiler looks
    std::vector<std::string> libraries = {};  ///< that it is linked against
};

/// A shared library, made by this machine's C++ compiler. What was compiled once is kept in compiled_models_folder()
/// and taken from there.
class CompiledLibrary {
public:
    /// Throws UserError: there is no compiler; what it says of the text, "NAME:LINE: ..."; one of `libraries` is
    /// missing; the library calls functions that this program does not export.
    explicit CompiledLibrary(const LibrarySource& source);
    ~CompiledLibrary();
    CompiledLibrary(const CompiledLibrary&) = delete;
    CompiledLibrary& operator=(const CompiledLibrary&) = delete;

    template <class Function>
    Function* find(const char* name) const {
        return reinterpret_cast<Function*>(symbol(name));
    }
    double seconds() const { return seconds_; }  ///< that compiling took; 0: it was there

private:
    void* symbol(const char* name) const;

    void* library_ = nullptr;
    double seconds_ = 0;
};

/// The shared library that this code is a part of, such as Python's module; empty: the program itself. A compiled
/// library that calls its functions is linked against it.
std::filesystem::path surrounding_library();

/// Texts whose code this user has let become a part of a program here: kept whole beside the compiled models, and
/// compared byte by byte.
bool is_trusted(const std::string& text);
void trust(const std::string& text);

/// $XDG_CACHE_HOME/radiafit/models or ~/.cache/radiafit/models; without a home, one of this user's own below the folder
/// for temporary files. Throws UserError where that one is somebody else's.
std::filesystem::path compiled_models_folder();

}  // namespace radiafit
