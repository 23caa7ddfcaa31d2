#include "base/output_claims.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/json.h"
#include "base/leftovers.h"
#include "base/printable.h"
#include "base/wording.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Of the command that is running: set before any writer begins, so that threads only read it.
OutputClaims* current = nullptr;

/// An empty folder is as good as none, and so is a link to nothing.
bool holds_something(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::exists(status) && !(fs::is_directory(status) && fs::is_empty(path, error));
}

/// The whole command line that a folder's JSON keeps as its provenance (record.h); empty where none does.
std::string command_line_in(const fs::path& folder) {
    constexpr uintmax_t most = 16 << 20;  // of what is read: provenance stands in small files
    std::error_code error;
    std::vector<fs::path> files;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (at->path().extension() == ".json" && at->path().filename() != made_by_name && at->is_regular_file(error) &&
            at->file_size(error) <= most)
            files.push_back(at->path());
    std::ranges::sort(files);
    for (const fs::path& file : files) {
        std::ifstream stream(file, std::ios::binary);
        const Json json = parse_json<Json>(std::string(std::istreambuf_iterator<char>(stream), {}));
        if (!json.is_object()) continue;
        const Json provenance = json.value("provenance", Json());
        if (!provenance.is_object() || !provenance.value("arguments", Json()).is_array()) continue;
        const Json program = provenance.value("program", Json());
        std::string line = program.is_string() ? program.get<std::string>() : "radiafit";
        for (const Json& argument : provenance["arguments"])
            if (argument.is_string()) line += " " + argument.get<std::string>();
        return printable(line);
    }
    return "";
}

/// "made by `radiafit fit star`", in as many words as can be known.
std::string maker_of(const fs::path& output, const std::optional<MadeBy>& made, const MadeBy& now) {
    if (made == now) return "made by this command, but changed since";
    const std::string line = command_line_in(output);
    if (line.empty() && !made) return "and nothing says which command made it";
    const std::string maker = line.empty() ? "radiafit " + printable(made->command) : "`" + line + "`";
    const bool alike = made && made->command == now.command;
    return fmt::format("made by {}{}", maker, alike ? ", with other options or of another input" : "");
}

[[noreturn]] void refuse(const fs::path& output, const MadeBy& now) {
    throw UserError(fmt::format("{}: is there already, {}; {} puts this one in its place, or choose another name",
                                output.string(), maker_of(output, made_by(output), now), option_name("replace")));
}

/// What --replace leaves alone, too.
[[noreturn]] void refuse_foreign(const fs::path& output, const MadeBy& now) {
    throw UserError(
        fmt::format("{}: is there already, {}; radiafit {} replaces only what it made: remove it or choose "
                    "another name",
                    output.string(), maker_of(output, made_by(output), now), now.command));
}

}  // namespace

OutputClaims::OutputClaims(std::vector<OutputTarget> targets, MadeBy made, bool replace)
    : made_(std::move(made)), replace_(replace) {
    for (OutputTarget& target : targets) {
        Claim claim{std::move(target), "", nullptr, false, false};
        claim.place = place_of(claim.target.path);
        if (claim.target.lock) claim.lock = std::make_unique<OutputLock>(claim.target.path);
        claims_.push_back(std::move(claim));
    }
    for (Claim& claim : claims_) look_at(claim);
    current = this;
}

OutputClaims::~OutputClaims() {
    if (current == this) current = nullptr;
}

void OutputClaims::look_at(Claim& claim) const {
    const OutputTarget& target = claim.target;
    if (target.resumed) return;
    if (target.files.empty()) restore_interrupted(target.path);
    std::vector<fs::path> files = target.files.empty() ? std::vector{target.path} : target.files;
    const size_t wanted = files.size();
    std::erase_if(files, [](const fs::path& file) { return !holds_something(file); });
    claim.there = !files.empty();
    if (!claim.there) return;
    if (target.check) target.check();
    std::vector<std::optional<MadeBy>> makers;
    for (const fs::path& file : files) makers.push_back(made_by(file));
    std::error_code error;
    const bool same = std::ranges::count(makers, std::optional(made_)) > 0 &&
                      std::ranges::all_of(makers, [&](const auto& maker) { return !maker || *maker == made_; });
    const bool whole = files.size() == wanted &&
                       (!fs::is_directory(target.path, error) || !target.files.empty() || as_it_was_made(target.path));
    claim.done = same && whole && !replace_;
    if (claim.done) return;
    // Of several files, one that tells its maker.
    const auto told = std::ranges::find_if(makers, [](const auto& maker) { return maker.has_value(); });
    const fs::path& found = told == makers.end() ? files.front() : files[size_t(told - makers.begin())];
    const bool of_this_command =
        std::ranges::all_of(makers, [&](const auto& maker) { return maker && maker->command == made_.command; });
    if (target.shared) {  // its writer asks for each file
        if (makers.front() && !of_this_command) refuse_foreign(target.path, made_);
        if (makers.front() && !replace_) refuse(target.path, made_);
        return;
    }
    if (!target.check && !of_this_command) refuse_foreign(found, made_);
    if (!replace_) refuse(found, made_);
}

bool OutputClaims::done() const {
    return !claims_.empty() && std::ranges::all_of(claims_, [](const Claim& claim) { return claim.done; });
}

std::string OutputClaims::names() const {
    std::vector<std::string> names;
    for (const Claim& claim : claims_) names.push_back(claim.target.path.string());
    return fmt::format("{}", fmt::join(names, ", "));
}

bool may_replace_folder(const fs::path& folder) {
    if (!current) return false;
    const std::string place = place_of(folder);
    std::error_code error;
    return std::ranges::any_of(current->claims_, [&](const OutputClaims::Claim& claim) {
        return claim.place == place && (claim.there || fs::is_empty(folder, error));
    });
}

void mark_output(const fs::path& unfinished, const fs::path& target) {
    if (!current) return;
    const std::string place = place_of(target);
    if (std::ranges::any_of(current->claims_, [&](const OutputClaims::Claim& claim) {
            return claim.place == place && claim.target.files.empty();
        }))
        write_made_by(unfinished, current->made_);
}

void require_replaceable(const fs::path& file) {
    if (!current || current->replace_ || !holds_something(file)) return;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    const bool ours =
        made_by(file) == current->made_ || (made_by(folder) == current->made_ && is_listed(folder, file.filename()));
    if (!ours) refuse(file, current->made_);
}

std::string made_by_remark() { return current ? made_by_word(current->made_) : ""; }

}  // namespace radiafit
