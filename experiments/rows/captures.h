#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::captures {
using namespace columns;

struct Capture {
    std::string capture, split, method;
    size_t training, held_out, outside;
    std::optional<double> psnr_db;
    double ape;
    std::optional<double> mean_image_psnr_db, psnr_inside_db, psnr_outside_db;
    double seconds;
};
inline const RowFileOf<Capture> figures{
    "captures.csv",
    "One row for each real capture, way of holding out images, and method.",
    {{"capture", key(), "its name in datasets/captures.md", &Capture::capture},
     {"split", key(), "how images are held out: every nth, spread over directions, or each alone", &Capture::split},
     {"method", key(), "a fit, by its name in the config, which has its options; the mean colour of each texel; or a model that keeps every photograph", &Capture::method},
     {"training held_out outside", exact(), "images fitted, held out, and of these those beyond the directions of the fitted ones", &Capture::training, &Capture::held_out, &Capture::outside},
     {"psnr_db", decibels("{:.4f}"), "over the pixels of all held-out images", &Capture::psnr_db},
     {"ape", errors("{:.4f}").in("1/255"), "likewise", &Capture::ape},
     {"mean_image_psnr_db", decibels("{:.4f}"), "mean of the images' own PSNR", &Capture::mean_image_psnr_db},
     {"psnr_inside_db psnr_outside_db", decibels("{:.4f}"), "over images amid the fitted directions, and beyond them", &Capture::psnr_inside_db, &Capture::psnr_outside_db},
     {"seconds", times("{:.3f}"), "of all the method's fits", &Capture::seconds}}};

struct Image {
    std::string capture, split, method, image;
    uint64_t pixels;
    std::optional<double> psnr_db;
    double ape, degrees_outside;
};
inline const RowFileOf<Image> images{
    "images.csv",
    "One row for each held-out image.",
    {{"capture split method", key(), as_before, &Image::capture, &Image::split, &Image::method},
     {"image", key(), "its name", &Image::image},
     {"pixels", exact(), "that were judged", &Image::pixels},
     {"psnr_db", decibels("{:.4f}"), "", &Image::psnr_db},
     {"ape", errors("{:.4f}").in("1/255"), "", &Image::ape},
     {"degrees_outside", exact("{:.2f}").in("degrees"), "its lamp or camera lies beyond the fitted directions; 0 or less: amid them", &Image::degrees_outside}}};

inline const ExperimentEntry experiment{
    .name = "captures",
    .about =
        "Real captures, where they are packed in `datasets/packed` ([datasets/captures.md](../datasets/captures.md)): fits judged on images held out by two rules, inside and outside the directions "
        "of the others.",
    .files = {&figures, &images},
    .place = 150,
    .title = "Real captures",
    .tables = {"captures.md"}};

}  // namespace radiafit::harness::rows_of::captures
