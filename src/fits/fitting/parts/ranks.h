#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/rings.h"

namespace radiafit::fits {

/// The processes that mpirun started together.
class Ranks {
public:
    virtual ~Ranks() = default;  ///< takes leave of the others, once all do
    virtual int rank() const = 0;
    virtual int count() const = 0;
    virtual int local_rank() const = 0;  ///< among those of this machine
    /// Sends bytes from one rank to another; each send meets one receive.
    virtual void send(int to, std::span<const uint8_t> bytes) = 0;
    virtual std::vector<uint8_t> receive(int from) = 0;
    /// Ends the processes of all ranks.
    virtual void abort(int status) = 0;
};

/// How many processes mpirun says that it started; 1 where none did.
int started_together();
/// Which of them this one is, before it joins the others.
int started_as();
/// Null where mpirun did not start this program, or started it alone. Throws UserError where this build has no MPI.
std::unique_ptr<Ranks> join_ranks();

/// Rank 0 tells all whether to begin: it alone sees what stands where the result is to go. All call it; `begin` is rank
/// 0's. Returns what it told.
bool begin_together(Ranks& ranks, bool begin = true);

/// Sends a file from rank `from` to rank 0, under the same name in rank 0's `folder`. Both call it.
void send_file(Ranks& ranks, const std::filesystem::path& file);
void receive_file(Ranks& ranks, int from, const std::filesystem::path& folder);

/// The module that links MPI, and its one function. It is loaded where mpirun started the program, and only there.
using JoinRanks = Ranks*();
inline constexpr const char* mpi_module = "radiafit_mpi.so";
inline constexpr const char* mpi_function = "radiafit_join_ranks";

}  // namespace radiafit::fits
