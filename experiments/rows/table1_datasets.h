#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::table1_datasets {
using namespace columns;

struct Dataset {
    std::string dataset, sides;
    uint64_t triangles, vertices, images, held_out, image_bytes, parameters, parameter_texels, problems, samples, covered_pixels;
    double kept_share, texels_per_pixel, median_samples_per_texel, without_samples_share, below_10_samples_share;
    uint64_t shared_texels, paper_layout_bytes, cpu_engine_bytes;
};
inline const RowFileOf<Dataset> datasets{
    "datasets.csv",
    "One row for each dataset and way to choose sides.",
    {{"dataset", key(), "its name", &Dataset::dataset},
     {"sides", key(), "of surface maps: one for all triangles, or own, by the size of each triangle in photographs", &Dataset::sides},
     {"triangles vertices", exact(), "of the mesh", &Dataset::triangles, &Dataset::vertices},
     {"images held_out", exact(), "all views, and how many of them are not fitted but judged", &Dataset::images, &Dataset::held_out},
     {"image_bytes", memory(), "of all images, raw", &Dataset::image_bytes},
     {"parameters", exact(), "of the model over the whole surface", &Dataset::parameters},
     {"parameter_texels", exact().in("texels"), "that hold them, of four numbers for a light field map and of three for Lafortune's model", &Dataset::parameter_texels},
     {"problems", exact(), "independent optimization problems", &Dataset::problems},
     {"samples", exact(), "pixels that texels take, over all training images", &Dataset::samples},
     {"covered_pixels", exact().in("pixels"), "that show the model, over all training images", &Dataset::covered_pixels},
     {"kept_share", shares("{:.4f}"), "of these that a texel takes", &Dataset::kept_share},
     {"texels_per_pixel", shares("{:.4f}").in("texels"), "that face the camera, per covered pixel; median over training images", &Dataset::texels_per_pixel},
     {"median_samples_per_texel", exact("{:g}"), "over the texels of triangles that have an area", &Dataset::median_samples_per_texel},
     {"without_samples_share below_10_samples_share", shares("{:.4f}"), "of these texels with no sample, and with fewer than 10", &Dataset::without_samples_share, &Dataset::below_10_samples_share},
     {"shared_texels", exact(), "how often a texel takes two pixels of one image", &Dataset::shared_texels},
     {"paper_layout_bytes", memory(), "of conjugate gradients by Section 6.3's accounting; 0 for Lafortune's model, and where sides differ", &Dataset::paper_layout_bytes},
     {"cpu_engine_bytes", memory(), "of the CPU engine, samples left out", &Dataset::cpu_engine_bytes}}};

struct Bin {
    size_t samples;
    uint64_t texels;
};
inline const RowFileOf<Bin> histogram{
    "*_samples_per_texel.csv",
    "How many texels have so many samples.",
    {{"samples", key(), "of a texel, over all training images", &Bin::samples}, {"texels", exact(), "that have so many", &Bin::texels}}};

struct Image {
    std::string image;
    uint64_t covered_pixels, kept_pixels, facing_texels;
};
inline const RowFileOf<Image> images{
    "*_images.csv",
    "One row for each training image.",
    {{"image", key(), "the view's name", &Image::image},
     {"covered_pixels", exact().in("pixels"), "that show the model", &Image::covered_pixels},
     {"kept_pixels", exact().in("pixels"), "that a texel takes", &Image::kept_pixels},
     {"facing_texels", exact().in("texels"), "of the triangles that face the camera, whether or not others hide them", &Image::facing_texels}}};

inline const ExperimentEntry experiment{
    .name = "table1_datasets",
    .about = "Table 1 and Section 6.3: triangles, parameters, texels, bytes and images of the stand-ins for the paper's models; how many pixels reach a texel.",
    .files = {&datasets, &histogram, &images},
    .place = 10,
    .title = "Table 1: the models",
    .section = "6, 6.3, Table 1",
    .paper =
        "Three models: bust, 7,228 triangles and 161 MB of images; star, 6,093 and 159 MB; ornament, 3,690 and 0.98 GB. Surface maps of 32 texels and view maps of 8 × 8; of the ornament 128 texels "
        "per triangle, nine parameters each. The counts of parameters, of texture texels and of images are not in our text. The captures are not public: ours are synthetic stand-ins.",
    .figure =
        "One column for each model and way to choose the sides of its surface maps: an image of it, and below it the share of its texels that get at most so many samples, with a mark at 10 samples.",
    .tables = {"table1_datasets.md"}};

}  // namespace radiafit::harness::rows_of::table1_datasets
