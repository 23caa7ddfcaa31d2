#pragma once
#include <filesystem>
#include <string>
#include <vector>

/// A model of many small problems as its user writes it, in the language that GLSL and C++ share (docs/solve.md):
/// structs Terms, Parameters and Values of `real` members, and a function Values value(Parameters p, Terms t).
namespace radiafit::batch {

inline constexpr size_t most_terms = 64, most_parameters = 32, most_values = 4;

struct ModelText {
    std::string name;  ///< of its file, in messages
    std::string text;
    std::vector<std::string> terms, parameters, values;  ///< names of the structs' members, in order
};

/// Finds what the structs hold. Throws UserError "NAME:LINE: ..." where one is missing or is not of `real` members, or
/// has more than the numbers above.
ModelText read_model(std::string name, std::string text);
ModelText read_model_file(const std::filesystem::path& file);

}  // namespace radiafit::batch
