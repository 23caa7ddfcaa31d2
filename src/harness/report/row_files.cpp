#include "report/row_files.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/read_file.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json description(const std::string& bytes) {
    const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return {{"bytes", bytes.size()}, {"crc32", fmt::format("{:08x}", crc)}};
}

fs::path packed(const fs::path& file) { return file.string() + ".gz"; }

std::string unpacked(const fs::path& file) {
    check_readable(file, "file of rows");
    const std::unique_ptr<gzFile_s, decltype(&gzclose)> stream(gzopen(file.c_str(), "rb"), &gzclose);
    std::string bytes;
    std::vector<char> part(size_t(1) << 16);
    int read = stream ? 1 : -1;
    while (read > 0) {
        read = gzread(stream.get(), part.data(), unsigned(part.size()));
        if (read > 0) bytes.append(part.data(), size_t(read));
        constexpr size_t limit = size_t(1) << 30;
        if (bytes.size() > limit) throw UserError(fmt::format("{}: more than 1 GiB of rows; remake it", file.string()));
    }
    if (read < 0 || !gzeof(stream.get()))
        throw UserError(fmt::format("{}: cannot be unpacked by gzip; remake it", file.string()));
    return bytes;
}

}  // namespace

std::string file_list_json(const fs::path& folder) {
    Json files = Json::object();
    for (const std::string& name : run_files(folder))
        files[name] = description(read_file(folder / name, "file of rows"));
    return json_text(files);
}

bool has_run_file(const RunRecord& run, const std::string& name) {
    return fs::exists(run.folder / name) || fs::exists(packed(run.folder / name));
}

std::vector<std::string> run_files(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        std::string name = entry.path().filename().string();
        if (!entry.is_regular_file() || name == run_record_name) continue;
        if (name.ends_with(".gz")) name.resize(name.size() - 3);
        names.push_back(std::move(name));
    }
    std::ranges::sort(names);
    return names;
}

std::string read_run_file(const RunRecord& run, const std::string& name) {
    const fs::path file = run.folder / name;
    if (!has_run_file(run, name))
        throw UserError(fmt::format("{}: no such file; run the experiment again", file.string()));
    std::string bytes = fs::exists(file) ? read_file(file, "file of rows") : unpacked(packed(file));
    const auto known = run.files.find(name);
    if (!run.files.empty() && (known == run.files.end() || known->second != json_text(description(bytes))))
        throw UserError(fmt::format(
            "{}: not as the run wrote it, by its checksum in run.json; run the experiment again", file.string()));
    return bytes;
}

CsvTable read_rows(const RunRecord& run, const std::string& name) {
    return CsvTable(run.folder / name, read_run_file(run, name));
}

}  // namespace radiafit::harness
