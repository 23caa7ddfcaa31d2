#pragma once
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

/// Messages and progress for people. All of it goes to standard error, so that standard output stays free for results.
/// A standard error that takes nothing (a full disk, a closed pipe) is no error here. Control characters, which a
/// file's name may hold, are shown as \x1b.
namespace radiafit {

/// Quiet leaves only warnings; for --json and for tests.
void set_quiet(bool quiet);
bool quiet();

void log_info(std::string_view message);
/// Prefixed "warning: ", shown even when quiet.
void log_warning(std::string_view message);
/// "PROGRAM: MESSAGE", the last line of a program that fails; shown even when quiet.
void log_error(std::string_view program, std::string_view message);

/// "2:10", "1:02:10" with hours; at least a second of what is more than nothing.
std::string duration(double seconds);

/// "fit  [#####.....]  50%  12/24  0:08 left" for a terminal of `columns` characters; counted: with the steps.
std::string progress_bar(std::string_view task, size_t done, size_t total, double elapsed_s, int columns,
                         bool counted = true);

/// Progress of one task of `total` steps: a bar redrawn in place on a terminal; elsewhere a line at most every ten
/// seconds. A task that ends within the first ten seconds prints nothing outside a terminal. Any thread may advance.
class Progress {
public:
    enum class Shown { steps, share };  ///< "12/24", or only which share of the task is done
    Progress(std::string task, size_t total, Shown shown = Shown::steps);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(size_t steps = 1);
    void set(size_t done);
    /// Clears the bar, as the destructor does.
    void finish();

private:
    void show(size_t done);

    std::string task_;
    size_t total_;
    Shown shown_;
    std::atomic<size_t> done_{0};
    std::mutex mutex_;
    double start_s_;
    double shown_s_;
    bool drawn_ = false;
    bool finished_ = false;
};

}  // namespace radiafit
