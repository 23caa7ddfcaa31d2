#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::passes {
using namespace columns;

struct Round {
    size_t step;
    std::string name;
    size_t repetition, images;
    uint64_t samples;
    double ms_per_image_and_sweep;
    std::string renderer;
};
inline const RowFileOf<Round> rounds{
    "rounds.csv",
    "One row for each repetition of a step.",
    {{"step", key(), "from 0, in the order of the ladder", &Round::step},
     {"name", key(), "of the step", &Round::name},
     {"repetition", repetition(), "from 0", &Round::repetition},
     {"images", exact(), "distinct training images", &Round::images},
     {"samples", errors("{}"), "pixels that texels take, by the CPU's rasterizer", &Round::samples},
     {"ms_per_image_and_sweep", times("{:.6g}").in("ms"), "an iteration's time over its two sweeps and the images", &Round::ms_per_image_and_sweep},
     {"renderer", shown(), "", &Round::renderer}}};

struct Step {
    size_t step;
    std::string name;
    double median_ms;
    std::optional<double> low_ms, high_ms;
    double over_previous, over_first;
    std::string renderer;
};
inline const RowFileOf<Step> ladder{
    "ladder.csv",
    "One row for each step.",
    {{"step name", key(), as_before, &Step::step, &Step::name},
     {"median_ms", shown("{:.4g}").in("ms"), "of an image and a sweep", &Step::median_ms},
     {"low_ms high_ms", shown("{:.4g}").in("ms"), "its interval of 95 %, where there are rounds enough", &Step::low_ms, &Step::high_ms},
     {"over_previous over_first", shown("{:.4g}"), "medians of ratios within a round, to the step before and to the first", &Step::over_previous, &Step::over_first},
     {"renderer", shown(), "", &Step::renderer}}};

inline const ExperimentEntry experiment{
    .name = "passes",
    .about = "Sections 6.5 and 6.6: what an image and a sweep cost, step by step: the paper's passes, combined, in compute shaders that distribute in every sweep or keep samples, on the CPU.",
    .files = {&rounds, &ladder},
    .place = 80,
    .title = "From the paper's passes to cached samples",
    .section = "6.5, 6.6",
    .paper = "Combining passes by multiple render targets and longer programs would cut the cost of context switches and redundant texture reads. No values are given.",
    .figure = "Dots: milliseconds per image and sweep, from the paper's passes down to samples kept on the CPU.",
    .tables = {"ladder.csv"}};

}  // namespace radiafit::harness::rows_of::passes
