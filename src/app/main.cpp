#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "app/limits.h"
#include "app/options.h"
#include "app/parse_error.h"
#include "base/error.h"
#include "base/failure.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/record.h"
#include "base/standard_streams.h"

namespace {

using namespace radiafit;

int run(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0) throw UserError(explain(app, e));
        app.exit(e);  // --help, --version
    }
    finish_standard_output();
    return 0;
}

}  // namespace

/// Exit status: 0 done, 1 the machine failed (GL, I/O), 2 the user's mistake.
int main(int argc, char** argv) {
    prepare_standard_streams();
    CLI::App app("radiafit fits image-based models to posed photographs by streaming them through OpenGL.", "radiafit");
    app.require_subcommand(1);
    app.set_version_flag("--version", "radiafit " + make_record(1, argv).version + " (" + git_revision() + ")");
    int threads = 0;
    add_number(app, "--threads", threads, limits::threads, "threads to use; 0 is all cores");
    app.fallthrough();
    app.parse_complete_callback([&] { set_thread_count(threads); });
    const Invocation invocation{argc, argv};
    add_generate(app);
    add_import(app, invocation);
    add_info(app);
    add_plan(app);
    add_fit(app, invocation);
    add_judge(app);
    add_render(app);
    add_devices(app);
    try {
        return run(app, argc, argv);
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error("radiafit", standard_output_failed() ? standard_output_failure() : failure.line);
        return standard_output_failed() ? 1 : failure.status;
    }
}
