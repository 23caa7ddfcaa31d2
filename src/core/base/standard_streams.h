#pragma once
#include <string>
#include <string_view>

/// The streams a program starts with, whatever they are: terminals, full disks, pipes whose reader has gone, nothing.
namespace radiafit {

/// First thing in main(): a stream that was closed stays unusable, so that no file of ours is opened in its place, and
/// a write that cannot go on (SIGPIPE, SIGXFSZ) is an error where it happens instead of the program's end.
void prepare_standard_streams();

/// To standard error. What it doesn't take is lost without a word: no message is worth a result.
void write_to_stderr(std::string_view text) noexcept;

/// Whether standard output has refused a byte: then standard_output_failure() says more than any error that came of it.
bool standard_output_failed();
std::string standard_output_failure();
/// Throws SystemError unless standard output took every byte so far.
void finish_standard_output();

}  // namespace radiafit
