#pragma once
#include <string>

/// Ctrl-C (SIGINT) and SIGTERM. The first one asks the program to end: work stops before its next step with an
/// exception that leaves outputs as they are and temporary files removed. The second one ends it at once.
namespace radiafit {

/// Deliberately no std::exception: whoever handles failures lets it pass.
struct Interrupted {
    int signal;
    std::string note;  ///< for the last line: what is kept, and how to go on
};

/// From now on; a signal that the program was started to ignore (nohup, a job in the background) stays ignored.
void catch_interrupts();
/// Throws Interrupted once a signal has come. Loops of parallel.h and optimizers call it between steps.
void throw_if_interrupted();
/// Says in one line that the program stopped, and ends it as the signal would have: a shell sees 130 (143), and a
/// script that waits ends, too.
[[noreturn]] void end_interrupted(const std::string& program, const Interrupted& interrupted);

}  // namespace radiafit
