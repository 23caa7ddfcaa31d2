#include "cpu/two_step_solver.h"

#include <mutex>

#include "base/clock.h"
#include "base/parallel.h"

namespace radiafit {
namespace {

/// What the threads read, together.
struct Readings {
    std::mutex mutex;
    double seconds = 0;
    uint64_t bytes = 0;
};

class RecordSource final : public VertexSource {
public:
    RecordSource(const DiskRecords& records, Readings& readings) : records_(&records), readings_(&readings) {}
    void begin(size_t begin, size_t end) override {
        const Stopwatch clock;
        records_->read(begin, end, blocks_);
        next_ = blocks_.data();
        const std::lock_guard lock(readings_->mutex);
        readings_->seconds += clock.wall_s();
        readings_->bytes += blocks_.size();
    }
    void load(size_t v, VertexProblem& problem) override {
        problem.load(v, *records_, next_);
        next_ += records_->block_bytes(v);
    }

private:
    const DiskRecords* records_;
    Readings* readings_;
    std::vector<uint8_t> blocks_;
    const uint8_t* next_ = nullptr;
};

}  // namespace

TwoStepResult solve_two_step(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const DiskRecords& records, const LfmOptions& model, const VertexSolverOptions& options,
                             const std::function<void()>& progress) {
    const LfmLayout layout(rings, atlas, model.view_side, model.terms);
    ProblemStatistics statistics;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        const VertexRecord& record = records.vertex(v);
        statistics.samples.push_back(record.samples);
        statistics.mean.insert(statistics.mean.end(), record.mean, record.mean + 3);
    }
    Readings readings;
    TwoStepResult out{solve_vertices(
        layout, std::move(statistics), VertexProblem(dataset, atlas, rings, records.views(), model), options,
        [&] { return std::make_unique<RecordSource>(records, readings); }, progress)};
    out.read_s = readings.seconds / thread_count();
    out.bytes_read = readings.bytes;
    return out;
}

}  // namespace radiafit
