#pragma once
#include "report/experiments.h"
#include "report/half_rows.h"

namespace radiafit::harness::rows_of::precision {
using namespace columns;

struct Point {
    std::string optimizer, storage, sums;
    int iteration;
    double error, error_over_fp32;
    uint64_t active;
};
inline const RowFileOf<Point> curves{
    "curves.csv",
    "The error of each fit, iteration by iteration.",
    {{"optimizer", key(), "cg or sd", &Point::optimizer},
     {"storage", key(), "of parameters: fp32; fp16, rounded; fp16-truncate, as OpenGL writes halves", &Point::storage},
     {"sums", key(), "what sums over samples are taken in", &Point::sums},
     {"iteration", key(), "0 is the start", &Point::iteration},
     {"error", errors("{:.8g}").in("E_t"), "the sum over problems", &Point::error},
     {"error_over_fp32", errors("{:.8g}"), "over that with 32 bits throughout", &Point::error_over_fp32},
     {"active", exact(), "problems that have not stopped", &Point::active}}};

struct Final {
    std::string optimizer, storage, sums;
    int iterations;
    size_t images;
    double error, error_over_fp32, psnr, ape, psnr_less_fp32;
    size_t problems_not_finite;
    double seconds;
    std::string renderer;
};
inline const RowFileOf<Final> finals{
    "finals.csv",
    "One row for each fit.",
    {{"optimizer storage sums", key(), as_before, &Final::optimizer, &Final::storage, &Final::sums},
     {"iterations images", exact(), "of the fit", &Final::iterations, &Final::images},
     {"error", errors("{:.8g}").in("E_t"), "at the end: the sum over problems", &Final::error},
     {"error_over_fp32", errors("{:.6f}"), as_before, &Final::error_over_fp32},
     {"psnr", decibels("{:.4f}"), "of training images", &Final::psnr},
     {"ape", errors("{:.4f}").in("1/255"), "of training images", &Final::ape},
     {"psnr_less_fp32", decibels("{:.4f}"), "the difference to that with 32 bits", &Final::psnr_less_fp32},
     {"problems_not_finite", exact(), "that ended at no number", &Final::problems_not_finite},
     {"seconds", times("{:.3f}"), "of the fit", &Final::seconds},
     {"renderer", shown(), "", &Final::renderer}}};

inline const ExperimentEntry experiment{
    .name = "precision",
    .about = "What 16-bit floats cost: storage and sums apart.",
    .files = {&curves, &finals, &halves},
    .place = 100,
    .title = "What 16-bit floats cost",
    .section = "6.3, 6.4",
    .paper = "16-bit floats had no “detrimental effect” on convergence. No values are given.",
    .figure = "Two plots of how far the error departs from that of 32 bits, by iteration, for conjugate gradients and steepest descent; beside them bars of PSNR at the end, less that of 32 bits.",
    .tables = {"finals.csv"}};

}  // namespace radiafit::harness::rows_of::precision
