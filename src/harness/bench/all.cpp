#include "bench/all.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/program.h"
#include "base/read_file.h"
#include "report/result_archive.h"
#include "report/table.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

struct Part {
    std::string name;
    std::vector<std::string> command;
};

/// Each to be run in a checkout.
std::vector<Part> parts_of(const BenchOptions& o, const std::string& program,
                           std::span<const BundledExperiment> bundle) {
    std::vector<Part> parts = {
        {"bench", {program, "--scale", o.scale, "--repetitions", std::to_string(o.repetitions), "-o", "results"}}};
    // Said, or software alone would be refused.
    if (o.chosen_renderer)
        for (const std::string& word : {std::string("--platform"), to_string(o.context.kind)})
            parts[0].command.push_back(word);
    if (o.context.device >= 0)
        for (const std::string& word : {std::string("--gpu"), std::to_string(o.context.device)})
            parts[0].command.push_back(word);
    for (const BundledExperiment& e : bundle)
        parts.push_back({e.name,
                         {program, "--part", e.name, "--config", fmt::format("experiments/{}.toml", e.name),
                          "--profile", o.scale}});
    for (Part& part : parts)
        if (o.threads > 0) part.command.insert(part.command.end(), {"--threads", std::to_string(o.threads)});
    return parts;
}

std::string how_it_ended(int status) {
    if (status == 0) return "measured";
    if (status == 128 + SIGALRM) return "took too long";
    if (status > 128) return fmt::format("crashed ({})", strsignal(status - 128));
    return fmt::format("failed (exit status {})", status);
}

/// What a checkout has for experiments.
void make_checkout(const fs::path& root, std::span<const BundledExperiment> bundle) {
    for (const char* folder : {"experiments", "paper_figs", "results"}) fs::create_directories(root / folder);
    for (const BundledExperiment& e : bundle)
        write_file(root / "experiments" / (std::string(e.name) + ".toml"), e.config);
}

}  // namespace

int measure_all(const BenchOptions& o, const std::string& program, std::span<const BundledExperiment> bundle) {
    // Beside the archive: on a disk, which the system's temporary folder need not be, and images are read from one.
    const fs::path archive = fs::absolute(o.output);
    const UnfinishedFolder root(archive.parent_path(), "radiafit-bench");
    make_checkout(root.path(), bundle);
    // What keeps it from being written shows before any work.
    if (path_exists(archive))
        const AtomicFile tried(archive);
    else
        write_result_archive(root.path() / "results", archive);
    if (o.context.kind == ContextKind::osmesa)
        setenv("RADIAFIT_OPENGL", "osmesa", 1);
    else if (o.context.device >= 0)
        setenv("RADIAFIT_OPENGL", std::to_string(o.context.device).c_str(), 1);
    catch_interrupts();
    const double end = wall_time_s() + 60 * o.minutes;
    const std::vector<Part> parts = parts_of(o, program, bundle);
    Table table({"part", "seconds", ""});
    bool failed = false;
    for (size_t i = 0; i < parts.size(); ++i) {
        const double start = wall_time_s(), left = std::max(6.0, (end - start) / double(parts.size() - i));
        log_info(fmt::format("{} of {}: {}", i + 1, parts.size(), parts[i].name));
        std::vector<std::string> command = parts[i].command;
        command.insert(command.end(), {"--minutes", fmt::format("{:.3f}", left / 60)});
        // Rounds end in time; what comes before them, and after, may take longer.
        const int status = run_in_front(command, root.path(), unsigned(4 * left + 60));
        table.add({parts[i].name, fmt::format("{:.0f}", wall_time_s() - start), how_it_ended(status)});
        failed |= status != 0;
        write_result_archive(root.path() / "results", archive);
        try {
            throw_if_interrupted();
        } catch (Interrupted& interrupted) {
            interrupted.note = fmt::format("what was measured is in {}", o.output.string());
            throw;
        }
    }
    fmt::print("{}\nresults: {}\n", table.text(), o.output.string());
    return failed ? 1 : 0;
}

}  // namespace radiafit::harness
