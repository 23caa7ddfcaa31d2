// What runs in processes of its own.
#include "base/program.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/error.h"

namespace radiafit {
namespace {

TEST(RunApart, ReturnsWhatTheBodyDoesAndChangesNothingHere) {
    int here = 1;
    const std::string large(1 << 20, 'x');  // more than a pipe holds
    const Ended ended = run_apart(
        [&] {
            here = 2;
            return large;
        },
        60);
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.output, large);
    EXPECT_EQ(here, 1);
}

TEST(RunApart, ACrashIsToldAndNoMore) {
    const Ended crashed = run_apart(
        []() -> std::string {
            (void)!write(STDERR_FILENO, "the driver's last words\n", 24);
            std::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would end it otherwise
            raise(SIGSEGV);
            return "never";
        },
        60);
    EXPECT_EQ(crashed.status, 128 + SIGSEGV);
    EXPECT_EQ(crashed.output, "");
    EXPECT_EQ(crashed.message, "the driver's last words\n");
}

TEST(RunApart, WhatIsThrownStaysThere) {
    const Ended thrown = run_apart([]() -> std::string { throw std::runtime_error("no text"); }, 60);
    EXPECT_EQ(thrown.status, 1);
    EXPECT_EQ(thrown.output, "");
}

TEST(RunInFront, HasItsStatusFolderAndTime) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    EXPECT_EQ(run_in_front({"sh", "-c", "exit 3"}, folder, 60), 3);
    EXPECT_EQ(run_in_front({"sh", "-c", "test $(pwd -P) = " + std::filesystem::canonical(folder).string()}, folder, 60),
              0);
    EXPECT_EQ(run_in_front({"sh", "-c", "kill -SEGV $$"}, folder, 60), 128 + SIGSEGV);
    EXPECT_EQ(run_in_front({"sleep", "60"}, folder, 1), 128 + SIGALRM);
    EXPECT_EQ(run_in_front({"no-such-program"}, folder, 60), 127);
}

TEST(RunningProgram, AnswersUntilItEnds) {
    RunningProgram cat({"cat"});
    for (const std::string& said : {std::string("one"), std::string(1 << 20, 'x'), std::string("\0two", 4)}) {
        std::string heard(said.size(), ' ');
        std::thread writer([&] { cat.write(said.data(), said.size()); });
        cat.read(heard.data(), heard.size());
        writer.join();
        EXPECT_EQ(heard, said);
    }
    RunningProgram shell({"sh", "-c", "printf ab"});
    std::string heard(2, ' ');
    shell.read(heard.data(), 2);
    EXPECT_EQ(heard, "ab");
    try {
        shell.read(heard.data(), 1);
        ADD_FAILURE() << "it has ended";
    } catch (const SystemError& e) {
        EXPECT_NE(std::string(e.what()).find("sh ended"), std::string::npos) << e.what();
    }
    EXPECT_THROW(shell.write(heard.data(), 2), SystemError);
    EXPECT_THROW(RunningProgram({"no-such-program-is-here"}), SystemError);
}

TEST(RunApart, WhatDoesNotEndIsEnded) {
    const Ended slow = run_apart(
        []() -> std::string {
            for (;;) pause();
        },
        1);
    EXPECT_EQ(slow.status, 128 + SIGALRM);
}

}  // namespace
}  // namespace radiafit
