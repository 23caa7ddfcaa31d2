#include "app/choices.h"
#include "app/run_engine.h"
#include "base/clock.h"
#include "gl/fragment_engine.h"

namespace radiafit {

void solve_with_fragment_engine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                                const std::vector<uint32_t>& views, const FitRequest& request,
                                const IterationHook& each_iteration, FitOutcome& out) {
    static_assert(Engine<FragmentEngine>);
    const auto context = Context::create(context_options(request));
    out.gl_vendor = context->vendor();
    out.gl_renderer = context->renderer();
    out.gl_version = context->version();
    FragmentOptions options;
    options.passes = choose_passes(request.passes);
    options.storage = choose_storage(request.storage);
    options.source = choose_source(request.source);
    options.space = choose_space(request.space);
    Stopwatch clock;
    FragmentEngine engine(dataset, atlas, rings, views, request.model_options(), options);
    run_engine(engine, dataset, engine.layout(), request, request.model_options(), each_iteration, out);
    const FragmentTimes& times = engine.times();
    out.times.streaming = times.stream_s + times.upload_s;
    out.times.optimization = clock.wall_s() - out.times.streaming;
    out.engine_bytes = engine.bytes();
    out.sweep_cpu_ms_per_image = times.images ? 1e3 * times.sweep_cpu_s / double(times.images) : 0;
}

}  // namespace radiafit
