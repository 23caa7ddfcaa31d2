#include "report/result_archive.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/program.h"
#include "base/read_file.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

constexpr const char* top = "results";

void run_tar(std::vector<std::string> arguments, const std::string& failed) {
    arguments.insert(arguments.begin(), {"tar", "--force-local"});  // "a:b.tar" is no file of another machine
    const Ended ended = run_program(std::move(arguments));
    if (ended.status == 127) throw SystemError("archives need the program tar: install it");
    if (ended.status != 0) throw UserError(fmt::format("{}: {}", failed, single_line(ended.message)));
}

}  // namespace

void write_result_archive(const fs::path& folder, const fs::path& file) {
    const UnfinishedFolder work(fs::absolute(file).parent_path(), file.filename().string());
    const fs::path packed = work.path() / file.filename();
    run_tar(
        {"--create", "--file", packed.string(), "--directory", folder.parent_path().string(), "--exclude=.radiafit-*",
         fmt::format("--transform=s,^{},{},", folder.filename().string(), top), folder.filename().string()},
        fmt::format("{} cannot be written", file.string()));
    sync_to_disk(packed);
    std::error_code failed;
    fs::rename(packed, file, failed);
    if (failed) throw UserError(fmt::format("{} cannot be written: {}", file.string(), failed.message()));
}

UnpackedResults::UnpackedResults(const fs::path& place) : folder_(place) {
    if (!fs::is_regular_file(place)) return;
    unpacked_ = std::make_unique<UnfinishedFolder>(fs::absolute(fs::temp_directory_path()), "radiafit-results");
    run_tar({"--extract", "--file", fs::absolute(place).string(), "--directory", unpacked_->path().string(),
             "--no-same-owner", "--no-same-permissions"},
            fmt::format("{} is no archive that radiafit-bench --all wrote; check the path", place.string()));
    folder_ = unpacked_->path() / top;
    if (!folder_exists(folder_))
        throw UserError(
            fmt::format("{}: no `results` in it; name an archive that radiafit-bench --all wrote", place.string()));
}

}  // namespace radiafit::harness
