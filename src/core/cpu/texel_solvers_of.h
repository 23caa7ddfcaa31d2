#pragma once
#include <algorithm>
#include <optional>

#include "base/instructions.h"
#include "base/journal.h"
#include "base/parallel.h"
#include "cpu/lane_engine_impl.h"
#include "cpu/surface_prior.h"
#include "cpu/texel_batch_loader.h"
#include "cpu/texel_batches_impl.h"
#include "cpu/texel_fit_impl.h"
#include "cpu/texel_solver.h"

namespace radiafit {

/// The TexelSolvers of a text, with real = Pack: texel_text::NAME<Pack>.
template <class Text>
class TexelSolversOf final : public TexelSolvers {
    using Fit = TexelFit<Text>;
    using Batch = typename Fit::Batch;
    using Texels = TexelBatches<Text>;
    using Engine = LaneEngine<Texels>;
    static_assert(radiafit::Engine<Engine>);
    static constexpr size_t N = Texels::N, lanes = Pack::size;

    using Worker = TexelBatchLoader<Text>;  ///< one thread's

    static TexelResult empty_result(size_t texels) {
        TexelResult out;
        out.parameters.resize(texels * N);
        out.status.assign(texels, Status::no_samples);
        out.iterations.assign(texels, 0);
        out.samples.assign(texels, 0);
        out.error.assign(texels, 0);
        return out;
    }

    /// What the engine ended with; problem i is texel texel_of(i).
    template <class TexelOf>
    static void take(const Engine& engine, const TexelOptions& options, std::span<const Batch> batches,
                     TexelResult& out, const TexelOf& texel_of) {
        const size_t count = engine.problem_count();
        std::vector<ProblemOutcome> outcomes(count);
        std::vector<float> p(count * N), errors(count);
        engine.outcomes(outcomes);
        engine.read_parameters(p);
        for (size_t i = 0; i < count; ++i) options.model->make_canonical({&p[i * N], N});
        parallel_for(batches.size(), 16,
                     [&](size_t b, int) { batch_errors(batches[b], p, b, options.loss, errors.data()); });
        for (size_t i = 0; i < count; ++i) {
            const size_t t = texel_of(i);
            out.status[t] = outcomes[i].status;
            out.iterations[t] = outcomes[i].iterations;
            out.samples[t] = batches[i / lanes].count(int(i % lanes));
            out.error[t] = errors[i];
            std::copy_n(&p[i * N], N, &out.parameters[t * N]);
        }
    }
    /// Raw E of batch b of `p` and `errors`, which begin at batch 0.
    static void batch_errors(const Batch& batch, std::span<const float> p, size_t b, const Loss& loss, float* errors) {
        const size_t first = lanes * b, count = std::min(lanes, p.size() / N - first);
        typename TexelLocal<Text>::Parameters packed;
        packed.fill(Pack{});
        for (size_t t = 0; t < count; ++t)
            for (size_t i = 0; i < N; ++i) packed[i].set(int(t), p[(first + t) * N + i]);
        WidePack error;
        with_loss(loss,
                  [&](auto of) { with_widest_vectors([&] { error = texel_error<Text>(batch.rows(), packed, of); }); });
        for (size_t t = 0; t < count; ++t) errors[first + t] = batch.count(int(t)) ? float(error[int(t)]) : 0.0f;
    }

    /// work(worker, block's first texel, batches, trace of the block) for every block, in parallel, but those that
    /// `journal` has.
    template <class Work>
    static TexelResult for_blocks(const TexelProblem& problem, Journal* journal, const std::function<void()>& progress,
                                  const Work& work) {
        TexelResult out = empty_result(problem.source.texel_count());
        std::vector<std::unique_ptr<Worker>> workers{size_t(thread_count())};
        std::vector<TraceSum> traces(problem.source.block_count());
        const auto fields = [&](auto& visit, size_t block) {
            const size_t begin = block * TexelSource::block;
            const size_t count = std::min<size_t>(TexelSource::block, out.status.size() - begin);
            visit(std::span(out.parameters).subspan(begin * N, count * N));
            visit(std::span(out.status).subspan(begin, count));
            visit(std::span(out.iterations).subspan(begin, count));
            visit(std::span(out.samples).subspan(begin, count));
            visit(std::span(out.error).subspan(begin, count));
            visit(traces[block].rows());
        };
        const auto solve = [&](size_t block, int worker) {
            if (!workers[size_t(worker)]) workers[size_t(worker)] = std::make_unique<Worker>();
            Worker& w = *workers[size_t(worker)];
            const uint32_t begin = uint32_t(block) * TexelSource::block;
            const size_t batches = w.load(problem.source, problem.loader, begin);
            work(w, begin, batches, traces[block], out);
        };
        finish_blocks(journal, traces.size(), fields, solve, [&](size_t) {
            if (progress) progress();
        });
        TraceSum sum;
        for (const TraceSum& trace : traces) sum.add(trace.rows());
        out.trace.rows = sum.rows();
        const double threads = thread_count();
        for (TraceRow& row : out.trace.rows) row.time_s /= threads;
        for (const auto& w : workers) out.load_s += w ? w->load_s / threads : 0;
        for (size_t t = 0; t < out.status.size(); ++t)
            out.sample_iterations += uint64_t(out.samples[t]) * out.iterations[t];
        return out;
    }

public:
    TexelResult stream(const TexelProblem& problem, const OptimizerOptions& optimizer,
                       const TexelHook& each_iteration) const override {
        const size_t texels = problem.source.texel_count(), per_block = Worker::batches_per_block;
        std::vector<Batch> batches((texels + lanes - 1) / lanes);
        std::vector<float> start(texels * N);
        std::vector<uint32_t> texel_of(texels);
        std::vector<std::unique_ptr<Worker>> workers{size_t(thread_count())};
        parallel_for(problem.source.block_count(), 1, [&](size_t block, int worker) {
            if (!workers[size_t(worker)]) workers[size_t(worker)] = std::make_unique<Worker>();
            Worker& w = *workers[size_t(worker)];
            const uint32_t begin = uint32_t(block) * TexelSource::block;
            const size_t count = w.load(problem.source, problem.loader, begin);
            for (size_t i = 0; i < w.order.size(); ++i) texel_of[begin + i] = begin + w.order[i];
            for (size_t b = 0; b < count; ++b) {
                batches[block * per_block + b] = w.batches[b];  // a copy is no larger than it must be
                put_start(w.batches[b], start, begin + lanes * b);
            }
        });
        Texels all(batches, texels, problem.options);
        Engine engine(all);
        engine.count();
        TexelResult out = empty_result(texels);
        for (const auto& w : workers) out.load_s += w ? w->load_s / thread_count() : 0;
        engine.reset(start);
        std::vector<float> errors;
        out.trace = optimize(engine, optimizer, [&](int iteration) {
            if (!each_iteration) return;
            each_iteration(iteration, [&](std::span<float> to) {
                errors.resize(texels);
                engine.read_errors(errors);
                for (size_t i = 0; i < texels; ++i) to[texel_of[i]] = errors[i];
            });
        });
        take(engine, problem.options, batches, out, [&](size_t i) { return texel_of[i]; });
        for (size_t t = 0; t < texels; ++t) out.sample_iterations += uint64_t(out.samples[t]) * out.iterations[t];
        out.engine_bytes = engine.bytes();
        for (const Batch& batch : batches) out.engine_bytes += batch.rows().size_bytes();
        return out;
    }

    TexelResult solve(const TexelProblem& problem, const OptimizerOptions& optimizer,
                      const std::function<void()>& progress) const override {
        return for_blocks(problem, problem.journal, progress,
                          [&](Worker& w, uint32_t begin, size_t batches, TraceSum& trace, TexelResult& out) {
                              for (size_t b = 0; b < batches; ++b) {
                                  const std::span<const Batch> one(&w.batches[b], 1);
                                  Texels texels(one, std::min(lanes, w.order.size() - lanes * b), problem.options);
                                  Engine engine(texels);
                                  engine.count();
                                  std::vector<float> start(engine.problem_count() * N);
                                  put_start(w.batches[b], start, 0);
                                  engine.reset(start);
                                  trace.add(optimize(engine, optimizer).rows);
                                  take(engine, problem.options, one, out,
                                       [&](size_t i) { return begin + w.order[lanes * b + i]; });
                              }
                          });
    }

    TexelResult solve_lm(const TexelProblem& problem, const TexelFitOptions& options,
                         const std::function<void()>& progress, const SurfacePrior* known = nullptr) const override {
        const Fit fit(options);
        return for_blocks(problem, problem.journal, progress,
                          [&](Worker& w, uint32_t begin, size_t batches, TraceSum& trace, TexelResult& out) {
                              std::vector<float> p(lanes * batches * N), errors(lanes * batches);
                              for (size_t b = 0; b < batches; ++b) {
                                  const size_t count = std::min(lanes, w.order.size() - lanes * b);
                                  const std::span<const uint32_t> texels(&w.order[lanes * b], count);
                                  Trace rows;
                                  std::optional<typename Fit::Prior> prior;
                                  if (known) prior = prior_of(*known, begin, texels);
                                  auto outcomes = fit.solve(w.batches[b], &rows, prior ? &*prior : nullptr);
                                  trace.add(rows.rows);
                                  for (size_t lane = 0; lane < count && known; ++lane)
                                      if (auto& o = outcomes[lane];
                                          o.status == Status::no_samples || o.status == Status::not_finite)
                                          std::ranges::copy(known->mean_of(begin + texels[lane]), o.parameters.begin());
                                  for (size_t lane = 0; lane < lanes; ++lane)
                                      std::copy_n(outcomes[lane].parameters.begin(), N, &p[(lanes * b + lane) * N]);
                                  // the outcome's error is E's quadratic model, inaccurate where it is ill-conditioned
                                  batch_errors(w.batches[b], p, b, problem.options.loss, errors.data());
                                  for (size_t i = lanes * b; i < std::min(lanes * (b + 1), w.order.size()); ++i) {
                                      const size_t t = begin + w.order[i];
                                      const auto& o = outcomes[i % lanes];
                                      std::copy_n(&p[i * N], N, &out.parameters[t * N]);
                                      out.status[t] = o.status;
                                      out.iterations[t] = uint32_t(o.iterations);
                                      out.samples[t] = o.samples;
                                      out.error[t] = errors[i];
                                  }
                              }
                          });
    }

    std::vector<float> start(const std::vector<std::vector<ShadedSample>>& texels) const override {
        Batch batch;
        batch.clear();
        for (size_t t = 0; t < texels.size(); ++t) Worker::push(batch, int(t), texels[t]);
        std::vector<float> out(lanes * N);
        put_start(batch, out, 0);
        return out;
    }

    std::vector<float> errors(const TexelProblem& problem, std::span<const float> parameters,
                              double* load_s) const override {
        std::vector<float> out(problem.source.texel_count());
        const TexelResult visit =
            for_blocks(problem, nullptr, {}, [&](Worker& w, uint32_t begin, size_t batches, TraceSum&, TexelResult&) {
                std::vector<float> p(w.order.size() * N), e(w.order.size());
                for (size_t i = 0; i < w.order.size(); ++i)
                    std::copy_n(&parameters[(begin + w.order[i]) * N], N, &p[i * N]);
                for (size_t b = 0; b < batches; ++b) batch_errors(w.batches[b], p, b, problem.options.loss, e.data());
                for (size_t i = 0; i < w.order.size(); ++i) out[begin + w.order[i]] = e[i];
            });
        if (load_s) *load_s += visit.load_s;
        return out;
    }

    uint64_t stream_bytes(uint64_t texels, uint64_t samples, const Room& room) const override {
        const uint64_t blocks = (texels + lanes - 1) / lanes;
        return Engine::bytes(blocks * N, blocks, room) + samples * sizeof(typename Batch::Row) / lanes;
    }

private:
    /// What is known of eight texels or fewer; texels: from `begin` on.
    static typename Fit::Prior prior_of(const SurfacePrior& known, uint32_t begin, std::span<const uint32_t> texels) {
        typename Fit::Prior out;
        const size_t basis = out.weight.size(), shape = out.shape_weight.size();
        std::copy_n(known.weights.begin(), basis, out.weight.begin());
        std::copy_n(known.weights.begin() + std::ptrdiff_t(basis), shape, out.shape_weight.begin());
        for (size_t lane = 0; lane < texels.size(); ++lane) {
            const std::span<const float> mean = known.mean_of(begin + texels[lane]);
            for (size_t k = 0; k < basis; ++k)
                for (size_t c = 0; c < 3; ++c) out.mean[c][k].set(int(lane), double(mean[3 * k + c]));
            for (size_t i = 0; i < shape; ++i) out.shape_mean[i].set(int(lane), double(mean[3 * basis + i]));
        }
        return out;
    }

    /// Starts of a batch to `start` from texel `first` on, as many as fit.
    static void put_start(const Batch& batch, std::span<float> start, size_t first) {
        const auto of = Fit::start(batch);
        for (size_t lane = 0; lane < lanes && (first + lane) * N < start.size(); ++lane)
            std::copy(of[lane].begin(), of[lane].end(), &start[(first + lane) * N]);
    }
};

}  // namespace radiafit
