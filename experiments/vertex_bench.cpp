#include "vertex_bench.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "base/log.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "model/lfm_start.h"
#include "reference/varpro_solver.h"

namespace radiafit::harness {
namespace {

constexpr double rest_change = 1e-6;  ///< of E_t over rest_iterations

bool lies_still(const Course& course, size_t channel) {
    const int now = course.iterations();
    if (now < rest_iterations) return false;
    const double before = course.errors[size_t(now - rest_iterations)][channel];
    return before - course.errors.back()[channel] < rest_change * before;
}

LfmOptions modern(LfmOptions model) {
    model.mode = Mode::modern;
    return model;
}

}  // namespace

int Course::first_below(double level, size_t channel, int last) const {
    const auto found =
        std::partition_point(errors.begin(), errors.end(), [&](const auto& row) { return !(row[channel] <= level); });
    const auto row = int(found - errors.begin());
    return row < int(errors.size()) && row <= last ? row : -1;
}

std::vector<int> sparse_iterations(int last) {
    std::vector<int> out;
    for (int k = 0; k < last; k += std::max(1, k / 50)) out.push_back(k);
    out.push_back(last);
    return out;
}

void BenchVertex::load(uint32_t vertex, const DiskRecords& records, const uint8_t* block,
                       std::span<const float> start) {
    id_ = vertex;
    start_ = start;
    is_gathered_ = false;
    problem_.load(vertex, records, block);
    engine_.count();
}

Course BenchVertex::optimize(const OptimizerOptions& options, std::span<const float> from) {
    Course out;
    engine_.reset(from);
    with_schedule(options, [&](const auto& schedule) {
        engine_.make_room(schedule.room());
        for (int k = 0;; ++k) {
            schedule.judge(engine_, k);
            float errors[3];
            ProblemOutcome outcomes[3];
            engine_.read_errors(errors);
            engine_.outcomes(outcomes);
            out.errors.push_back({errors[0], errors[1], errors[2]});
            bool over = true;
            for (size_t c = 0; c < 3; ++c) {
                const bool active = outcomes[c].status == Status::max_iterations;  // what outcomes() calls it
                if (!active && out.stopped_at[c] < 0) out.stopped_at[c] = k;
                out.at_rest[c] = out.at_rest[c] || !active || lies_still(out, c);
                over = over && out.at_rest[c];
            }
            if (over || k >= options.iterations) break;
            schedule.move(engine_, k);
        }
    });
    out.end = out.errors.back();
    return out;
}

Course BenchVertex::go_on(const OptimizerOptions& options) {
    std::vector<float> from(start_.size());
    engine_.read_parameters(from);
    return optimize(options, from);
}

const LfmVertex& BenchVertex::gathered() {
    if (!is_gathered_) gatherer_->gather(id_, gathered_);
    is_gathered_ = true;
    return gathered_;
}

Course BenchVertex::varpro(int iterations) {
    std::vector<Lanes<double>> p(start_.size() / 4);
    for (size_t i = 0; i < start_.size(); ++i) p[i / 4][long(i % 4)] = double(start_[i]);
    VertexRun run;
    varpro_solver(modern(model_), {.iterations = iterations})(gathered(), p, run);
    Course out;
    for (const VertexRun::Channel& c : run.channel) out.errors.resize(std::max(out.errors.size(), c.error.size()));
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<double>& error = run.channel[c].error;
        for (size_t k = 0; k < out.errors.size(); ++k) out.errors[k][c] = error[std::min(k, error.size() - 1)];
        out.at_rest[c] = run.channel[c].status != Status::max_iterations;
    }
    std::vector<float> end(start_.size());
    for (size_t i = 0; i < end.size(); ++i) end[i] = float(p[i / 4][long(i % 4)]);
    out.end = optimize({.rule = Rule::cg_paper, .iterations = 0}, end).errors[0];
    return out;
}

double BenchVertex::rms_weight() {
    const LfmVertex& vertex = gathered();
    const auto ring = rings_->ring(id_);
    double sum = 0;
    for (size_t g = 0; g + 1 < vertex.groups.size(); ++g)
        for (uint32_t i = vertex.groups[g].first; i < vertex.groups[g + 1].first; ++i) {
            const Corner& corner = ring[vertex.groups[g].map];
            const auto weight = double(atlas_->tile(corner.triangle).barycentric(vertex.local[i])[corner.corner]);
            sum += weight * weight;
        }
    return std::sqrt(sum / double(vertex.sample_count()));
}

VertexBench::VertexBench(const Dataset& dataset, const LfmOptions& maps, int vertices, int seed)
    : dataset_(&dataset),
      atlas_(surface_atlas(dataset.mesh, maps)),
      rings_(dataset.mesh),
      folder_(std::filesystem::temp_directory_path() / "radiafit-bench") {
    request_.set("mode", "paper");
    request_.model = maps;
    samples_ = distribute(dataset, atlas_, request_);
    const Distributors distributors = make_distributors(atlas_, request_);
    const std::string key = "bench";
    write_records(folder_.path(), dataset, atlas_, rings_, dataset.split(false), distributors.workers(), {.key = key});
    records_.emplace(folder_.path(), key);
    for (uint32_t v = 0; v < records_->vertex_count(); ++v)
        if (records_->vertex(v).samples) seen_.push_back(v);
    if (vertices == 0) return;
    std::vector<uint32_t> drawn;
    for (const size_t place : draw(size_t(vertices), uint64_t(seed))) drawn.push_back(seen_[place]);
    seen_ = std::move(drawn);
}

std::vector<size_t> VertexBench::draw(size_t count, uint64_t seed) const {
    std::vector<size_t> places(seen_.size());
    std::iota(places.begin(), places.end(), size_t(0));
    count = std::min(count, places.size());
    Rng rng(seed);
    for (size_t i = 0; i < count; ++i) std::swap(places[i], places[i + rng.index(uint32_t(places.size() - i))]);
    places.resize(count);
    std::sort(places.begin(), places.end());
    return places;
}

void VertexBench::for_each(double lambda, const std::string& task,
                           const std::function<void(size_t i, BenchVertex& vertex)>& body) const {
    FitRequest request = request_;
    request.model.lambda_surface = request.model.lambda_view = float(lambda);
    const LfmOptions model = request.model_options();
    const LfmVertices gatherer(*dataset_, atlas_, rings_, samples_.list, modern(model));
    const std::vector<float> start = lfm_start(gatherer.layout(), gatherer.statistics().mean, request.seed);
    const VertexProblem fresh(*dataset_, atlas_, rings_, records_->views(), model);
    std::vector<std::unique_ptr<BenchVertex>> workers{size_t(thread_count())};
    Progress progress(task, seen_.size());
    parallel_for(seen_.size(), 1, [&](size_t i, int worker) {
        std::unique_ptr<BenchVertex>& vertex = workers[size_t(worker)];
        if (!vertex) vertex = std::make_unique<BenchVertex>(fresh, atlas_, rings_, gatherer, model);
        std::vector<uint8_t> block;
        records_->read(seen_[i], seen_[i] + 1, block);
        const LfmLayout& layout = gatherer.layout();
        vertex->load(seen_[i], *records_, block.data(),
                     {start.data() + layout.offset(seen_[i]), layout.block_size(seen_[i])});
        body(i, *vertex);
        progress.advance();
    });
}

}  // namespace radiafit::harness
