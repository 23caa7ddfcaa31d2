// The module radiafit_mpi: MPI behind fitting/parts/ranks.h.
#include "fitting/parts/ranks.h"

#include <mpi.h>

namespace radiafit::fits {
namespace {

class MpiRanks final : public Ranks {
public:
    MpiRanks() {
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &count_);
        MPI_Comm local;
        MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &local);
        MPI_Comm_rank(local, &local_rank_);
        MPI_Comm_free(&local);
    }
    ~MpiRanks() override { MPI_Finalize(); }
    int rank() const override { return rank_; }
    int count() const override { return count_; }
    int local_rank() const override { return local_rank_; }
    void send(int to, std::span<const uint8_t> bytes) override {
        MPI_Send(bytes.data(), int(bytes.size()), MPI_BYTE, to, 0, MPI_COMM_WORLD);
    }
    std::vector<uint8_t> receive(int from) override {
        MPI_Status status;
        MPI_Probe(from, 0, MPI_COMM_WORLD, &status);
        int bytes = 0;
        MPI_Get_count(&status, MPI_BYTE, &bytes);
        std::vector<uint8_t> out(size_t(bytes), 0);
        MPI_Recv(out.data(), bytes, MPI_BYTE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        return out;
    }
    void abort(int status) override { MPI_Abort(MPI_COMM_WORLD, status); }

private:
    int rank_ = 0, count_ = 1, local_rank_ = 0;
};

}  // namespace
}  // namespace radiafit::fits

extern "C" radiafit::fits::Ranks* radiafit_join_ranks() { return new radiafit::fits::MpiRanks; }
