// What iterations do beside their passes, once the first are over: nothing is allocated, on the host or on the device,
// and one small summary is read back. And what that summary says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "fragment/texel_engine.h"
#include "gl/program.h"
#include "optim/optimizer.h"
#include "texel_fragment_scene.h"

namespace {
thread_local bool counting = false;
thread_local uint64_t host_allocations = 0;
}  // namespace

[[gnu::noinline]] void* operator new(size_t bytes) {
    host_allocations += counting;
    if (void* at = std::malloc(bytes)) return at;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* at) noexcept { std::free(at); }
[[gnu::noinline]] void operator delete(void* at, size_t) noexcept { std::free(at); }

namespace radiafit {
using namespace harness;
namespace {

uint64_t calls[2], read_bytes;
enum { objects, read_backs };

// Counts the calls of an entry point of the current context.
template <auto entry, int what>
struct Counted;
template <class Result, class... Args, GlEntry<Result (*)(Args...)> GlFunctions::*entry, int what>
struct Counted<entry, what> {
    static inline Result (*original)(Args...);
    static Result call(Args... args) {
        calls[what] += counting;
        if constexpr (what == read_backs)
            read_bytes += counting ? uint64_t(std::get<sizeof...(Args) - 2>(std::tuple(args...))) : 0;
        return original(args...);
    }
    static void begin() { original = std::exchange((const_cast<GlFunctions&>(gl()).*entry).pointer, &call); }
};

// Until a history of pairs is full, lbfgs changes vectors that it has not changed before.
constexpr int warm = 8, counted = 4;

template <class E>
void expect_nothing_made(E& engine, std::span<const float> start, Rule rule) {
    engine.reset(start);
    OptimizerOptions options;
    options.rule = rule;
    with_schedule(options, [&](const auto& schedule) {
        engine.make_room(schedule.room());
        calls[objects] = calls[read_backs] = read_bytes = host_allocations = 0;
        for (int k = 0; k < warm + counted; ++k) {
            counting = k >= warm;
            schedule.judge(engine, k);
            const EngineSummary summary = engine.summary();
            schedule.move(engine, k);
            counting = false;
            std::vector<ProblemOutcome> outcomes(engine.problem_count());
            engine.outcomes(outcomes);
            double error = 0;
            uint64_t active = 0;
            for (const ProblemOutcome& outcome : outcomes) {
                error += double(outcome.error);
                active += outcome.status == Status::max_iterations;  // as outcomes() has those that run
            }
            EXPECT_EQ(summary.active, active) << "rule " << int(rule);
            EXPECT_NEAR(summary.error, error, 1e-12 * error) << "rule " << int(rule);
            EXPECT_LE(summary.accepted, engine.problem_count());
        }
    });
    EXPECT_EQ(calls[objects], 0u) << "rule " << int(rule);
    EXPECT_EQ(host_allocations, 0u) << "rule " << int(rule);
    EXPECT_EQ(calls[read_backs], uint64_t(counted)) << "rule " << int(rule);
    EXPECT_LE(read_bytes, 1024u * counted) << "rule " << int(rule);
}

TEST(Iteration, AllocatesNothingAndReadsLittleBack) {
    const auto context = make_context(ContextKind::egl);
    Counted<&GlFunctions::CreateTextures, objects>::begin();
    Counted<&GlFunctions::CreateFramebuffers, objects>::begin();
    Counted<&GlFunctions::CreateBuffers, objects>::begin();
    Counted<&GlFunctions::CreateProgram, objects>::begin();
    Counted<&GlFunctions::GetTextureSubImage, read_backs>::begin();
    Counted<&GlFunctions::GetNamedBufferSubData, read_backs>::begin();
    for (const bool grid : {false, true})
        for (const Passes passes : {Passes::paper, Passes::r300, Passes::combined}) {
            const testing::TexelDataset data({.grid = grid});
            TexelFragmentEngine texels(data.dataset, *data.atlas, data.views, {.model = find_texel_model("lafortune")},
                                       {.passes = passes});
            texels.count();
            for (const Rule rule : {Rule::cg_modern, Rule::lbfgs, Rule::adam})
                expect_nothing_made(texels, texels.start(), rule);
            if (grid) continue;
            const VertexRings rings(data.dataset.mesh);
            FragmentEngine maps(data.dataset, dynamic_cast<const TriangleAtlas&>(*data.atlas), rings, data.views, {},
                                {.passes = passes});
            maps.count();
            const std::vector<float> start(maps.layout().size(), 0.25f);
            for (const Rule rule : {Rule::cg_modern, Rule::lbfgs, Rule::adam}) expect_nothing_made(maps, start, rule);
        }
}

}  // namespace
}  // namespace radiafit
