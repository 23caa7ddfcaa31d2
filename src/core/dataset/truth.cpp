#include "dataset/truth.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file.h"
#include "base/json.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "dataset/value_file.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* truth_format = "radiafit-truth";
constexpr int truth_version = 1;
using TruthParameters = decltype(ReflectanceTruth::parameters)::value_type;

[[noreturn]] void throw_damaged_truth(const fs::path& file, const std::string& what) {
    throw UserError(fmt::format("{}: {}; {}", file.string(), what,
                                at_command_line("run radiafit generate again", "make the dataset again")));
}

size_t count_in(const Json& json, const char* key, uint64_t most, const fs::path& file) {
    const Json& value = json.at(key);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > most)
        throw_damaged_truth(file, fmt::format("\"{}\" is no whole number from 0 to {}", key, most));
    return value.get<size_t>();
}

template <class T>
void write_all(const std::vector<T>& values, const fs::path& file) {
    OutputFile out(file);
    out.write(values.data(), values.size() * sizeof(T));
    out.close();
}

}  // namespace

void write_truth(const ReflectanceTruth& truth, const fs::path& folder) {
    if (truth.material.size() != truth.parameters.size())
        throw std::logic_error("write_truth takes one material and one set of parameters per texel");
    Json materials = Json::array();
    for (const TruthMaterial& m : truth.materials)
        materials.push_back({{"name", m.name}, {"model", m.model}, {"parameters", m.parameters}});
    const Json json = {{"format", truth_format},          {"version", truth_version}, {"side", truth.side},
                       {"texels", truth.material.size()}, {"exact", truth.exact},     {"materials", materials}};
    write_all(truth.parameters, folder / truth_parameters_name);
    write_all(truth.material, folder / truth_material_name);
    write_file(folder / truth_json_name, json_text(json, 2) + "\n");
}

bool has_truth(const Dataset& dataset) {
    return dataset.checksums.contains(std::string(truth_json_name)) || path_exists(dataset.folder / truth_json_name);
}

ReflectanceTruth read_truth(const fs::path& folder) {
    const fs::path file = folder / truth_json_name;
    ReflectanceTruth truth;
    size_t texels = 0;
    try {
        const Json json = parse_json<Json>(read_file(file, "truth"));
        if (json.at("format") != truth_format || json.at("version") != truth_version)
            throw_damaged_truth(file, fmt::format("not a {} of version {}", truth_format, truth_version));
        truth.side = static_cast<int>(count_in(json, "side", 64, file));
        truth.exact = json.at("exact").get<bool>();
        texels = count_in(json, "texels", std::numeric_limits<uint32_t>::max(), file);
        for (const Json& m : json.at("materials")) {
            truth.materials.push_back({m.at("name").get<std::string>(), m.at("model").get<std::string>(),
                                       m.at("parameters").get<std::vector<std::string>>()});
            if (truth.materials.back().parameters.size() > std::tuple_size_v<TruthParameters>)
                throw_damaged_truth(
                    file, fmt::format("material {} has more parameters than a texel", truth.materials.size() - 1));
        }
    } catch (const Json::exception&) {
        throw_damaged_truth(file, "a field is missing or of another type, or the text is no JSON");
    }
    const std::string whose = fmt::format("{} texels", texels);
    truth.parameters = read_values<TruthParameters>(folder / truth_parameters_name, texels, whose, throw_damaged_truth);
    truth.material = read_values<uint8_t>(folder / truth_material_name, texels, whose, throw_damaged_truth);
    for (const uint8_t m : truth.material)
        if (m >= truth.materials.size())
            throw_damaged_truth(folder / truth_material_name,
                                fmt::format("material {} of {}", m, truth.materials.size()));
    return truth;
}

}  // namespace radiafit
