// An optimizer of one's own, gradient descent with momentum, on the problems of the synthetic star.
#include <fmt/format.h>
#include <radiafit/cpu/lane_engine_impl.h>
#include <radiafit/cpu/lfm_engine.h>
#include <radiafit/model/lfm_start.h>
#include <radiafit/optim/optimizer.h>
#include <radiafit/samples/raster_distributor.h>
#include <radiafit/synthetic/synthetic.h>
using namespace radiafit;

struct Momentum {
    Room room() const { return {.vectors = 1}; }  // the velocity
    void judge(auto& engine, int) const {         // the trial: p is the best one so far
        engine.gradient_pass(false);
        engine.dot({{vector::trial_g, vector::trial_g, vector::none, PRODUCT_NORM}});
        engine.step(Step::adam_judge, {});
        engine.update(Update::adam_keep, {vector::p, vector::trial}, {number::accepted}, {});
    }
    void move(auto& engine, int) const {
        engine.template update_by<3, 2>(
            [](auto& e, const auto& running, const auto& told) {  // e: an element of each of the vectors below
                e.x[0] = told.x[0] * e.x[0] - told.x[1] * e.x[2];
                e.x[1] += running.x[0] * e.x[0];
            },
            {vector::first_own, vector::trial, vector::trial_g}, {number::taken}, {0.9f, 0.1f});
    }
};
int main() {
    generate_synthetic({.shape = "star", .scale = "smoke"}, "star");
    const Dataset dataset = open_dataset("star");
    const TriangleAtlas atlas(dataset.mesh, LfmOptions().surface_side);
    const VertexRings rings(dataset.mesh);
    const auto workers = raster_distributors(atlas);
    const auto samples = build_sample_list(dataset, atlas, dataset.split(false), worker_pointers(workers));
    LfmProblem<float> problem(dataset, atlas, rings, samples, LfmOptions());
    StreamEngine<float> engine(problem);
    engine.reset(lfm_start(problem.layout(), engine.count().mean, 1));
    const Trace trace = optimize(engine, Momentum(), 50);
    fmt::print("error {:.4g} -> {:.4g}\n", trace.rows.front().error, trace.rows.back().error);
}
