#include "bench/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "base/config.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/range.h"
#include "base/read_file.h"
#include "base/record.h"
#include "command_line/command_line.h"

namespace radiafit::harness {
namespace {

const std::vector<std::string> scales = {"smoke", "standard", "paper"};
const std::vector<std::string> platforms = {"egl", "osmesa"};

/// The devices behind a name of the command line.
const std::vector<std::pair<std::string, std::vector<Device>>> groups = {
    {"cpu", {Device::cpu, Device::one_thread}},
    {"fragment", {Device::paper_passes, Device::combined_passes}},
    {"compute", {Device::compute, Device::redistributing, Device::scattering}}};

std::vector<std::string> group_names() {
    std::vector<std::string> names;
    for (const auto& [name, devices] : groups) names.push_back(name);
    return names;
}

void require_name(const char* option, const std::string& name, const std::vector<std::string>& names) {
    if (std::ranges::find(names, name) == names.end())
        throw UserError(fmt::format("{} '{}' does not exist; choose {} (nearest: {})", option, name,
                                    fmt::join(names, ", "), nearest(name, names)));
}

std::vector<Device> devices_of(const std::vector<std::string>& names) {
    std::set<Device> chosen;
    for (const auto& [name, devices] : groups)
        if (std::ranges::find(names, name) != names.end()) chosen.insert(devices.begin(), devices.end());
    if (thread_count() == 1) chosen.erase(Device::one_thread);  // the same as cpu
    return {chosen.begin(), chosen.end()};
}

/// "a,b" is two.
std::vector<std::string> split(const std::vector<std::string>& texts) {
    std::vector<std::string> parts;
    for (const std::string& text : texts) {
        std::istringstream in(text);
        for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
    }
    return parts;
}

}  // namespace

std::optional<BenchOptions> parse_bench_options(int argc, const char* const* argv) {
    BenchOptions options;
    std::vector<std::string> devices;
    std::string platform = "egl", repetitions = "9", gpu, threads = "0", minutes, output = options.output.string();
    CommandLine program("radiafit-bench",
                        "Checks every device of this machine against sums in double, then times them and says what "
                        "share of the machine's measured peaks they reach.",
                        fmt::format("radiafit-bench {} ({})", project_version(), git_revision()));
    program.add_word("--scale", options.scale, "smoke, standard or paper: sizes of star, bust and ornament");
    program.add_words("--device", devices,
                      "cpu, fragment and compute, as unless given, or some of them between commas");
    program.add_word("--repetitions", repetitions, "rounds; an interval of 95 % needs six, better nine");
    program.add_word("--platform", platform, "egl, or osmesa: Mesa in software");
    program.add_word("--gpu", gpu, "EGL's device by its number in --list; unless told, a GPU where there is one");
    program.add_word("--threads", threads, "of the CPU; 0 is all cores");
    program.add_word("-o,--output", output,
                     "folder of results: rows go to bench/DEVICE/RUN in it; of --all a file, NAME.tar");
    program.add_flag("--replace", options.replace, "of --all: put the new archive in the place of one that is there");
    program.add_flag("--all", options.all,
                     "the figures and claims about a chip's time, too, each in a process of its own, into one archive");
    program.add_word("--minutes", minutes, "end rounds in time to be done in so many; of --all 10 unless told");
    program.add_flag("--list", options.list, "only tell the devices that there are");
    if (!program.parse(argc, argv)) return std::nullopt;
    devices = devices.empty() ? group_names() : split(devices);
    require_name("--scale", options.scale, scales);
    require_name("--platform", platform, platforms);
    for (const std::string& name : devices) require_name("--device", name, group_names());
    options.repetitions = parse_number("--repetitions", repetitions, Range<int>{1, 1'000'000});
    options.threads = parse_number("--threads", threads, Range<int>{0, 1024, "0 is all cores"});
    set_thread_count(options.threads);
    options.minutes = program.given("--minutes") ? parse_number("--minutes", minutes, Range<double>{0.01, 1e5})
                                                 : (options.all ? 10 : 0);
    options.context.kind = context_kind_from(platform);
    if (program.given("--gpu"))
        options.context.device = parse_number("--gpu", gpu, Range<int>{0, 1023, "--list tells which there are"});
    if (output.empty()) throw UserError("--output is empty: name a folder");
    options.output = options.all && !program.given("--output") ? "results.tar" : output;
    if (options.all && options.output.extension() != ".tar")
        throw UserError(fmt::format("--output {}: --all writes one archive; name a file that ends in .tar", output));
    if (options.replace && !options.all)
        throw UserError("--replace is of --all; without it every run has a folder of its own: leave it out");
    if (options.all && !options.replace && path_exists(options.output))
        throw UserError(
            fmt::format("{}: is there already; --replace puts this one in its place, or choose another name",
                        options.output.string()));
    if (options.all && program.given("--device"))
        throw UserError("--device means nothing with --all, which measures them all; leave it out");
    options.chosen_renderer = program.given("--platform") || program.given("--gpu");
    options.devices = devices_of(devices);
    if (options.chosen_renderer && std::ranges::none_of(options.devices, needs_opengl))
        throw UserError("--platform and --gpu mean nothing without the devices fragment or compute; leave them out");
    options.every_device = options.devices == devices_of(group_names());
    return options;
}

}  // namespace radiafit::harness
