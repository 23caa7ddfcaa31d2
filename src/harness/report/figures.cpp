#include "report/figures.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/program.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

/// name='value' with quotes doubled, as gnuplot reads a single-quoted string.
std::string assignment(const std::string& name, const std::string& value) {
    std::string text = name + "='";
    for (const char c : value) {
        if (c == '\'') text += '\'';
        text += c;
    }
    return text + '\'';
}

/// A file that gnuplot was stopped in the middle of lacks its end.
bool whole(const std::string& image, const std::string& terminal) {
    if (terminal == "png") return image.ends_with(std::string_view("IEND\xae\x42\x60\x82"));
    return image.find_last_not_of(" \n") != std::string::npos &&
           std::string_view(image).substr(0, image.find_last_not_of(" \n") + 1).ends_with("</svg>");
}

/// The image's bytes. They come through a pipe: gnuplot says nothing of a file that the disk did not take whole.
std::string draw(const fs::path& script, const std::string& terminal,
                 const std::vector<std::pair<std::string, std::string>>& variables) {
    // Without the user's terminal and settings.
    std::vector<std::string> command = {"env", "-u", "GNUTERM", "gnuplot", "-d"};
    const auto define = [&command](const std::string& name, const std::string& value) {
        command.insert(command.end(), {"-e", assignment(name, value)});
    };
    for (const auto& [name, value] : variables) define(name, value);
    define("terminal", terminal);
    define("output", "/dev/stdout");
    command.push_back(script.string());
    Ended ended = run_program(command);
    if (ended.status == 127)
        throw UserError(
            "gnuplot is missing, so no figure can be drawn; install gnuplot-nox (scripts/install-packages.sh does)");
    if (ended.status != 0)
        throw SystemError(fmt::format("gnuplot {} failed with status {}: {}", script.string(), ended.status,
                                      single_line(ended.message)));
    if (!whole(ended.output, terminal))
        throw SystemError(fmt::format("gnuplot {} drew {}: {}", script.string(),
                                      ended.output.empty() ? "nothing" : "only a part", single_line(ended.message)));
    return std::move(ended.output);
}

}  // namespace

void draw_figure(const fs::path& script, const fs::path& stem,
                 const std::vector<std::pair<std::string, std::string>>& variables) {
    if (!fs::is_regular_file(script))
        throw UserError(fmt::format("{}: no such script; check the path", script.string()));
    AtomicFiles files(stem.parent_path());
    for (const char* terminal : {"svg", "png"})
        write_file(files.path() / (stem.filename().string() + "." + terminal), draw(script, terminal, variables));
    files.commit();
}

}  // namespace radiafit::harness
