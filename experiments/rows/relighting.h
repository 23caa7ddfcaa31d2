#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::relighting {
using namespace columns;

struct Method {
    std::string capture, method, made = {};
    std::optional<size_t> numbers = {};
    size_t training, held_out;
    std::optional<double> mean_image_psnr_db, psnr_db;
    double ape;
    std::optional<double> seconds = {};
};
inline const RowFileOf<Method> methods{
    "relighting.csv",
    "One row for each capture and method, on the lamps that the capture holds out.",
    {{"capture", key(), "its name in datasets/captures.md", &Method::capture},
     {"method", key(), "a fit, by its name in the config, which has its options; or a program that made pictures", &Method::method},
     {"made", exact(), "by which options; of pictures nothing", &Method::made},
     {"numbers", exact(), "stored for each texel; of pictures nothing", &Method::numbers},
     {"training held_out", exact(), "images fitted, and held out", &Method::training, &Method::held_out},
     {"mean_image_psnr_db", decibels("{:.4f}"), "mean of the images' own PSNR", &Method::mean_image_psnr_db},
     {"psnr_db", decibels("{:.4f}"), "over the pixels of all held-out images", &Method::psnr_db},
     {"ape", errors("{:.4f}").in("1/255"), "likewise", &Method::ape},
     {"seconds", times("{:.3f}"), "of the fit; of pictures nothing", &Method::seconds}}};

inline const ExperimentEntry experiment{
    .name = "relighting",
    .about =
        "Captures under lamps that move, where they are packed in `datasets/packed` ([datasets/captures.md](../datasets/captures.md)): models judged on lamps that were held out, beside pictures that "
        "other programs made of these.",
    .files = {&methods},
    .place = 155,
    .title = "Captures under moving lamps",
    .tables = {"relighting.md"}};

}  // namespace radiafit::harness::rows_of::relighting
