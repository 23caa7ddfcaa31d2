#include "fitting/problem_folder.h"

#include <nlohmann/json.hpp>

namespace radiafit::fits {
namespace {

using Json = nlohmann::ordered_json;

Json object_of(const JsonFields& fields) {
    Json object = Json::object();
    for (const auto& [key, text] : fields) object[key] = Json::parse(text);
    return object;
}

}  // namespace

ProblemFolder::ProblemFolder(const std::filesystem::path& target, const std::string& format)
    : folder_(target), format_(format) {}

void ProblemFolder::note(const std::string& name, const char* type, const std::vector<uint64_t>& shape,
                         const char* meaning) {
    arrays_.emplace_back(name, Json{{"dtype", type}, {"shape", shape}, {"meaning", meaning}}.dump());
}

void ProblemFolder::describe_dataset(const std::string& name, const DatasetFingerprint& f) {
    const Json about = {
        {"name", name},     {"digest", f.digest},     {"vertices", f.vertices},      {"triangles", f.triangles},
        {"views", f.views}, {"held_out", f.held_out}, {"image_bytes", f.image_bytes}};
    tell("dataset", about.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void ProblemFolder::describe_views(const std::vector<uint32_t>& training, const std::vector<uint32_t>& held_out) {
    tell("views", Json{{"training", training}, {"held_out", held_out}}.dump());
}

void ProblemFolder::commit(const Record& record) {
    Json json = {{"format", format_}, {"version", problem_folder_version}, {"byte_order", "little"}};
    json.update(object_of(entries_));
    json["arrays"] = object_of(arrays_);
    json["provenance"] = Json::parse(record_json(record));
    const std::string name = format_.substr(format_.rfind('-') + 1) + ".json";
    write_file(folder_.path() / name, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    folder_.commit();
}

}  // namespace radiafit::fits
