#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "app/commands.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/record.h"

/// Exit status: 0 done, 1 the machine failed (GL, I/O), 2 the user's mistake.
int main(int argc, char** argv) {
    using namespace radiafit;
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of write(), with a line of its own
    CLI::App app("radiafit fits image-based models to posed photographs by streaming them through OpenGL.", "radiafit");
    app.require_subcommand(1);
    app.set_version_flag("--version", "radiafit " + make_record(1, argv).version + " (" + git_revision() + ")");
    int threads = 0;
    app.add_option("--threads", threads, "threads to use; 0 is all cores")->check(CLI::Range(0, 1024));
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
        app.parse(argc, argv);
        if (std::fflush(stdout) != 0) throw SystemError("standard output took only a part: is its disk full?");
        return 0;
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
        fmt::print(stderr, "radiafit: {}; see radiafit --help\n", e.what());
        return 2;
    } catch (const UserError& e) {
        fmt::print(stderr, "radiafit: {}\n", e.what());
        return 2;
    } catch (const std::exception& e) {
        fmt::print(stderr, "radiafit: {}\n", e.what());
        return 1;
    }
}
