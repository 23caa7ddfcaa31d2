#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/resources.h"
#include "fitting/family.h"
#include "fitting/parts/part_result.h"

/// Fits in parts: problems are independent of one another, so a surface may be fitted piece by piece, on one machine or
/// on many, to the same result. What a part shares with the whole is cut with it: triangles elsewhere hide it as
/// before, and images that can't show it are left out.
namespace radiafit::fits {

/// How many of the fitted views plans look at to estimate the samples of a part.
inline constexpr size_t views_to_count_samples_on = 8;

/// A fit by itself: the part's surface, and views of which those that can't show it count as held out.
struct Part {
    Dataset dataset;
    FitRequest request;
    std::vector<uint32_t> units;  ///< those to be fitted, ascending, as the whole numbers them (part_result.h)
};

/// Calls look(part, name) for all parts of a fit, one after another. name: of errors about it.
using EachPart = std::function<void(const std::function<void(const PartResult& part, const std::string& name)>& look)>;

/// Throws UserError for a part that doesn't belong there, prefixed by its name.
[[noreturn]] void throw_foreign(const std::string& name);

/// A dataset that is cut, and the results put together again. Both arguments of Family::divide must outlive it.
class Divided {
public:
    virtual ~Divided() = default;
    /// What can be cut apart, as points in space, each with a weight: about what it takes of memory.
    virtual std::span<const Vec3f> places() const = 0;
    virtual std::span<const uint64_t> weights() const = 0;
    /// The part of these places, ascending.
    virtual Part cut(std::span<const uint32_t> places) const = 0;
    /// What all parts have in common is learned from the whole before the first.
    virtual PartResult solve(const Part& part) const = 0;
    /// Bytes that are held beside a part: the whole surface, what it takes to cut it, and what parts have in common.
    virtual uint64_t held_bytes() const = 0;
    /// Bytes that learning what parts have in common takes beyond held_bytes(), samples counted on `most_views` views;
    /// 0 where there is nothing to learn.
    virtual uint64_t learning_bytes(size_t most_views) const;
    /// Bytes held while the whole fit is put together and written, results of `parts` parts one at a time.
    virtual uint64_t merge_bytes(size_t parts) const = 0;

    /// Puts a part in its place. Throws UserError, prefixed by `name`, if it doesn't belong there, or was there before.
    virtual void add(const PartResult& result, const std::string& name) = 0;
    /// The fit of all parts. each_part: the same that were added, for what follows for one from all of them together.
    /// Throws UserError if units are missing.
    virtual FinishedFit finish(const EachPart& each_part) = 0;
};

/// The dataset with another surface, and of these views those that may show it fitted, but one at least; all others
/// held out.
Dataset part_dataset(const Dataset& whole, Mesh mesh, std::span<const uint32_t> views);
/// The whole's request for a part, whose views are chosen already; with its records in a separate folder.
FitRequest part_request(FitRequest request, std::span<const uint32_t> units);

/// The parts for one machine, or one job: the i-th of n shards, from 1.
struct Shard {
    int index = 1, count = 1;
};
/// "2/7". Throws UserError.
Shard parse_shard(const std::string& text);

/// Fits a shard into a folder, which keeps what is done: a run that was stopped goes on from there. In as few parts as
/// keep within request.memory, where that is set. Throws UserError for a folder of another fit, if no number of
/// parts is within the memory, and, unless `force`, where memory or disk will not suffice.
void fit_shard(const Dataset& dataset, const FitRequest& request, const Shard& shard,
               const std::filesystem::path& folder, bool force);
inline constexpr const char* shard_json_name = "shard.json";  ///< in the folder, once all of its parts are

/// What shard.json says.
struct ShardNote {
    Shard shard;
    std::filesystem::path dataset;  ///< as this program may open it
    FitRequest request;
    std::string key;  ///< the same for all shards of a fit
    std::vector<std::string> files;
};
/// Throws UserError for a folder that is no shard's, or whose shard isn't finished.
ShardNote read_shard(const std::filesystem::path& folder);

/// A finished shard, of a fit or of other work.
struct ShardFolder {
    std::filesystem::path folder;
    Shard shard;
    std::string key;
};
/// The shards of the work of this key, by their number. Throws UserError naming those that are missing, foreign or
/// there twice.
std::map<int, std::filesystem::path> whole_of_shards(const std::vector<ShardFolder>& shards, const std::string& key);

/// Whether a fit takes more than request.memory in one piece; false where that isn't set.
bool needs_parts(const Dataset& dataset, const FitRequest& request);

/// Puts shards together. Throws UserError naming those that are missing, foreign or there twice.
FinishedFit merge_shards(const Dataset& dataset, const FitRequest& request,
                         const std::vector<std::filesystem::path>& folders);

/// The parts of a shard.
std::vector<std::vector<uint32_t>> parts_of(const Divided& whole, const Shard& shard, size_t parts);
/// What a number of parts needs: of memory the most at a time, of disk all of them and the fit.
struct PartNeeds : Needs {
    size_t parts = 1;
    uint64_t learning = 0, part = 0,
             merging = 0;  ///< memory by stage, each with the program; 0: there is no such stage
};
/// The fewest parts that keep within request.memory by their plans. Throws UserError if no number of parts does.
PartNeeds count_parts(const Divided& whole, const Shard& shard, const FitRequest& request);

}  // namespace radiafit::fits
