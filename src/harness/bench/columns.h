#pragma once
#include "report/experiments.h"
#include "report/half_rows.h"

/// `radiafit-bench` writes these rows, of the devices that were asked for and are there.
namespace radiafit::harness::rows_of::bench {
using namespace columns;

// OpenGL's samples differ from the CPU's in some pixels.
struct Scene {
    std::string problem;
    uint64_t images, samples, sites, parameters;
};
inline const RowFileOf<Scene> scenes{
    "scenes.csv",
    "One row for each problem.",
    {{"problem", key(), "star and bust: a light field map of one term; ornament: Lafortune's model", &Scene::problem},
     {"images", exact(), "that are fitted", &Scene::images},
     {"samples", errors("{}"), "pixels that texels take and that count, over all images", &Scene::samples},
     {"sites", exact(), "vertices of a light field map, texels of the ornament", &Scene::sites},
     {"parameters", exact(), "over all problems", &Scene::parameters}}};

struct Agreement {
    std::string problem, device, quantity;
    std::optional<double> difference, tolerance;
    bool agrees;
};
inline const RowFileOf<Agreement> agreement{
    "agreement.csv",
    "One row for each problem, device and quantity: how far the device is from the CPU in double, before anything is "
    "timed.",
    {{"problem", key(), as_before, &Agreement::problem},
     {"device", key(), "", &Agreement::device},
     {"quantity", key(),
      "samples: those that vertices or texels took more or fewer than the list that all share, which leaves them out; "
      "error, gradient, diagonal (of the preconditioner), gauss-newton, d'Hd, third, fourth: sums over samples at a "
      "random "
      "point and along a random direction; fit: errors of three iterations; run: it does not, for want of memory or of "
      "something else",
      &Agreement::quantity},
     {"difference", shown("{:.2g}").in("share"),
      "samples: of all in the list; sums: the largest difference, of its terms' magnitudes; fit: the largest, "
      "of "
      "the error",
      &Agreement::difference},
     {"tolerance", shown("{:.5g}").in("share"), "what it may be", &Agreement::tolerance},
     {"agrees", exact(), "1, or 0: then the device is not timed on this problem, unless it is samples alone",
      &Agreement::agrees}},
    partial};

struct Group {
    std::string problem, device;
    size_t invocations;
    std::optional<double> seconds;
    bool chosen;
};
inline const RowFileOf<Group> groups{"groups.csv",
                                     "Sizes of the work groups of compute shaders.",
                                     {{"problem device", key(), as_before, &Group::problem, &Group::device},
                                      {"invocations", key(), "of a work group", &Group::invocations},
                                      {"seconds", shown("{:.3g}").in("s"),
                                       "of a pass like those over samples, by which a size is chosen: nothing where "
                                       "the size is not open, as in software",
                                       &Group::seconds},
                                      {"chosen", shown(), "1, or 0", &Group::chosen}},
                                     partial};

struct Measurement {
    std::string problem, device, pass;
    size_t repetition;
    double seconds, streaming_s;
};
inline const RowFileOf<Measurement> measurements{
    "rows.csv",
    "One row for each measurement.",
    {{"problem device", key(), as_before, &Measurement::problem, &Measurement::device},
     {"pass", key(),
      "gradient, line: over all samples; iteration: of conjugate gradients, a line, a gradient and all between; "
      "distribution: on the CPU, images read from the page cache, and which texel takes which pixel of each",
      &Measurement::pass},
     {"repetition", repetition(), "from 0", &Measurement::repetition},
     {"seconds", times("{:.5g}"), "of one pass", &Measurement::seconds},
     {"streaming_s", shown("{:.5g}").in("s"), "of it: handing images, which are in host memory, to OpenGL",
      &Measurement::streaming_s}},
    partial};

struct Peak {
    std::string device, peak;
    size_t repetition;
    double per_second;
};
inline const RowFileOf<Peak> peaks{
    "peaks.csv",
    "What the devices can do at most, measured before every round.",
    {{"device", key(), as_before, &Peak::device},
     {"peak", key(),
      "operations: components of multiply-adds, two each; reads: texels of 16 bytes; bytes: to and from main memory",
      &Peak::peak},
     {"repetition", repetition(), "from 0", &Peak::repetition},
     {"per_second", shown("{:.5g}").in("1/s"), "", &Peak::per_second}},
    partial};

struct Summary {
    std::string problem, device, pass;
    double seconds;
    std::optional<double> low_s, high_s;
    double ms_per_image, ns_per_sample;
    std::optional<double> operations, reads, bytes, operations_share, reads_share, bytes_share;
    size_t repetitions;
    std::string renderer;
};
inline const RowFileOf<Summary> summary{
    "summary.csv",
    "Medians over repetitions.",
    {{"problem device pass", key(), as_before, &Summary::problem, &Summary::device, &Summary::pass},
     {"seconds low_s high_s", shown("{:.5g}").in("s"), "of one pass, and the interval of 95 % of the median",
      &Summary::seconds, &Summary::low_s, &Summary::high_s},
     {"ms_per_image", shown("{:.5g}").in("ms"), "", &Summary::ms_per_image},
     {"ns_per_sample", shown("{:.5g}").in("ns"),
      "over samples; on star and bust over three times as many, since a sample counts for the three vertices of its "
      "triangle",
      &Summary::ns_per_sample},
     {"operations reads bytes", shown("{:.5g}"),
      "fragment programs: what they declare, times how often they ran; CPU and compute shaders: the least that the "
      "model and its samples ask for (`src/harness/bench/work.cpp`), reads not told, nor bytes of those that "
      "distribute anew",
      &Summary::operations, &Summary::reads, &Summary::bytes},
     {"operations_share reads_share bytes_share", shown("{:.5g}").in("share"),
      "of the device's peaks, each by its own round's; beyond 1 where caches serve what is counted",
      &Summary::operations_share, &Summary::reads_share, &Summary::bytes_share},
     {"repetitions", shown(), "", &Summary::repetitions},
     {"renderer", shown(), "", &Summary::renderer}},
    partial};

inline const ExperimentEntry experiment{
    .name = "bench",
    .about =
        "What `radiafit-bench` leaves ([gpu.md](gpu.md)). A device is what runs the passes: the CPU with all "
        "threads or with one, OpenGL's fragment programs by the paper's or by combined passes, or its compute "
        "shaders, over samples that stay or over images.",
    .files = {&scenes, &agreement, &measurements, &peaks, &groups, &halves, &summary},
    .place = 160};

}  // namespace radiafit::harness::rows_of::bench
