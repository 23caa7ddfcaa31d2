#include "report/result_folder.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

std::unique_ptr<AtomicFolder> open_folder(const fs::path& root, const std::string& experiment,
                                          const std::string& device, const Record& record) {
    const fs::path parent = root / experiment / slug(device);
    const std::string name = fmt::format("{}-{}", compact_utc(record.utc_start), record.git_revision);
    fs::path target = parent / name;
    for (int i = 2; fs::exists(target); i++) target = parent / fmt::format("{}-{}", name, i);  // within one second
    return std::make_unique<AtomicFolder>(target);
}

}  // namespace

std::string slug(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        if ((lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9'))
            result += lower;
        else if (!result.empty() && result.back() != '-')
            result += '-';
    }
    if (result.ends_with('-')) result.pop_back();
    return result.empty() ? "unknown" : result;
}

ResultFolder::ResultFolder(const fs::path& root, const std::string& experiment, const std::string& device,
                           Record record)
    : folder_(open_folder(root, experiment, device, record)), record_(std::move(record)) {}

ResultFolder::~ResultFolder() = default;
ResultFolder::ResultFolder(ResultFolder&&) noexcept = default;
ResultFolder& ResultFolder::operator=(ResultFolder&&) noexcept = default;

const fs::path& ResultFolder::path() const { return committed_ ? folder_->target() : folder_->path(); }

void ResultFolder::commit() {
    Record record = record_;
    record.more.emplace_back("wall_s", fmt::format("{:.3f}", record.watch.wall_s()));
    record.more.emplace_back("cpu_s", fmt::format("{:.3f}", record.watch.cpu_s()));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    record.more.emplace_back("peak_memory_bytes", std::to_string(1024 * uint64_t(usage.ru_maxrss)));
    record.more.emplace_back("files", file_list_json(folder_->path()));
    write_file(folder_->path() / "run.json", record_json(record));
    folder_->commit();
    committed_ = true;
}

std::vector<fs::path> folders_in(const fs::path& folder) {
    std::vector<fs::path> result;
    if (!fs::is_directory(folder)) return result;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.is_directory() && !entry.path().filename().string().starts_with('.')) result.push_back(entry.path());
    std::ranges::sort(result);
    return result;
}

}  // namespace radiafit::harness
