// Table 1 of the paper: what the models are made of, what they need in memory, and how their pixels reach texels.
#include "rows/table1_datasets.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/statistics.h"
#include "cpu/texel_solver.h"
#include "dataset/image_stream.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fitting/solvers/solver.h"
#include "image/png_file.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "samples/image_samples.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::table1_datasets;

struct Options {
    std::vector<std::string> datasets = {"star", "bust", "ornament"};
    int surface_side = 8, view_side = 8, terms = 1;
    int object = 1;
    double texels_per_pixel = 1;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_shape);
        c.read("surface_side", surface_side, limits::map_side);
        c.read("object", object, limits::draw_seed);
        c.read("texels_per_pixel", texels_per_pixel, limits::texels_per_pixel);
        c.read("view_side", view_side, limits::map_side);
        c.read("terms", terms, limits::terms);
        c.finish();
    }
};

/// What the paper's text states of the authors' capture of that name.
struct Stated {
    const char *triangles, *image_bytes;
};
Stated stated_in_paper(const std::string& dataset) {
    if (dataset == "bust") return {"7228", "161 MB"};
    if (dataset == "star") return {"6093", "159 MB"};
    if (dataset == "ornament") return {"3690", "980 MB"};
    return {"not stated", "not stated"};
}

void write_photograph(const Dataset& dataset, const std::filesystem::path& file) {
    TargetImage photograph;
    ImageStream(dataset, StreamSource::disk).load(0, photograph);
    std::vector<uint8_t> rgb;
    for (size_t pixel = 0; pixel < size_t(photograph.width) * size_t(photograph.height); ++pixel) {
        const auto value = photograph.channel16(pixel);
        for (int c = 0; c < 3; ++c) rgb.push_back(uint8_t(value[c] >> 8));
    }
    write_png(file, photograph.width, photograph.height, rgb);
}

/// What one image's pixels find: claim C17 is about surfaces whose texels are finer than the images.
struct ImageCounts {
    uint32_t covered_pixels = 0, kept_pixels = 0;
    uint64_t facing_texels = 0;  ///< of triangles that face the camera, whether or not something hides them
};

uint64_t facing_texels(const TriangleAtlas& atlas, const Camera& camera) {
    const Mesh& mesh = atlas.mesh();
    const Vec3f eye = camera.center().cast<float>();
    uint64_t facing = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const Vec3f &a = mesh.positions[mesh.triangles[t][0]], &b = mesh.positions[mesh.triangles[t][1]];
        const Vec3f& c = mesh.positions[mesh.triangles[t][2]];
        if (!atlas.degenerate(t) && (b - a).cross(c - a).dot(eye - a) > 0) facing += atlas.tile(t).texels();
    }
    return facing;
}

std::vector<ImageCounts> count_images(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                                      const std::vector<uint32_t>& views) {
    const Distributors distributors = make_distributors(atlas, request);
    SampleCollector collector(dataset, atlas.texels_per_tile(), distributors.workers(), request.space);
    std::vector<ImageSamples<Sample>> images(size_t(collector.at_once()));
    std::vector<ImageCounts> counts;
    for (size_t first = 0; first < views.size(); first += images.size()) {
        const size_t count = std::min(images.size(), views.size() - first);
        collector.collect(views, first, std::span(images).first(count));
        for (size_t k = 0; k < count; ++k)
            counts.push_back({images[k].covered_pixels, uint32_t(images[k].samples.size()),
                              facing_texels(atlas, dataset.views[views[first + k]].camera)});
    }
    return counts;
}

/// Writes them; returns the median over images of texels that face the camera per covered pixel.
double write_images(const Dataset& dataset, const std::vector<uint32_t>& views, const std::vector<ImageCounts>& counts,
                    CsvFile<rows::Image> rows) {
    std::vector<double> ratios;
    for (size_t i = 0; i < views.size(); ++i) {
        const ImageCounts& c = counts[i];
        rows.add({dataset.views[views[i]].name, c.covered_pixels, c.kept_pixels, c.facing_texels});
        if (c.covered_pixels) ratios.push_back(double(c.facing_texels) / c.covered_pixels);
    }
    rows.commit();
    return median(ratios);
}

/// The share of texels with fewer samples than that.
double share_below(size_t samples, const std::vector<uint64_t>& histogram) {
    uint64_t below = 0, all = 0;
    for (size_t i = 0; i < histogram.size(); ++i) {
        all += histogram[i];
        below += i < samples ? histogram[i] : 0;
    }
    return double(below) / double(all);
}

/// How often a texel takes two pixels of one image: never, or distribution is broken (Section 5.1.1, claim C17).
uint64_t shared_texels(const SampleList& list) {
    uint64_t shared = 0;
    for (size_t group = 0; group + 1 < list.groups.size(); ++group) {
        std::vector<uint16_t> texels;
        for (const Sample& sample : list.of_group(group)) texels.push_back(sample.local);
        std::sort(texels.begin(), texels.end());
        for (size_t i = 1; i < texels.size(); ++i) shared += texels[i] == texels[i - 1];
    }
    return shared;
}

/// What a dataset's model comes to: a light field map, or, where the light moves, Lafortune's nine numbers per texel.
struct Sizes {
    uint64_t parameters, texels, problems, paper_bytes = 0, engine_bytes = 0;
};

Sizes light_field_sizes(const Dataset& dataset, const FitRequest& request) {
    const LfmOptions& model = request.model;
    const TriangleAtlas atlas = surface_atlas(dataset.mesh, model);
    const LfmLayout layout(VertexRings(dataset.mesh), atlas, model.view_side, model.terms);
    Sizes out{layout.parameter_count(), layout.size() / 4, 3 * layout.problem_count()};
    if (atlas.one_side())
        out.paper_bytes = total_bytes(paper_layout(dataset.mesh.triangle_count(), dataset.mesh.vertex_count(),
                                                   model.surface_side, model.view_side));
    for (const PlanRow& row : plan(dataset, request).memory)
        if (!row.array.starts_with("samples")) out.engine_bytes += row.bytes;
    return out;
}

/// As the paper stores them, in three RGBA maps.
Sizes lafortune_sizes(const Dataset& dataset) {
    const TexelModel& model = *find_texel_model("lafortune");
    const int side = dataset.normal_map.side;
    const uint64_t texels = TriangleAtlas(dataset.mesh, side).texel_count();
    return {texels * uint64_t(model.parameters), texels * uint64_t(model.parameters / 3), texels, 0,
            texel_solvers(model).stream_bytes(texels, 0, {})};
}

void table1(Experiment& experiment) {
    const Options o(experiment.config());
    FitRequest request;
    request.model.surface_side = o.surface_side;
    request.model.view_side = o.view_side;
    request.model.terms = o.terms;
    request.check();
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    CsvFile rows(results.path(), rows::datasets);
    Table table({"dataset", "texels per triangle", "triangles (paper)", "vertices", "images (held out)",
                 "raw images (paper)", "parameters", "parameter texels", "problems", "samples", "pixels kept",
                 "texels per covered pixel (median image)", "samples per texel (median)", "texels without samples",
                 "texels with fewer than 10", "memory, paper's layout", "memory, CPU engine"});
    const auto add = [&](const std::string& shape, const Dataset& dataset, const FitRequest& here) {
        const bool own = here.model.sides != nullptr;
        const std::string name = dataset.name + (own ? "_own_sides" : "");
        const Sizes sizes = dataset.light_moves() ? lafortune_sizes(dataset) : light_field_sizes(dataset, here);
        const TriangleAtlas atlas = surface_atlas(dataset.mesh, here.model);
        const SharedSamples samples = distribute(dataset, atlas, here);
        const DistributionStatistics& s = samples.statistics;
        const std::vector<uint64_t>& histogram = s.texels_taking;
        const std::vector<uint32_t> views = dataset.split(false);
        const double texels_per_pixel = write_images(dataset, views, count_images(dataset, atlas, here, views),
                                                     CsvFile(results.path(), rows::images, {}, name));
        const size_t held_out = dataset.split(true).size();
        rows.add({dataset.name,
                  own ? "own" : "one",
                  dataset.mesh.triangle_count(),
                  dataset.mesh.vertex_count(),
                  dataset.views.size(),
                  held_out,
                  dataset.image_bytes(),
                  sizes.parameters,
                  sizes.texels,
                  sizes.problems,
                  s.samples,
                  s.covered_pixels,
                  s.kept_share(),
                  texels_per_pixel,
                  s.median_samples_per_texel,
                  share_below(1, histogram),
                  share_below(10, histogram),
                  shared_texels(samples.list),
                  sizes.paper_bytes,
                  sizes.engine_bytes});
        const Stated stated = stated_in_paper(shape);
        const auto mega = [](double x, const char* unit) { return fmt::format("{:.2f} {}", x / 1e6, unit); };
        const double mean_texels = double(atlas.used_texels()) / double(dataset.mesh.triangle_count());
        table.add(
            {dataset.name + (own ? ", sides by size" : ""), fmt::format("{:.0f}", mean_texels),
             fmt::format("{} ({})", dataset.mesh.triangle_count(), stated.triangles),
             std::to_string(dataset.mesh.vertex_count()), fmt::format("{} ({})", dataset.views.size(), held_out),
             fmt::format("{:.1f} MB ({})", double(dataset.image_bytes()) / 1e6, stated.image_bytes),
             mega(double(sizes.parameters), "M"), mega(double(sizes.texels), "MT"), std::to_string(sizes.problems),
             mega(double(s.samples), "M"), fmt::format("{:.1f}%", 100 * s.kept_share()),
             fmt::format("{:.2f}", texels_per_pixel), fmt::format("{:g}", s.median_samples_per_texel),
             fmt::format("{:.1f}%", 100 * share_below(1, histogram)),
             fmt::format("{:.1f}%", 100 * share_below(10, histogram)),
             sizes.paper_bytes ? mega(double(sizes.paper_bytes), "MB") : "", mega(double(sizes.engine_bytes), "MB")});

        CsvFile histogram_rows(results.path(), rows::histogram, {}, name);
        for (size_t i = 0; i < histogram.size(); ++i) histogram_rows.add({i, histogram[i]});
        histogram_rows.commit();
    };
    for (const std::string& shape : o.datasets) {
        const Dataset dataset = experiment.dataset(shape, {}, {}, uint64_t(o.object));
        FitRequest here = request;
        if (dataset.light_moves()) here.model.surface_side = dataset.normal_map.side;
        add(shape, dataset, here);
        write_photograph(dataset, results.path() / (dataset.name + ".png"));
        if (dataset.light_moves() || o.texels_per_pixel == 0) continue;
        here.texels_per_pixel = o.texels_per_pixel;
        add(shape, dataset, with_sides(here, dataset, dataset.split(false)));
    }
    rows.commit();
    const std::string title = fmt::format("Table 1, stand-ins at {} scale", experiment.profile());
    log_info(title + "\n" + table.text());
    write_file(
        results.path() / "table1_datasets.md",
        fmt::format(
            "# {}\n\nIn brackets: what the paper states of its own captures, which are not public. "
            "Surface maps of side {} ({} texels; "
            "the paper: 32), or each of a side by its triangle's largest projection into the photographs, {:g} texels "
            "per pixel; view maps {} x {}, {} term(s); of the ornament Lafortune's nine parameters "
            "per texel. A covered pixel sees the model; it is kept if a texel takes it; texels per covered pixel "
            "are those of all triangles that face the camera. Memory: bytes of all vectors and states, "
            "images and samples left out.\n\n{}",
            title, o.surface_side, o.surface_side * (o.surface_side + 1) / 2, o.texels_per_pixel, o.view_side,
            o.view_side, o.terms, table.markdown()));
    experiment.finish(results,
                      fmt::format("Synthetic stand-ins ({} scale) for the paper's captures", experiment.profile()));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("table1_datasets", argc, argv, radiafit::harness::table1);
}
