#include "report/problem_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/file.h"
#include "report/figures.h"

namespace radiafit::harness {
namespace {

constexpr const char* script = R"(
if (terminal eq 'svg') {
    set terminal svg name mark size 1200,1000 font 'DejaVu Sans,13' background 'white'
} else {
    set terminal pngcairo size 1200,1000 font 'DejaVu Sans,11'
}
set output output
set multiplot layout 2,2 title "{/:Bold ".heading."}" margins 0.03,0.88,0.03,0.90 spacing 0.17,0.07
set size ratio -1
unset border
unset xtics
unset ytics
unset key
set xrange [-0.5:width - 0.5]
set yrange [-0.5:height - 0.5]
map(name) = "'".data."/".name.".f32' binary array=(".width.",".height.") flip=y format='%float32'"
set title 'how the problem ended'
set palette defined (0 '#bbbbbb', 1 '#009e73', 2 '#56b4e9', 3 '#dddddd', 4 '#e69f00', 5 '#000000', 6 '#cc0000', 7 '#8e44ad') maxcolors 8
set cbrange [-0.5:7.5]
eval 'set cbtics ('.status_tics.') scale 0'
eval 'plot '.map('status').' with image notitle'
set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725') maxcolors 0
set cbtics autofreq scale 0.5
set cbrange [0:*]
set title 'iterations'
eval 'plot '.map('iterations').' with image notitle'
set title 'samples that count'
eval 'plot '.map('samples').' with image notitle'
set title 'root mean square residual at the end, '.unit
set logscale cb
set format cb '10^{%L}'
eval 'set cbrange ['.rms_range.']'
eval 'plot '.map('rms').' with image notitle'
unset multiplot
)";

void write_values(const std::filesystem::path& file, const std::vector<float>& values) {
    OutputFile out(file);
    out.write(values.data(), values.size() * sizeof(float));
    out.close();
}

/// Without gnuplot's marks for subscripts.
std::string plain(std::string text) {
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

/// What gnuplot's set cbtics takes: each status that there is, with its share, at its number.
std::string status_tics(const ProblemPicture& p) {
    std::vector<size_t> counts(p.status_names.size(), 0);
    size_t all = 0;
    for (const float s : p.status)
        if (std::isfinite(s)) ++counts[size_t(s)], ++all;
    std::string tics;
    for (size_t s = 0; s < counts.size(); ++s) {
        if (counts[s])
            tics += fmt::format("{}\"{}\\n{:.4g} %%\" {}", tics.empty() ? "" : ", ", plain(p.status_names[s]),
                                100.0 * double(counts[s]) / double(all), s);
    }
    return tics;
}

/// From the first to the last thousandth, so that a few odd ones don't take all colours.
std::string rms_range(const ProblemPicture& p) {
    std::vector<float> values;
    for (const float x : p.rms)
        if (x > 0 && std::isfinite(x)) values.push_back(x);
    if (values.empty()) return "1e-6:1";
    std::sort(values.begin(), values.end());
    const size_t edge = values.size() / 1000;
    const double low = double(values[edge]), high = double(values[values.size() - 1 - edge]);
    return fmt::format("{:g}:{:g}", std::max(low, 1e-7), std::max(high, 2 * std::max(low, 1e-7)));
}

}  // namespace

void draw_problems(const ProblemPicture& picture, const std::filesystem::path& stem) {
    const AtomicFolder work(stem.string() + "-maps");  // never committed, so it is removed at the end
    write_values(work.path() / "status.f32", picture.status);
    write_values(work.path() / "iterations.f32", picture.iterations);
    write_values(work.path() / "samples.f32", picture.samples);
    write_values(work.path() / "rms.f32", picture.rms);
    write_file(work.path() / "problems.gp", script);
    std::string quoted;  // the script puts it between single quotes
    for (const char c : work.path().string()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
    draw_figure(work.path() / "problems.gp", stem,
                {{"data", quoted},
                 {"mark", picture.mark},
                 {"width", std::to_string(picture.width)},
                 {"height", std::to_string(picture.height)},
                 {"heading", plain(picture.title)},
                 {"unit", picture.unit},
                 {"status_tics", status_tics(picture)},
                 {"rms_range", rms_range(picture)}});
}

}  // namespace radiafit::harness
