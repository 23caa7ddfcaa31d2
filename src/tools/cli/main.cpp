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
    add_generate(program);
    add_capture(program);
    add_import(program, invocation);
    add_info(program);
    add_plan(program);
    add_fit(program, invocation);
    add_merge(program, invocation);
    add_export(program, invocation);
    add_model(program);
    add_solve(program, invocation);
    add_tune(program);
    add_judge(program);
    add_render(program);
    add_publish(program);
    add_devices(program);
    add_options(program);
    add_completion(program);
    int status = 0;
    add_compare(program, status);
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
