#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/machine.h"

/// Where a result comes from: enough to run it again elsewhere, and nothing about the host's name or its user.
namespace radiafit {

/// Keys with JSON texts as values, in the order they are written.
using JsonFields = std::vector<std::pair<std::string, std::string>>;

struct Record {
    std::string program;                             ///< base name only
    std::vector<std::string> arguments;              ///< as given
    std::string utc_start;                           ///< "2003-07-27T12:00:00Z", when the record was made
    std::string git_revision;                        ///< 12 digits, "-dirty" if files differ from it, or "unknown"
    std::string version;                             ///< of the project
    std::string compiler;                            ///< name, version and optimization flags
    std::string cpu;                                 ///< model name, or "unknown"
    Machine machine;                                 ///< when the record was made
    int cores = 0;                                   ///< that this process may run on
    int threads = 0;                                 ///< of parallel_for
    std::string gl_vendor, gl_renderer, gl_version;  ///< set by the caller; empty if no GL was used
    JsonFields config;                               ///< Config::resolved()
    JsonFields more;                                 ///< whatever else the caller knows: peaks, times, …
    /// JSON objects, one for each dataset that the run read. Copies of a record share them: a run opens datasets after
    /// its result folder, too.
    std::shared_ptr<std::vector<std::string>> datasets = std::make_shared<std::vector<std::string>>();
    Stopwatch watch;  ///< since the record was made
};

/// All that can be known without a caller, when a run begins. Call set_thread_count first.
Record make_record(int argc, const char* const* argv);

/// One indented JSON object, made when the run ends: "utc_end" is now, and "loaded" names the shared libraries that the
/// process has loaded by now. GL fields are left out when empty; docs/formats.md has all fields.
std::string record_json(const Record& record);

/// `text` as a JSON string, for JsonFields.
std::string json_string(const std::string& text);

std::string git_revision();
std::string project_version();
/// "2003-07-27T12:00:00Z".
std::string utc_now();
/// utc_now()'s text as "20030727T120000Z": for names.
std::string compact_utc(const std::string& utc);

}  // namespace radiafit
