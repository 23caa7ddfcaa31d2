#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::scaling {
using namespace columns;

struct Memory {
    std::string engine, storage, passes;
    int side;
    uint64_t triangles, vertices, parameters, planned_bytes, allocated_bytes, opengl_bytes;
    std::optional<int64_t> process_bytes;
    uint64_t paper_layout_bytes;
};
inline const RowFileOf<Memory> memory{
    "memory.csv",
    "One row for each size of the OpenGL engine.",
    {{"engine", key(), "fragment: OpenGL", &Memory::engine},
     {"storage", key(), "of parameters and other vectors: fp32 or fp16", &Memory::storage},
     {"passes", key(), "paper or combined", &Memory::passes},
     {"side", key().in("texels"), "of surface maps and of view maps", &Memory::side},
     {"triangles vertices", exact(), "of the mesh", &Memory::triangles, &Memory::vertices},
     {"parameters", exact(), "of the model", &Memory::parameters},
     {"planned_bytes", columns::memory(), "what `radiafit plan` foretells", &Memory::planned_bytes},
     {"allocated_bytes", columns::memory(), "what the program counted while it asked OpenGL for textures and buffers", &Memory::allocated_bytes},
     {"opengl_bytes", columns::memory(), "of all textures and buffers, by the sizes and formats that OpenGL tells of each", &Memory::opengl_bytes},
     {"process_bytes", shown().in("bytes"), "by how much the process's resident memory grew, shaders included, where OpenGL runs in it", &Memory::process_bytes},
     {"paper_layout_bytes", columns::memory(), "by Section 6.3's accounting, at 32 bits", &Memory::paper_layout_bytes}}};

// OpenGL's samples differ from the CPU's in some pixels, and between devices.
struct Time {
    std::string part, engine, what;
    int side;
    size_t images;
    uint64_t texels, samples, parameters;
    size_t repetition;
    double seconds;
    std::optional<double> sweep_seconds;
    std::string renderer;
};
inline const RowFileOf<Time> time{
    "time.csv",
    "One row for each repetition. All of one part are timed by turns.",
    {{"part", key(), "samples: over more images; texels: over finer surface maps; distribution: what it costs", &Time::part},
     {"engine", key(),
      "cpu; fragment paper and fragment combined: OpenGL with either kind of passes; compute gather and compute scatter: compute shaders, texel by texel, and pixel by pixel into 64-bit fixed point",
      &Time::engine},
     {"what", key(),
      "iteration: one of the paper's conjugate gradients; \"iteration, samples kept\": with what texels take kept on the device by an earlier sweep, or with a list of samples there; distribution: of "
      "all images, once",
      &Time::what},
     {"side", key().in("texels"), "of surface maps", &Time::side},
     {"images", key(), "distinct training images", &Time::images},
     {"texels", exact(), "of the surface", &Time::texels},
     {"samples", errors("{}"), "pixels that texels take", &Time::samples},
     {"parameters", exact(), "of the model; 0 of a distribution", &Time::parameters},
     {"repetition", repetition(), "from 0", &Time::repetition},
     {"seconds", times("{:.6g}"), "", &Time::seconds},
     {"sweep_seconds", shown("{:.6g}").in("s"), "of these, sweeps over images; empty where none stream", &Time::sweep_seconds},
     {"renderer", shown(), "", &Time::renderer}}};

struct Work {
    std::string part, engine, what, optimizer;
    size_t images;
    uint64_t operations, reads;
};
inline const RowFileOf<Work> work{
    "work.csv",
    "What an iteration declares, with samples distributed in every sweep and with samples kept.",
    {{"part engine what", key(), as_before, &Work::part, &Work::engine, &Work::what},
     {"optimizer", key(), "sd or cg", &Work::optimizer},
     {"images", exact(), "all training images", &Work::images},
     {"operations", exact(), "components of arithmetic, as the passes declare them, times their fragments", &Work::operations},
     {"reads", exact().in("texels"), "fetched, likewise", &Work::reads}}};

struct Summary {
    std::string of, engine;
    double median;
    std::optional<double> low, high;
};
inline const RowFileOf<Summary> summary{
    "summary.csv",
    "Medians over repetitions.",
    {{"of", key(), "a slope of logarithms, such as seconds over samples; or a ratio of times", &Summary::of},
     {"engine", key(), "as in time.csv, or with the storage of memory.csv", &Summary::engine},
     {"median", shown("{:.4f}"), "", &Summary::median},
     {"low high", shown("{:.4f}"), "its interval of 95 %; of what is counted, itself", &Summary::low, &Summary::high}}};

inline const ExperimentEntry experiment{
    .name = "scaling",
    .about =
        "Sections 4.3, 6.3 and 6.6: memory over the number of parameters; time over the number of samples, and over the surface's texels where sums are gathered and scattered; what distributing in "
        "every sweep costs.",
    .files = {&memory, &time, &work, &summary},
    .place = 60,
    .title = "Memory and time by the size of the problem",
    .section = "3.2, 4.3, 6.3, 6.6",
    .paper =
        "Memory is O(N), an iteration costs O(S); conjugate gradients on the star need 142 MB at 32 bits. Redistributing every iteration “has almost no extra cost”. A limited scatter and gather "
        "would remove the dependence on the sampling rate of the parameters.",
    .figure =
        "Four plots with logarithmic axes: memory by the number of parameters; seconds per iteration by the number of samples; seconds of the sweeps by the number of surface texels, for gathering "
        "and scattering; and how much longer an iteration takes that distributes anew.",
    .tables = {"summary.csv"}};

}  // namespace radiafit::harness::rows_of::scaling
