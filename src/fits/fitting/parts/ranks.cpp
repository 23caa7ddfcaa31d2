#include "fitting/parts/ranks.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file.h"
#include "base/module.h"

namespace radiafit::fits {
namespace {

constexpr uint64_t piece = uint64_t(64) << 20;  // of a file, bytes

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

int started_together() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})  // Open MPI's, and MPICH's
        if (const char* value = std::getenv(name)) return std::atoi(value);
    return 1;
}

int started_as() {
    for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK"})
        if (const char* value = std::getenv(name)) return std::atoi(value);
    return 0;
}

bool begin_together(Ranks& ranks, bool begin) {
    if (ranks.rank() > 0) return ranks.receive(0).at(0) != 0;
    const uint8_t answer = begin;
    for (int to = 1; to < ranks.count(); ++to) ranks.send(to, {&answer, 1});
    return begin;
}

std::unique_ptr<Ranks> join_ranks() {
    if (started_together() <= 1) return nullptr;
    void* module = open_module(mpi_module, RTLD_NOW | RTLD_GLOBAL);
    void* function = module ? dlsym(module, mpi_function) : nullptr;
    if (!function)
        throw UserError(
            fmt::format("mpirun started this program, which cannot use MPI ({}): install libopenmpi-dev and "
                        "build again, or give each process its --shard",
                        dlerror()));
    return std::unique_ptr<Ranks>(reinterpret_cast<JoinRanks*>(function)());
}

void send_file(Ranks& ranks, const std::filesystem::path& file) {
    const InputFile in(file);
    ranks.send(0, bytes_of(file.filename().string()));
    ranks.send(0, bytes_of(std::to_string(in.size())));
    std::vector<uint8_t> bytes;
    for (uint64_t at = 0; at < in.size(); at += bytes.size()) {
        bytes.resize(std::min(piece, in.size() - at));
        in.read(bytes.data(), at, bytes.size());
        ranks.send(0, bytes);
    }
}

void receive_file(Ranks& ranks, int from, const std::filesystem::path& folder) {
    const auto text = [&] {
        const std::vector<uint8_t> bytes = ranks.receive(from);
        return std::string(bytes.begin(), bytes.end());
    };
    AtomicFile out(folder / text());
    for (uint64_t left = std::stoull(text()); left > 0;) {
        const std::vector<uint8_t> bytes = ranks.receive(from);
        out.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        left -= bytes.size();
    }
    out.commit();
}

}  // namespace radiafit::fits
