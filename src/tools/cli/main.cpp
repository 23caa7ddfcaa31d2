#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/failure.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/record.h"
#include "base/standard_streams.h"
#include "base/wording.h"
#include "cli/commands.h"
#include "fitting/limits.h"

using namespace radiafit;
using namespace radiafit::tools;

namespace {

/// All commands; of a program that is called by one's name, this one alone, since making the options of all takes
/// longer than many commands do.
void add_commands(CommandLine& program, const Invocation& invocation, int& status) {
    const std::pair<const char*, std::function<void()>> commands[] = {
        {"generate", [&] { add_generate(program); }},
        {"capture", [&] { add_capture(program); }},
        {"import", [&] { add_import(program, invocation); }},
        {"info", [&] { add_info(program); }},
        {"plan", [&] { add_plan(program); }},
        {"fit", [&] { add_fit(program, invocation); }},
        {"merge", [&] { add_merge(program, invocation); }},
        {"export", [&] { add_export(program, invocation); }},
        {"model", [&] { add_model(program); }},
        {"solve", [&] { add_solve(program, invocation); }},
        {"tune", [&] { add_tune(program); }},
        {"judge", [&] { add_judge(program); }},
        {"render", [&] { add_render(program); }},
        {"publish", [&] { add_publish(program); }},
        {"devices", [&] { add_devices(program); }},
        {"options", [&] { add_options(program); }},
        {"completion", [&] { add_completion(program); }},
        {"compare", [&] { add_compare(program, status); }},
    };
    const std::string called = invocation.argc > 1 ? invocation.argv[1] : "";
    const bool of_all = called == "options" || called == "completion";
    const auto* one = std::ranges::find(commands, called, [](const auto& c) { return std::string(c.first); });
    if (one != std::end(commands) && !of_all) return one->second();
    for (const auto& [name, add] : commands) add();
}

}  // namespace

/// Exit status: 0 done, 1 the machine failed (GL, I/O), or `compare` found a difference, 2 the user's mistake.
int main(int argc, char** argv) {
    end_idle_blas_threads();
    name_options_by_flag();
    prepare_standard_streams();
    CommandLine program("radiafit",
                        "radiafit fits image-based models to posed photographs by streaming them through OpenGL.",
                        "radiafit " + project_version() + " (" + git_revision() + ")");
    program.add("--threads", "INT", "0", "threads to use; 0 is all cores",
                [](const std::string& text) { set_thread_count(parse_number("threads", text, limits::threads)); });
    program.add_switch(
        "--quiet", [] { set_quiet(true); }, "no messages and bars on standard error, only warnings and errors");
    const Invocation invocation{argc, argv};
    int status = 0;
    add_commands(program, invocation, status);
    catch_interrupts();
    try {
        program.parse(argc, argv);
        finish_standard_output();
        return status;
    } catch (const Interrupted& interrupted) {
        end_interrupted("radiafit", interrupted);
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error("radiafit", standard_output_failed() ? standard_output_failure() : failure.line);
        return standard_output_failed() ? 1 : failure.status;
    }
}
