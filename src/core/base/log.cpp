#include "base/log.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/clock.h"
#include "base/printable.h"
#include "base/running_command.h"
#include "base/standard_streams.h"

namespace radiafit {
namespace {

constexpr double terminal_period_s = 0.1;
constexpr double plain_period_s = 10;

std::atomic<bool> is_quiet{false};
std::mutex output_mutex;
bool bar_on_screen = false;  // guarded by output_mutex: a message first clears the bar's line
std::string running_command;

std::string_view environment(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? text : "";
}

/// Whether standard error is a terminal whose cursor can be moved.
bool on_terminal() {
    static const bool terminal = isatty(STDERR_FILENO) != 0 && environment("TERM") != "dumb";
    return terminal;
}

/// Not if NO_COLOR is set, whatever it says (no-color.org).
bool in_colour() { return on_terminal() && environment("NO_COLOR").empty(); }

constexpr const char *red = "\x1b[1;31m", *yellow = "\x1b[33m", *uncoloured = "\x1b[0m";

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Lines may stay lines in a message of ours; an error is one line.
void write_line(std::string_view prefix, std::string_view message, bool one_line, const char* colour = nullptr) {
    std::string begin(prefix);
    if (colour && in_colour()) begin = fmt::format("{}{}{}", colour, prefix, uncoloured);
    std::scoped_lock lock(output_mutex);
    write_to_stderr(fmt::format("{}{}{}\n", bar_on_screen ? "\r\x1b[K" : "", begin, printable(message, !one_line)));
    bar_on_screen = false;
}

/// "fit: texels"
std::string of_command(std::string task) {
    return running_command.empty() || task == running_command ? std::move(task) : running_command + ": " + task;
}

}  // namespace

std::string duration(double time_s) {
    const long seconds = std::max(std::lround(time_s), time_s > 0 ? 1L : 0L);
    if (seconds >= 3600) return fmt::format("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
    return fmt::format("{}:{:02}", seconds / 60, seconds % 60);
}

void set_running_command(std::string words) { running_command = std::move(words); }

void set_quiet(bool quiet) { is_quiet = quiet; }
bool quiet() { return is_quiet; }

void log_info(std::string_view message) {
    if (!is_quiet) write_line("", message, false);
}

void log_warning(std::string_view message) { write_line("warning: ", message, true, yellow); }

void log_error(std::string_view program, std::string_view message) {
    write_line(fmt::format("{}: ", program), message, true, red);
}

std::string progress_bar(std::string_view task, size_t done, size_t total, double elapsed_s, int columns,
                         bool counted) {
    done = std::min(done, total);
    const double share = total == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(total);
    std::string figures = fmt::format(" {:3.0f}%", std::floor(100 * share));
    if (counted) figures += fmt::format("  {}/{}", done, total);
    if (done > 0 && done < total) figures += fmt::format("  {} left", duration(elapsed_s * (1 - share) / share));
    const int width = std::min(40, columns - static_cast<int>(task.size() + figures.size()) - 5);
    if (width < 5) return fmt::format("{} {}", task, figures).substr(0, static_cast<size_t>(std::max(columns - 1, 0)));
    const auto filled = static_cast<size_t>(share * width);
    return fmt::format("{}  [{}{}]{}", task, std::string(filled, '#'),
                       std::string(static_cast<size_t>(width) - filled, '.'), figures);
}

Progress::Progress(std::string task, size_t total, Shown shown)
    : task_(of_command(std::move(task))), total_(total), shown_(shown), start_s_(wall_time_s()), shown_s_(start_s_) {}

Progress::~Progress() { finish(); }

void Progress::advance(size_t steps) { show(done_.fetch_add(steps) + steps); }

void Progress::set(size_t done) {
    done_ = done;
    show(done);
}

void Progress::show(size_t done) {
    if (is_quiet) return;
    std::unique_lock own(mutex_, std::try_to_lock);
    if (!own) return;  // another thread is drawing: this step will be in the next drawing
    const double now_s = wall_time_s();
    if (finished_ || now_s - shown_s_ < (on_terminal() ? terminal_period_s : plain_period_s)) return;
    shown_s_ = now_s;
    if (on_terminal()) {
        std::scoped_lock lock(output_mutex);
        write_to_stderr(fmt::format("\r{}\x1b[K", progress_bar(task_, done, total_, now_s - start_s_,
                                                               terminal_columns(), shown_ == Shown::steps)));
        drawn_ = bar_on_screen = true;
    } else {
        const double passed_s = now_s - start_s_, share = double(done) / double(std::max<size_t>(total_, 1));
        std::string line = shown_ == Shown::steps ? fmt::format("{}: {} of {}", task_, done, total_)
                                                  : fmt::format("{}: {:.0f} %", task_, std::floor(100 * share));
        line += fmt::format(" after {}", duration(passed_s));
        if (done > 0 && done < total_) line += fmt::format(", {} left", duration(passed_s * (1 - share) / share));
        write_line("", line, true);
    }
}

void Progress::finish() {
    std::scoped_lock own(mutex_);
    finished_ = true;
    if (!drawn_) return;
    drawn_ = false;
    std::scoped_lock lock(output_mutex);
    if (!bar_on_screen) return;
    write_to_stderr("\r\x1b[K");
    bar_on_screen = false;
}

}  // namespace radiafit
