#pragma once
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/solvers/solve.h"

namespace radiafit::fits {

/// What a part of a fit ended with. Units are what a fit is cut into: vertices of a light field map, texels of another
/// model.
struct PartResult {
    std::vector<uint32_t> units;    ///< as the whole numbers them, ascending
    std::vector<float> parameters;  ///< a block of each unit, one after another
    // One entry per problem: a unit's three channels, or the unit.
    std::vector<Status> status;
    std::vector<uint32_t> iterations, samples;
    std::vector<float> error;
    std::vector<float> own;        ///< what else its family keeps of a part
    std::string own_json = "{}";   ///< more of the same, as JSON
    int terms = 0, view_side = 0;  ///< of a light field map: a solver may fit a smaller one than it was asked for
    std::string run_json;          ///< of the part's solver: run_to_json()
};

/// What else a run reports with its fit, as JSON; and the sum of that over several parts' runs, one after another.
std::string run_to_json(const FitRun& run, const ResamplingCounts& resampling, uint64_t samples = 0);
class RunSum {
public:
    void add(const std::string& run_json);
    FitRun run() const;
    const ResamplingCounts& resampling() const { return resampling_; }
    uint64_t samples() const { return samples_; }  ///< ReflectanceOutcome's

private:
    FitRun run_;
    TraceSum trace_;
    ResamplingCounts resampling_;
    uint64_t samples_ = 0;
};

/// Takes the basis that all parts of a fit have in common, from the first of them. described: the other way round of
/// description_of(). Throws what it throws, and std::runtime_error for a part of another basis.
template <class Basis, class Described>
void take_basis(const PartResult& part, Basis& basis, const Described& described) {
    if (basis.numbers.empty()) {
        basis = described(part.own_json);
        basis.numbers = part.own;
    }
    if (basis.numbers.size() != basis.cubes.size() * basis.block_size() || basis.numbers != part.own ||
        description_of(basis) != part.own_json)
        throw std::runtime_error("another basis");
}

/// One file, written atomically (docs/formats.md). `key`: all that decides what the result is. Throws
/// UserError when the disk is full or the folder not writable.
void write_part_result(const std::filesystem::path& file, const std::string& key, const PartResult& result);
/// The key of a file, of which only the beginning is read. Throws UserError where that is damaged.
std::string part_key(const std::filesystem::path& file);
/// Throws UserError for a damaged file, or one of another key.
PartResult read_part_result(const std::filesystem::path& file, const std::string& key);

}  // namespace radiafit::fits
