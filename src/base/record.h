#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"

/// Where a result comes from: enough to run it again elsewhere, and nothing about the host's name or its user.
namespace radiafit {

/// Keys with JSON texts as values, in the order they are written.
using JsonFields = std::vector<std::pair<std::string, std::string>>;

struct Record {
    std::string program;                             ///< base name only
    std::vector<std::string> arguments;              ///< as given
    std::string utc;                                 ///< "2003-07-27T12:00:00Z", when the record was made
    std::string git_revision;                        ///< 12 digits, "-dirty" if files differ from it, or "unknown"
    std::string version;                             ///< of the project
    std::string compiler;                            ///< name, version and optimization flags
    std::string cpu;                                 ///< model name, or "unknown"
    int cores = 0;                                   ///< that this process may run on
    int threads = 0;                                 ///< of parallel_for
    std::string gl_vendor, gl_renderer, gl_version;  ///< set by the caller; empty if no GL was used
    JsonFields config;                               ///< Config::resolved()
    JsonFields more;                                 ///< whatever else the caller knows: peaks, dataset, …
    Stopwatch watch;                                 ///< since the record was made
};

/// All that can be known without a caller. Call set_thread_count first.
Record make_record(int argc, const char* const* argv);

/// One indented JSON object. GL fields are left out when empty.
std::string record_json(const Record& record);

/// `text` as a JSON string, for JsonFields.
std::string json_string(const std::string& text);

std::string git_revision();
/// "2003-07-27T12:00:00Z"; compact is "20030727T120000Z", for names.
std::string utc_now();
std::string utc_now_compact();

}  // namespace radiafit
