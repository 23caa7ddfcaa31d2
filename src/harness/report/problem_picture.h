#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/rings.h"

namespace radiafit::harness {

/// Where fits end and how, in an atlas's 2-D layout: four maps side by side.
struct ProblemPicture {
    int width = 0, height = 0;
    // [height][width], row 0 on top; NaN where no problem is.
    std::vector<float> status;      ///< index into status_names
    std::vector<float> iterations;  ///< until it ended
    std::vector<float> samples;
    std::vector<float> rms;  ///< root mean square residual at the end
    std::vector<std::string> status_names;
    std::string title, unit;  ///< unit: of the residual
    std::string mark;         ///< letters and _: names what is in the SVG file, which so holds it
};

/// STEM.png and STEM.svg by gnuplot; throws as draw_figure() does.
void draw_problems(const ProblemPicture& picture, const std::filesystem::path& stem);

}  // namespace radiafit::harness
