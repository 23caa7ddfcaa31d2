#include "fitting/parts/fit_on_ranks.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/failure.h"
#include "base/log.h"
#include "base/output_lock.h"
#include "base/read_file.h"
#include "fitting/parts/parts.h"
#include "gl/context.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

/// One GPU after another, for the ranks of a machine that has several.
void choose_device(const Ranks& ranks, FitRequest& request) {
    if (request.context.device != -1 || request.context.kind != ContextKind::egl) return;
    std::vector<int> devices;
    for (const DeviceInfo& device : list_devices())
        if (device.kind == ContextKind::egl && !device.software) devices.push_back(device.device);
    if (devices.size() > 1) request.context.device = devices[size_t(ranks.local_rank()) % devices.size()];
}

/// Copies every rank's shard to where rank 0 sees it, unless it is there already, on a disk that all share.
void gather(Ranks& ranks, const std::vector<fs::path>& folders) {
    if (ranks.rank() == 0) {
        for (int from = 1; from < ranks.count(); ++from) {
            const fs::path& folder = folders[size_t(from)];
            ranks.receive(from);  // its shard is done
            const bool wanted = !path_exists(folder / shard_json_name);
            const uint8_t answer = wanted;
            ranks.send(from, {&answer, 1});
            if (!wanted) continue;
            fs::create_directories(folder);
            const size_t files = ranks.receive(from).size();
            for (size_t i = 0; i < files; ++i) receive_file(ranks, from, folder);
        }
        return;
    }
    ranks.send(0, {});
    if (ranks.receive(0).at(0) == 0) return;
    const fs::path& folder = folders[size_t(ranks.rank())];
    std::vector<std::string> files = read_shard(folder).files;
    files.emplace_back(shard_json_name);  // last: with it, the shard is whole
    ranks.send(0, std::vector<uint8_t>(files.size()));
    for (const std::string& file : files) send_file(ranks, folder / file);
}

}  // namespace

std::optional<FinishedFit> fit_on_ranks(Ranks& ranks, const Dataset& dataset, const FitRequest& asked,
                                        const fs::path& folder, bool force) {
    try {
        if (ranks.rank() > 0) set_quiet(true);
        std::optional<OutputLock> lock;
        if (ranks.rank() == 0) lock.emplace(folder);
        FitRequest request = asked;
        choose_device(ranks, request);
        std::vector<fs::path> folders;
        for (int i = 1; i <= ranks.count(); ++i)
            folders.push_back(folder / fmt::format("shard-{}-of-{}", i, ranks.count()));
        fit_shard(dataset, request, {ranks.rank() + 1, ranks.count()}, folders[size_t(ranks.rank())], force);
        gather(ranks, folders);
        if (ranks.rank() > 0) return {};
        return merge_shards(dataset, request, folders);
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error(fmt::format("radiafit, rank {} of {}", ranks.rank(), ranks.count()), failure.line);
        ranks.abort(failure.status);
        throw;
    }
}

}  // namespace radiafit::fits
