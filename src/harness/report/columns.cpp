#include "report/columns.h"

#include <algorithm>

namespace radiafit::harness {
namespace {

using Columns = TableRules::Columns;

Columns keys(const char* names) { return {{ColumnKind::key}, names}; }
Columns device(const char* name) { return {{ColumnKind::device}, name}; }
Columns repetition(const char* name) { return {{ColumnKind::repetition}, name}; }
Columns work(const char* names) { return {{ColumnKind::work}, names}; }
Columns exact(const char* names) { return {{ColumnKind::exact}, names}; }
/// PSNR is written with four digits: its last one may round the other way.
Columns decibels(const char* names) { return {{ColumnKind::absolute, 1e-4, "dB"}, names}; }
/// Of what stops on its way.
Columns rough_decibels(const char* names) { return {{ColumnKind::absolute, 0.01, "dB"}, names}; }
/// Shares of problems, texels or vertices: one in a thousand may fall on the other side of a threshold.
Columns shares(const char* names) { return {{ColumnKind::absolute, 1e-3}, names}; }
/// Errors are sums of squares in 32 bits, written with four to eight digits.
Columns errors(const char* names, double tolerance = 1e-4) { return {{ColumnKind::relative, tolerance}, names}; }
/// An error that passes a threshold by a rounding does so one iteration sooner or later.
Columns iterations(const char* names) { return {{ColumnKind::iterations, 1}, names}; }
/// Of such counts.
Columns ratios(const char* names) { return {{ColumnKind::relative, 0.01}, names}; }
Columns times(const char* names) { return {{ColumnKind::time}, names}; }
Columns memory(const char* names) { return {{ColumnKind::memory}, names}; }
Columns told(const char* names) { return {{ColumnKind::told}, names}; }

constexpr bool partial = true;

const std::vector<TableRules>& all_rules() {
    static const std::vector<TableRules> rules = {
        {"table1_datasets",
         "datasets.csv",
         {keys("dataset sides"),
          exact("triangles vertices images held_out parameters parameter_texels problems samples covered_pixels"),
          exact("median_samples_per_texel shared_texels"), shares("kept_share texels_per_pixel"),
          shares("without_samples_share below_10_samples_share"),
          memory("image_bytes paper_layout_bytes cpu_engine_bytes")}},
        {"table1_datasets", "*_samples_per_texel.csv", {keys("samples"), exact("texels")}},
        {"table1_datasets", "*_images.csv", {keys("image"), exact("covered_pixels kept_pixels facing_texels")}},

        {"fig7_convergence",
         "problems.csv",
         {keys("dataset lambda vertex channel"), errors("best_error"), told("best_solver varpro_penalty"),
          iterations("*")}},
        {"fig7_convergence",
         "ends.csv",
         {keys("dataset vertex channel"), errors("cg_error sd_error cg_minimum sd_minimum"),
          iterations("cg_iterations sd_iterations"),
          told("cg_at_rest sd_at_rest cg_minimum_at_rest sd_minimum_at_rest")}},
        {"fig7_convergence",
         "curves.csv",
         {keys("dataset method shown iteration"), exact("vertex channel"), errors("error error_over_best")}},
        {"fig7_convergence",
         "summary.csv",
         {keys("dataset lambda"), exact("problems cap"), ratios("ratio_quartile1 ratio_median ratio_quartile3"),
          iterations("cg_median_iterations sd_median_iterations varpro_median_iterations"),
          shares("cg_censored_share sd_censored_share")}},

        {"captures",
         "captures.csv",
         {keys("capture split method"), exact("training held_out outside"),
          decibels("psnr_db mean_image_psnr_db psnr_inside_db psnr_outside_db"), errors("ape"), times("seconds")}},
        {"captures",
         "images.csv",
         {keys("capture split method image"), exact("pixels degrees_outside"), decibels("psnr_db"), errors("ape")}},

        {"departures",
         "fits.csv",
         {keys("departure without problem optimizer numbers"), told("renderer"), exact("iterations problems"),
          shares("arrived_share stalled_share not_finite_share"), iterations("iterations_median"),
          errors("error error_ratio ape"), decibels("psnr_db held_psnr_db")}},
        {"departures",
         "culling.csv",
         {keys("departure without"), told("renderer"), exact("images same_parameters"),
          exact("fragments operations reads"), ratios("operations_ratio reads_ratio")}},

        // On a software renderer OpenGL runs fewer repetitions.
        {"fig8_time",
         "repetitions.csv",
         {keys("method optimizer threads iterations"), repetition("repetition"), errors("error"),
          times("distribution_s streaming_s optimization_s total_s iteration_s"), told("cached_share")},
         partial},
        {"fig8_time",
         "iterations.csv",
         {keys("method optimizer"), repetition("repetition"), times("seconds streaming_s switching_s"),
          told("cached_share")}},
        {"fig8_time", "work.csv", {keys("method optimizer"), exact("operations reads draws switches")}},
        // Medians of those.
        {"fig8_time",
         "times.csv",
         {keys("method optimizer threads iterations"), work("timed_iterations"), errors("error"),
          shares("agreeing_share"), memory("bytes_written bytes_read"),
          told("distribution_s streaming_s computation_s switching_s remainder_s total_s low_s high_s repetitions"),
          told("source renderer")}},

        {"fig9_error",
         "errors.csv",
         {keys("dataset seed method weights terms"),
          exact("surface_side surface_texels texels_per_pixel view_side mode passes storage sums lambda_surface "
                "lambda_view iterations refills"),
          decibels("train_psnr_db held_psnr_db"), errors("train_ape held_ape"), shares("invented_share"),
          times("seconds"), told("renderer")}},
        {"fig9_error",
         "choice.csv",
         {keys("dataset seed method lambda_surface lambda_view refills"), decibels("validation_psnr_db"),
          errors("validation_ape"), told("chosen")}},

        {"fig10_utilization",
         "iterations.csv",
         {keys("problem optimizer passes"), repetition("repetition"), times("seconds penalties_s"),
          told("cached_share")}},
        {"fig10_utilization",
         "work.csv",
         {keys("problem optimizer passes"), exact("operations reads switches penalty_operations shared_operations"),
          memory("bytes image_bytes")}},
        {"fig10_utilization",
         "passes.csv",
         {keys("problem optimizer passes program"), exact("draws fragments entries operations reads"),
          memory("read_bytes written_bytes blended_bytes")}},
        {"fig10_utilization",
         "peaks.csv",
         {device("device"), keys("peak"), repetition("repetition"), told("per_second")}},
        // Medians of those.
        {"fig10_utilization",
         "utilization.csv",
         {keys("problem optimizer passes"), told("computation_share computation_low computation_high"),
          told("bandwidth_share bandwidth_low bandwidth_high reads_share reads_low reads_high"),
          told("seconds_per_iteration repetitions source renderer")}},

        // PyTorch's sums differ with its version and its threads; the iteration at which it arrives may, too.
        {"peers",
         "curves.csv",
         {keys("setting library solver iteration"), rough_decibels("psnr_db"), errors("error", 0.01), told("seconds")},
         partial},
        {"peers",
         "times.csv",
         {keys("setting library solver"), repetition("repetition"), work("iterations"), times("seconds setup_s"),
          rough_decibels("psnr_db")}},
        // Medians of those.
        {"peers",
         "peers.csv",
         {keys("setting library solver"), exact("reached"), work("iterations"),
          rough_decibels("psnr_db target_db converged_db"), told("seconds seconds_least seconds_most"),
          told("times_ours times_ours_least times_ours_most setup_s setup_s_least setup_s_most repetitions renderer")}},

        {"precision",
         "curves.csv",
         {keys("optimizer storage sums iteration"), errors("error error_over_fp32"), exact("active")}},
        {"precision",
         "finals.csv",
         {keys("optimizer storage sums"), exact("iterations images problems_not_finite"),
          errors("error error_over_fp32 ape"), decibels("psnr psnr_less_fp32"), times("seconds"), told("renderer")}},

        // Distances from the truth of noise-free images are down to the last digits of 32 bits.
        {"reflectance",
         "fits.csv",
         {keys("images method group"), exact("iterations texels"), errors("worst_error_median", 0.01),
          shares("recovered_share within_share"), errors("rms_error", 0.01), iterations("iterations_median"),
          told("renderer")}},
        {"reflectance",
         "times.csv",
         {keys("images method"), exact("distributes texels samples"), times("distribution_s load_s solve_s"),
          told("fits_per_s ns_per_sample_iteration renderer")}},
        {"reflectance",
         "images.csv",
         {keys("images method part"), exact("pixels"), decibels("held_psnr_db"), errors("held_ape"), told("renderer")}},

        {"passes",
         "rounds.csv",
         {keys("step name"), repetition("repetition"), exact("images"), errors("samples"),
          times("ms_per_image_and_sweep"), told("mj_per_image_and_sweep renderer")}},
        {"passes",
         "ladder.csv",
         {keys("step name"), told("median_ms low_ms high_ms over_previous over_first renderer")}},

        {"scaling",
         "memory.csv",
         {keys("engine storage passes side"), exact("triangles vertices parameters"),
          memory("planned_bytes allocated_bytes opengl_bytes paper_layout_bytes"), told("process_bytes")}},
        // OpenGL's samples differ from the CPU's in some pixels, and between devices.
        {"scaling",
         "time.csv",
         {keys("part engine what side images"), repetition("repetition"), exact("texels parameters"), errors("samples"),
          times("seconds"), told("sweep_seconds renderer")}},
        {"scaling", "summary.csv", {keys("of engine"), told("median low high")}},  // of those

        // Who has spent its seconds takes no further vertex, so a slow machine compares fewer; and the best error is
        // the least of all who came.
        {"solvers",
         "problems.csv",
         {keys("solver setting vertex channel"), exact("reached"), iterations("iterations_to_101 iterations"),
          errors("error best_error")},
         partial},
        {"solvers", "vertices.csv", {keys("solver setting vertex"), exact("reached"), told("seconds_to_101")}, partial},
        {"solvers",
         "repetitions.csv",
         {keys("solver setting"), repetition("repetition"), work("vertices"), times("seconds_to_101 seconds_total")}},
        {"solvers",
         "solvers.csv",
         {keys("solver setting"), exact("threads"), work("vertices problems"), shares("reached_share"),
          iterations("iterations_median"), errors("final_over_best_median"),
          told("seconds_to_101 seconds_to_101_least seconds_to_101_most seconds_setup seconds_total repetitions"),
          told("times_cg_modern times_cg_modern_median times_varpro times_varpro_median")}},

        {"stopping",
         "problems.csv",
         {keys("rule levels optimizer vertex channel"), iterations("stopped_at arrived_at"),
          errors("error_over_best")}},
        {"stopping", "weights.csv", {keys("vertex"), errors("weight")}},
        {"stopping",
         "curves.csv",
         {keys("rule levels optimizer iteration"), shares("active_share"), errors("median_error_over_best")}},
        {"stopping",
         "rules.csv",
         {keys("rule levels optimizer"), exact("iterations"), iterations("first_below_half median_reached"),
          errors("median_error_over_best"), shares("mean_active_share short_of_best_share")}},

        {"streaming",
         "iterations.csv",
         {keys("problem passes source"), repetition("repetition"),
          times("line_s line_streaming_s direction_s direction_streaming_s"), told("cached_share")}},
        // Medians of those.
        {"streaming",
         "times.csv",
         {keys("problem passes optimizer source"), told("seconds_per_iteration low_s high_s streaming_s"),
          told("streaming_share over_disk_cold repetitions renderer")}},

        // Of the devices that were asked for and are there; OpenGL's samples differ from the CPU's in some pixels.
        {"bench", "scenes.csv", {keys("problem"), exact("images sites parameters"), errors("samples")}},
        {"bench",
         "agreement.csv",
         {keys("problem device quantity"), exact("agrees"), told("difference tolerance")},
         partial},
        {"bench",
         "rows.csv",
         {keys("problem device pass"), repetition("repetition"), times("seconds"), told("streaming_s")},
         partial},
        {"bench", "peaks.csv", {keys("device peak"), repetition("repetition"), told("per_second")}, partial},
        // Medians of those.
        {"bench",
         "summary.csv",
         {keys("problem device pass"), told("seconds low_s high_s ms_per_image ns_per_sample"),
          told("operations reads bytes operations_share reads_share bytes_share repetitions renderer")},
         partial},
    };
    return rules;
}

}  // namespace

TableRules::TableRules(const char* experiment, const char* file, std::vector<Columns> columns, bool partial)
    : experiment_(experiment), file_(file), partial_(partial) {
    for (const Columns& group : columns)
        for (std::string_view rest = group.names; !rest.empty();) {
            const size_t end = std::min(rest.find(' '), rest.size());
            columns_.emplace_back(rest.substr(0, end), group.rule);
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
}

bool TableRules::covers(std::string_view experiment, std::string_view file) const {
    if (experiment != experiment_) return false;
    return file_.starts_with('*') ? file.ends_with(file_.substr(1)) : file == file_;
}

const ColumnRule* TableRules::rule(std::string_view column) const {
    const auto found =
        std::ranges::find_if(columns_, [&](const auto& c) { return c.first == column || c.first == "*"; });
    return found == columns_.end() ? nullptr : &found->second;
}

const TableRules* find_table_rules(std::string_view experiment, std::string_view file) {
    const auto found =
        std::ranges::find_if(all_rules(), [&](const TableRules& t) { return t.covers(experiment, file); });
    return found == all_rules().end() ? nullptr : &*found;
}

}  // namespace radiafit::harness
