#pragma once
#include <filesystem>
#include <string>

#include "model/texel_model.h"

/// Texel-local models that come as a text (docs/texel-models.md) while the program runs: compiled by this machine's
/// compiler for the CPU (base/compiled_library.h), by the driver's for OpenGL.
namespace radiafit::fits {

inline constexpr const char* model_text_name = "model.glsl";  ///< in a fit's folder

/// Whether a model is named by its text's file.
bool is_model_file(const std::string& model);

struct LoadedModel {
    const TexelModel* model = nullptr;  ///< named as its file, without ".glsl"
    double compile_s = 0;               ///< 0: it was compiled before
};

/// Of a text that the user names. From then on find_texel_model() has it. Throws UserError: what is wrong with the
/// text or its name; no compiler; another text was loaded by this name.
LoadedModel load_model(const std::filesystem::path& file);
/// Of a fit's folder, with the name that the fit has it by. trusted: compile it where it never was; else a stranger's
/// text is not made a part of this program: UserError with what to do. Nothing where the fit has no text.
LoadedModel load_model_of_fit(const std::filesystem::path& folder, const std::string& name, bool trusted);

/// The text of a model that was loaded; empty: of any other.
std::string text_of_model(const std::string& name);

}  // namespace radiafit::fits
