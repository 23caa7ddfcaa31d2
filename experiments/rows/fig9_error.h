#pragma once
#include "report/experiments.h"
#include "report/half_rows.h"

namespace radiafit::harness::rows_of::fig9_error {
using namespace columns;

/// Options are texts as the command line has them, empty where they mean nothing to the fit.
struct Error {
    std::string dataset, seed, method, weights, terms;
    int surface_side;
    std::string view_side, mode, passes, storage, sums, iterations, refills, lambda_surface, lambda_view;
    double train_psnr_db, train_ape, held_psnr_db, held_ape;
    std::optional<double> invented_share;
    double seconds, surface_texels;
    std::string texels_per_pixel, renderer;
};
inline const RowFileOf<Error> errors{
    "errors.csv",
    "One row for each fit.",
    {{"dataset", key(), "its name", &Error::dataset},
     {"seed", key(), "that the dataset was made from", &Error::seed},
     {"method", key(), "mean, one colour for each texel; pca-published and pca-refilled; nonlinear: cg and others at high or low resolution, on the CPU or in OpenGL with 16-bit floats",
      &Error::method},
     {"weights", key(), "of the smoothness: chosen on validation views, or the weight itself; empty: there are none", &Error::weights},
     {"terms", key(), "of the light field map", &Error::terms},
     {"surface_side view_side", exact().in("texels"), "of the maps; of surface maps of several sides, the largest", &Error::surface_side, &Error::view_side},
     {"mode", exact(), "of the optimizer: paper or modern", &Error::mode},
     {"passes storage sums", exact(), "of OpenGL: kind of passes, and the floats of parameters and of sums", &Error::passes, &Error::storage, &Error::sums},
     {"iterations", exact(), "of nonlinear fits", &Error::iterations},
     {"refills", exact(), "of PCA: how often values that no image shows are filled in anew", &Error::refills},
     {"lambda_surface lambda_view", exact(), "weights of the smoothness of either kind of maps", &Error::lambda_surface, &Error::lambda_view},
     {"train_psnr_db", decibels("{:.4f}"), "of training images", &Error::train_psnr_db},
     {"train_ape", columns::errors("{:.4f}").in("1/255"), "of training images", &Error::train_ape},
     {"held_psnr_db", decibels("{:.4f}"), "of held-out images", &Error::held_psnr_db},
     {"held_ape", columns::errors("{:.4f}").in("1/255"), "of held-out images", &Error::held_ape},
     {"invented_share", shares("{:.5f}"), "of PCA's matrix that no image shows", &Error::invented_share},
     {"seconds", times("{:.3f}"), "of the fit; PCA as published and refilled are fitted in one go, and have the time of both", &Error::seconds},
     {"surface_texels", exact("{:.1f}").in("texels"), "of a surface map, mean over triangles", &Error::surface_texels},
     {"texels_per_pixel", exact().in("texels"), "that triangles have for a pixel of their largest projection, where their maps differ in side; 0: they do not", &Error::texels_per_pixel},
     {"renderer", shown(), "", &Error::renderer}}};

struct Choice {
    std::string dataset, seed, method, lambda_surface, lambda_view, refills;
    double validation_psnr_db, validation_ape;
    bool chosen;
};
inline const RowFileOf<Choice> choice{
    "choice.csv",
    "One row for each setting that was tried on validation views, which are training views left out for it.",
    {{"dataset seed method", key(), as_before, &Choice::dataset, &Choice::seed, &Choice::method},
     {"lambda_surface lambda_view refills", key(), as_before, &Choice::lambda_surface, &Choice::lambda_view, &Choice::refills},
     {"validation_psnr_db", decibels("{:.4f}"), "", &Choice::validation_psnr_db},
     {"validation_ape", columns::errors("{:.4f}").in("1/255"), "", &Choice::validation_ape},
     {"chosen", shown(), "1: the best of its method", &Choice::chosen}}};

inline const ExperimentEntry experiment{
    .name = "fig9_error",
    .about =
        "Figure 9: PSNR and average pixel error, on training and held-out views, of factorization (PCA) and nonlinear optimization at one high resolution, and of the CPU in 32-bit and OpenGL in "
        "16-bit floats at a low one, by number of terms; `--set capture=DATASET` adds a capture of your own.",
    .files = {&errors, &choice, &halves},
    .place = 40,
    .title = "Figure 9: error of four methods",
    .section = "6.4, Figure 9",
    .paper =
        "One term, the star: nonlinear optimization is better than factorization (PCA) at the same high resolution, 144 texels in a surface map on average and 256 in a view map. At a low resolution "
        "the CPU in 32 bits and the GPU in 16 bits are “very similar to each other”, their errors “much higher”. The values of PSNR and of the average pixel error are not in our text.",
    .figure = "Dots: PSNR and the average pixel error of each method, on training and on held-out images of star and bust; below, PSNR by the number of terms.",
    .tables = {"fig9_error.md"}};

}  // namespace radiafit::harness::rows_of::fig9_error
