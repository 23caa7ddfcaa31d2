#pragma once
#include <cstdint>
#include <limits>

#include "base/range.h"
#include "model/limits.h"

/// What the numbers of FitRequest and of commands may be, on the command line, in a config and in code alike.
namespace radiafit::limits {

constexpr Range<int> iterations{0, 1'000'000};
constexpr Range<int> some_iterations{1, 1'000'000};  ///< of what is timed or compared, so needs one
constexpr Range<int> refills{0, 1'000'000};
constexpr Range<int> validation{0, 1'000'000, "0 is off, and 1 would leave nothing to fit"};
constexpr Range<double> threshold{0, 1e6, "0 is off"};
constexpr Range<double> texels_per_pixel{0, 1000, "0 is off"};
constexpr Range<double> checkpoint{0, 1e6, "0 is never"};
constexpr Range<int> history{1, 8};
constexpr Range<double> learning_rate{1e-6, 10};
constexpr Range<uint64_t> seed{0, std::numeric_limits<uint64_t>::max()};
constexpr Range<int> draw_seed{0, std::numeric_limits<int>::max()};  ///< of an experiment's draw
constexpr Range<int> device{-1, 1023, "-1 is any; radiafit devices lists them"};
constexpr Range<int> threads{0, 1024, "0 is all cores"};
constexpr Range<int> repetitions{1, 1'000'000};
constexpr Range<int> images{0, 1'000'000, "0 is all"};
constexpr Range<double> tolerance{1 + 1e-6, 1e6, "a multiple of the best error"};

constexpr Range<int> subdivide{1, 64};
constexpr Range<double> noise{0, 1, "white is 1"};
constexpr Range<int> max_size{0, 65536, "0 keeps the size"};
constexpr Range<double> least_coverage{0, 1, "0 is off"};
constexpr Range<int> cut_support{0, 1000, "0 is off"};
constexpr Range<int> cut_close{0, 1000, "0 is off"};
constexpr Range<int> mask_inset{0, 1000, "0 is off"};
constexpr Range<double> sample_width{1e-9, 1e9};
constexpr Range<double> refine_lamps{0.01, 30};
constexpr Range<double> mesh_scale{1e-9, 1e9};
constexpr Range<int> view{0, 1'000'000};
constexpr Range<int> turntable{1, 10000};
constexpr Range<double> raking{0.1, 90};
constexpr Range<int> raking_directions{1, 360};
constexpr Range<int> picture_side{1, 8192};
constexpr Range<int> srgb_byte{0, 255};
constexpr Range<double> page_megabytes{0.1, 10000};
constexpr Range<double> page_fidelity{20, 100};
constexpr Range<int> jpeg_quality{1, 100};
constexpr Range<int> page_views{1, 1000};
constexpr Range<int> pixel_points{1, 9, "an odd number: 1 is a pixel's centre alone"};

}  // namespace radiafit::limits
