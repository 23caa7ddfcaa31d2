// Table 1 of the paper: what the models are made of, what they need in memory, and how their pixels reach texels.
#include <fmt/format.h>

#include <algorithm>

#include "app/limits.h"
#include "base/atomic_file.h"
#include "base/log.h"
#include "capture/png_file.h"
#include "cpu/texel_solver.h"
#include "dataset/image_stream.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

struct Options {
    std::vector<std::string> datasets = {"star", "bust", "ornament"};
    int surface_side = 8, view_side = 8, terms = 1;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_shape);
        c.read("surface_side", surface_side, limits::map_side);
        c.read("view_side", view_side, limits::map_side);
        c.read("terms", terms, limits::terms);
        c.finish();
    }
};

/// What the paper's text states of its own capture of that name.
struct Stated {
    const char *triangles, *image_bytes;
};
Stated stated_in_paper(const std::string& dataset) {
    if (dataset == "bust") return {"7228", "161 MB"};
    if (dataset == "star") return {"6093", "159 MB"};
    if (dataset == "ornament") return {"3690", "980 MB"};
    return {"not stated", "not stated"};
}

/// One photograph of each dataset beside the others, rows of the tallest filled with white.
void draw_photographs(const std::vector<Dataset>& datasets, const std::filesystem::path& file) {
    std::vector<TargetImage> photographs(datasets.size());
    int width = 0, height = 0;
    for (size_t i = 0; i < datasets.size(); ++i) {
        ImageStream(datasets[i], StreamSource::disk).load(0, photographs[i]);
        width += photographs[i].width;
        height = std::max(height, photographs[i].height);
    }
    std::vector<uint8_t> rgb(size_t(3) * width * height, 255);
    int left = 0;
    for (const TargetImage& photograph : photographs) {
        for (int y = 0; y < photograph.height; ++y)
            for (int x = 0; x < photograph.width; ++x) {
                const auto value = photograph.channel16(size_t(y) * photograph.width + x);
                for (int c = 0; c < 3; ++c) rgb[3 * (size_t(y) * width + left + x) + c] = uint8_t(value[c] >> 8);
            }
        left += photograph.width;
    }
    write_png(file, width, height, rgb);
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
    int side;
    uint64_t parameters, texels, problems, paper_bytes = 0, engine_bytes = 0;
};

Sizes light_field_sizes(const Dataset& dataset, const FitRequest& request) {
    const LfmOptions& model = request.model;
    const TriangleAtlas atlas(dataset.mesh, model.surface_side);
    const LfmLayout layout(VertexRings(dataset.mesh), int(atlas.texels_per_tile()), model.view_side, model.terms);
    Sizes out{model.surface_side, layout.parameter_count(), layout.size() / 4, 3 * layout.problem_count()};
    out.paper_bytes = total_bytes(
        paper_layout(dataset.mesh.triangle_count(), dataset.mesh.vertex_count(), model.surface_side, model.view_side));
    for (const PlanRow& row : plan(dataset, request).memory)
        if (!row.array.starts_with("samples")) out.engine_bytes += row.bytes;
    return out;
}

/// As the paper stores them, in three RGBA maps.
Sizes lafortune_sizes(const Dataset& dataset) {
    const TexelModel& model = *find_texel_model("lafortune");
    const int side = dataset.normal_map.side;
    const uint64_t texels = TriangleAtlas(dataset.mesh, side).texel_count();
    return {side,
            texels * uint64_t(model.parameters),
            texels * uint64_t(model.parameters / 3),
            texels,
            0,
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
    CsvWriter rows(results.path() / "datasets.csv",
                   {"dataset", "triangles", "vertices", "images", "held_out", "image_bytes", "parameters",
                    "parameter_texels", "problems", "samples", "covered_pixels", "kept_share",
                    "median_samples_per_texel", "shared_texels", "paper_layout_bytes", "cpu_engine_bytes"});
    Table table({"dataset", "triangles (paper)", "vertices", "images (held out)", "raw images (paper)", "parameters",
                 "parameter texels", "problems", "samples", "pixels kept", "samples per texel (median)",
                 "memory, paper's layout", "memory, CPU engine"});
    std::vector<Dataset> datasets;
    for (const std::string& shape : o.datasets) {
        datasets.push_back(experiment.dataset(shape));
        const Dataset& dataset = datasets.back();
        const Sizes sizes = dataset.light_moves() ? lafortune_sizes(dataset) : light_field_sizes(dataset, request);
        const TriangleAtlas atlas(dataset.mesh, sizes.side);
        FitRequest here = request;
        here.model.surface_side = sizes.side;
        const SharedSamples samples = distribute(dataset, atlas, here);
        const DistributionStatistics& s = samples.statistics;
        const size_t held_out = dataset.split(true).size();
        rows.row({dataset.name, std::to_string(dataset.mesh.triangle_count()),
                  std::to_string(dataset.mesh.vertex_count()), std::to_string(dataset.views.size()),
                  std::to_string(held_out), std::to_string(dataset.image_bytes()), std::to_string(sizes.parameters),
                  std::to_string(sizes.texels), std::to_string(sizes.problems), std::to_string(s.samples),
                  std::to_string(s.covered_pixels), fmt::format("{:.4f}", s.kept_share()),
                  fmt::format("{:g}", s.median_samples_per_texel), std::to_string(shared_texels(samples.list)),
                  std::to_string(sizes.paper_bytes), std::to_string(sizes.engine_bytes)});
        const Stated stated = stated_in_paper(shape);
        const auto mega = [](double x, const char* unit) { return fmt::format("{:.2f} {}", x / 1e6, unit); };
        table.add({dataset.name, fmt::format("{} ({})", dataset.mesh.triangle_count(), stated.triangles),
                   std::to_string(dataset.mesh.vertex_count()), fmt::format("{} ({})", dataset.views.size(), held_out),
                   fmt::format("{:.1f} MB ({})", double(dataset.image_bytes()) / 1e6, stated.image_bytes),
                   mega(double(sizes.parameters), "M"), mega(double(sizes.texels), "MT"),
                   std::to_string(sizes.problems), mega(double(s.samples), "M"),
                   fmt::format("{:.1f}%", 100 * s.kept_share()), fmt::format("{:g}", s.median_samples_per_texel),
                   sizes.paper_bytes ? mega(double(sizes.paper_bytes), "MB") : "",
                   mega(double(sizes.engine_bytes), "MB")});

        CsvWriter histogram(results.path() / (dataset.name + "_samples_per_texel.csv"), {"samples", "texels"});
        std::vector<uint64_t> counts;
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
            if (!atlas.usable(texel)) continue;
            counts.resize(std::max<size_t>(counts.size(), s.samples_per_texel[texel] + 1));
            ++counts[s.samples_per_texel[texel]];
        }
        for (size_t i = 0; i < counts.size(); ++i) histogram.row({std::to_string(i), std::to_string(counts[i])});
        histogram.commit();
    }
    rows.commit();
    results.commit();
    const std::string title = fmt::format("Table 1, stand-ins at {} scale", experiment.profile());
    log_info(title + "\n" + table.text());
    write_file(experiment.figures() / "table1_datasets.md",
               fmt::format("# {}\n\nIn brackets: what the paper states of its own captures, which are not public. "
                           "Surface maps of side {} ({} texels; "
                           "the paper: 32), view maps {} x {}, {} term(s); of the ornament Lafortune's nine parameters "
                           "per texel. Memory: bytes of all vectors and states, "
                           "images and samples left out.\n\n{}",
                           title, o.surface_side, o.surface_side * (o.surface_side + 1) / 2, o.view_side, o.view_side,
                           o.terms, table.markdown()));
    draw_photographs(datasets, experiment.figures() / "table1_datasets.png");
    log_info(fmt::format("table: {}; rows: {}", (experiment.figures() / "table1_datasets.md").string(),
                         results.path().string()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("table1_datasets", argc, argv, radiafit::table1); }
