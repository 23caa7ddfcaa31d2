#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/npy_file.h"
#include "base/record.h"
#include "base/rings.h"
#include "fit/fit_folder.h"

namespace radiafit::fits {

inline constexpr int problem_folder_version = 1;  ///< of the JSON file: "version"

/// Arrays for other people's solvers, and a JSON file that describes them: the PROBLEMS folder of docs/problems.md, or
/// PARAMETERS. Written under a temporary name until commit(); a folder of the name that is there already is refused.
class ProblemFolder {
public:
    /// `format`: "radiafit-problems", say; the JSON file's name is its last word. Throws UserError as AtomicFolder
    /// does.
    ProblemFolder(const std::filesystem::path& target, const std::string& format);

    /// Opens NAME.npy, and notes what it is.
    template <class T>
    NpyFile<T> open(const std::string& name, const std::vector<uint64_t>& shape, const char* meaning) {
        note(name, npy_type<T>(), shape, meaning);
        return NpyFile<T>(folder_.path() / (name + ".npy"), shape);
    }
    template <class T>
    void write(const std::string& name, const std::vector<uint64_t>& shape, const std::vector<T>& elements,
               const char* meaning) {
        auto file = open<T>(name, shape, meaning);
        file.write(elements);
        file.close();
    }
    /// For further files.
    const std::filesystem::path& path() const { return folder_.path(); }
    /// An entry of the JSON file: its key and its value as JSON.
    void tell(const std::string& key, const std::string& json) { entries_.emplace_back(key, json); }
    /// The entry "dataset".
    void describe_dataset(const std::string& name, const DatasetFingerprint& fingerprint);
    /// The entry "views": which of the dataset's are fitted, and by which a solution is judged.
    void describe_views(const std::vector<uint32_t>& training, const std::vector<uint32_t>& held_out);
    /// Writes the JSON file, the record in it as "provenance", and gives the folder its name.
    void commit(const Record& record);

private:
    void note(const std::string& name, const char* type, const std::vector<uint64_t>& shape, const char* meaning);

    AtomicFolder folder_;
    std::string format_;
    JsonFields entries_, arrays_;
};

}  // namespace radiafit::fits
