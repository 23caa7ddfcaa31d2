#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// What fuzzing runs: every reader of the program, called as the program calls it. A target is a folder of files of
/// which one holds any bytes. To add one, put it into the list of the file that has the like, or write a new file and
/// name its list in targets.cpp and CMakeLists.txt.
namespace radiafit::fuzz {

namespace fs = std::filesystem;

struct Target {
    std::string name;
    std::string file;  ///< the one that is replaced, relative to the folder
    /// Fills the folder with what else the reader needs; returns texts of the file that read() takes.
    std::function<std::vector<std::string>(const fs::path& folder)> seeds;
    /// Reads as the program does; may put checksums right before, which would hide what lies behind them. Throws
    /// UserError for what is refused; anything else that it throws is a finding.
    std::function<void(const fs::path& folder)> read;
};

/// All of them, in layer order.
std::vector<Target> targets();

/// A target with its folder, which lies in memory where the machine has a place for that.
class Bench {
public:
    explicit Bench(Target target);
    ~Bench();
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    const std::vector<std::string>& seeds() const { return seeds_; }
    /// False if the reader refused the bytes with a UserError; throws what else comes out of it.
    bool read(const std::string& bytes) const;

private:
    Target target_;
    fs::path folder_;
    std::vector<std::string> seeds_;
};

// For targets: whole files.
std::string bytes_of(const fs::path& file);
void put_bytes(const fs::path& file, const std::string& bytes);

}  // namespace radiafit::fuzz
