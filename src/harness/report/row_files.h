#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/csv.h"
#include "report/finished_runs.h"

/// A run's files as it wrote them: run.json has the length and the CRC-32 (zlib's) of each. A file may have been packed
/// by gzip since, NAME.gz instead of NAME; it reads as if it had not.
namespace radiafit::harness {

/// A JSON object, by file name: {"bytes": 120, "crc32": "89abcdef"}; of all regular files in the folder but run.json.
std::string file_list_json(const std::filesystem::path& folder);

/// Whether the run has the file, packed or not.
bool has_run_file(const RunRecord& run, const std::string& name);
/// The names of the files in a run's folder but run.json, without ".gz", in order.
std::vector<std::string> run_files(const std::filesystem::path& folder);

/// A file's bytes, unpacked. Throws UserError for one that is missing, can't be unpacked, or isn't what run.json says:
/// cut, altered, or not of this run. Where run.json has no list, files are taken as they are.
std::string read_run_file(const RunRecord& run, const std::string& name);
CsvTable read_rows(const RunRecord& run, const std::string& name);

}  // namespace radiafit::harness
