#include "base/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/temporary_name.h"
#include "temporary_folder.h"
#include "write_limit.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
using Existing = AtomicFolder::Existing;

std::string contents(const fs::path& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
}
using Names = std::set<std::string>;

/// The message of the UserError that `action` throws.
template <class Action>
std::string user_error(const Action& action) {
    try {
        action();
    } catch (const UserError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "not one line: " << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no UserError";
    return "";
}

void make_folder(const fs::path& target, const std::string& file, Existing existing = Existing::replace) {
    AtomicFolder folder(target, existing);
    write_file(folder.path() / file, file);
    folder.commit();
}

// ---- files ---------------------------------------------------------------------------------------------------------

TEST(AtomicFile, AppearsWholeOrNotAtAll) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "out.txt";
    write_file(path, "old");
    {
        AtomicFile file(path);
        file.write("half of the ne");
        EXPECT_EQ(names_in(folder.path()).size(), 2u);
        EXPECT_EQ(contents(path), "old");
    }
    EXPECT_EQ(contents(path), "old");
    EXPECT_EQ(names_in(folder.path()), Names{"out.txt"});
    AtomicFile file(path);
    file.write("ne");
    file.write("w");
    file.commit();
    EXPECT_EQ(contents(path), "new");
    EXPECT_EQ(names_in(folder.path()), Names{"out.txt"});
}

TEST(AtomicFile, ErrorsNameThePathAndTheCure) {
    const TemporaryFolder folder;
    const fs::path missing = folder.path() / "missing" / "out.txt";
    EXPECT_EQ(user_error([&] { write_file(missing, "x"); }),
              "cannot write " + missing.string() + ": No such file or directory; choose a writable folder");
    EXPECT_NE(user_error([&] { write_file(folder.path(), "x"); }).find("it is a folder"), std::string::npos);
    EXPECT_NE(user_error([&] { write_file("", "x"); }).find("it has no name"), std::string::npos);
    const fs::path overlong = folder.path() / std::string(300, 'x');
    EXPECT_EQ(user_error([&] { write_file(overlong, "x"); }),
              "cannot write " + overlong.string() + ": File name too long; choose a shorter name");
}

TEST(AtomicFile, AFullDiskNamesTheFileAndLeavesTheOlderOne) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "out.txt";
    write_file(path, "old");
    for (const size_t bytes : {5000u, 5'000'000u}) {  // refused when it is closed, and long before
        const WriteLimit limit(4096);
        EXPECT_EQ(user_error([&] { write_file(path, std::string(bytes, 'x')); }),
                  "cannot write " + path.string() + ": File too large; make room or choose another disk");
    }
    EXPECT_EQ(contents(path), "old");
    EXPECT_EQ(names_in(folder.path()), Names{"out.txt"});
}

// ---- folders -------------------------------------------------------------------------------------------------------

TEST(AtomicFolder, AppearsWholeAndReplacesOnlyWhenAsked) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "deep" / "out";
    {
        AtomicFolder abandoned(target);
        write_file(abandoned.path() / "a", "x");
    }
    EXPECT_EQ(names_in(folder.path()), Names{});
    {
        AtomicFolder beside(folder.path() / "deep" / "beside");
        AtomicFolder abandoned(target);
    }
    EXPECT_EQ(names_in(folder.path()), Names{});
    {
        AtomicFolder first(fs::path(target.string() + "/"));  // as a shell's completion writes it
        EXPECT_EQ(first.target(), target);
        write_file(first.path() / "a", "1");
        EXPECT_FALSE(fs::exists(target));
        first.commit();
    }
    EXPECT_EQ(contents(target / "a"), "1");
    EXPECT_NE(user_error([&] { AtomicFolder refused(target); }).find("exists already"), std::string::npos);
    AtomicFolder second(target, Existing::replace);
    write_file(second.path() / "b", "2");
    EXPECT_EQ(contents(target / "a"), "1");
    second.commit();
    EXPECT_EQ(names_in(target), Names{"b"});
    EXPECT_EQ(names_in(folder.path() / "deep"), Names{"out"});
}

TEST(AtomicFolder, NamesThatNoFolderCanTake) {
    const TemporaryFolder folder;
    write_file(folder.path() / "file", "x");
    const auto message = [&](const fs::path& target) {
        return user_error([&] { AtomicFolder impossible(target, Existing::replace); });
    };
    EXPECT_NE(message(folder.path() / "file" / "below").find("choose a writable folder"), std::string::npos);
    EXPECT_NE(message("").find("it has no name"), std::string::npos);
    for (const char* target : {".", "..", "/", "./"})
        EXPECT_NE(message(target).find("no name of a new folder"), std::string::npos) << target;
    EXPECT_NE(message("/proc").find("another disk begins there"), std::string::npos);
    EXPECT_NE(message(folder.path() / std::string(300, 'x')).find("shorter name"), std::string::npos);
    EXPECT_EQ(names_in(folder.path()), Names{"file"});
}

TEST(AtomicFolder, AFullDiskNamesTheFileByItsFinalName) {
    const TemporaryFolder folder;
    AtomicFolder out(folder.path() / "out");
    const WriteLimit limit(4096);
    OutputFile file(out.path() / "values.bin");
    const std::string values(5000, 'x');
    file.write(values.data(), values.size());
    EXPECT_EQ(user_error([&] { file.close(); }), "cannot write " + (folder.path() / "out/values.bin").string() +
                                                     ": File too large; make room or choose another disk");
}

/// Reads `target` until told to stop; the number of looks at which it was missing or not whole.
int times_missed(const fs::path& target, const std::atomic<bool>& stop) {
    int missed = 0;
    while (!stop) {
        std::error_code error;
        missed += fs::is_directory(target, error) ? 0 : 1;
    }
    return missed;
}

TEST(AtomicFolder, ThereIsAlwaysAWholeOneAndTheLastWriterWins) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "out";
    make_folder(target, "first");
    std::atomic<bool> stop = false;
    int missed = -1;
    std::thread reader([&] { missed = times_missed(target, stop); });
    std::vector<std::thread> writers;
    for (const char* name : {"a", "b", "c"})
        writers.emplace_back([&, name] {
            for (int i = 0; i < 50; ++i) make_folder(target, name);
        });
    for (std::thread& writer : writers) writer.join();
    stop = true;
    reader.join();
    EXPECT_EQ(missed, 0);
    EXPECT_EQ(names_in(folder.path()), Names{"out"});
    EXPECT_EQ(names_in(target).size(), 1u) << "a folder of one writer";
}

TEST(AtomicFolder, WritersThatMakeAndRemoveOneParent) {
    const TemporaryFolder folder;
    std::vector<std::thread> writers;
    for (int writer = 0; writer < 3; ++writer)
        writers.emplace_back([&] {
            for (int i = 0; i < 200; ++i) AtomicFolder probe(folder.path() / "deep" / "below" / "out");
        });
    for (std::thread& writer : writers) writer.join();
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
}

/// From here on, renameat2 with flags says EINVAL, as on file systems that cannot exchange names. False: no seccomp.
bool forbid_exchange() {
    sock_filter program[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[4])),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog filter{std::size(program), program};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

TEST(AtomicFolder, ReplacesWhereNamesCannotBeExchanged) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "out";
    constexpr int no_seccomp = 77;
    const pid_t child = fork();
    if (child == 0) {
        if (!forbid_exchange()) _exit(no_seccomp);
        make_folder(target, "new", Existing::refuse);
        make_folder(target, "newer");
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == no_seccomp) GTEST_SKIP() << "no seccomp here";
    EXPECT_EQ(status, 0);
    EXPECT_EQ(names_in(folder.path()), Names{"out"});
    EXPECT_EQ(names_in(target), Names{"newer"});
}

// ---- several files -------------------------------------------------------------------------------------------------

TEST(AtomicFiles, AppearTogetherOverEarlierOnes) {
    const TemporaryFolder folder;
    const fs::path place = folder.path() / "deep";
    {
        AtomicFiles abandoned(place);
        write_file(abandoned.path() / "a", "half");
    }
    EXPECT_EQ(names_in(folder.path()), Names{});
    fs::create_directory(place);
    write_file(place / "a", "old");
    write_file(place / "other", "stays");
    {
        AtomicFiles files(place);
        for (const char* name : {"a", "b"}) write_file(files.path() / name, "new");
        EXPECT_EQ(contents(place / "a"), "old");
        files.commit();
    }
    EXPECT_EQ(names_in(place), (Names{"a", "b", "other"}));
    EXPECT_EQ(contents(place / "a"), "new");
    AtomicFiles blocked(place);
    fs::create_directory(place / "c");
    for (const char* name : {"a", "b", "c"}) write_file(blocked.path() / name, "newer");
    EXPECT_NE(user_error([&] { blocked.commit(); }).find("c: it is a folder"), std::string::npos);
    EXPECT_EQ(contents(place / "a"), "new");
}

TEST(AtomicFiles, MessagesNameTheFinalFile) {
    const TemporaryFolder folder;
    const AtomicFiles files(folder.path());
    const WriteLimit limit(10);
    EXPECT_NE(user_error([&] {
                  write_file(files.path() / "a", "more than ten");
              }).find("cannot write " + (folder.path() / "a").string() + ": "),
              std::string::npos);
}

// ---- what killed processes leave -----------------------------------------------------------------------------------

/// Another process that begins something and works on it until it is killed.
template <class Begin>
pid_t begin_elsewhere(const Begin& begin) {
    int ready[2];
    EXPECT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        begin([&] {
            close(ready[0]);
            close(ready[1]);
            while (true) pause();
        });
        _exit(1);
    }
    close(ready[1]);
    char none;
    EXPECT_EQ(read(ready[0], &none, 1), 0);  // until the child has closed it, too
    close(ready[0]);
    return child;
}
pid_t begin_folder(const fs::path& target) {
    return begin_elsewhere([&](const auto& wait) {
        const AtomicFolder begun(target);
        write_file(begun.path() / "half", "x");
        wait();
    });
}
void end(pid_t child) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
}

TEST(Leftovers, GoWhenTheNextRunWritesIntoTheFolder) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "out";
    const pid_t alive = begin_folder(target), dead = begin_folder(folder.path() / "other");
    const pid_t dead_file = begin_elsewhere([&](const auto& wait) {
        AtomicFile begun(folder.path() / "file");
        wait();
    });
    end(dead);
    end(dead_file);
    EXPECT_EQ(names_in(folder.path()).size(), 3u);
    { const AtomicFolder next(target); }
    EXPECT_EQ(names_in(folder.path()).size(), 1u) << "that of `alive`";
    end(alive);
    write_file(folder.path() / "text", "x");
    EXPECT_EQ(names_in(folder.path()), Names{"text"});
}

/// A hidden name as a process makes it that had this number.
fs::path hidden_name(const fs::path& folder, std::string_view prefix, pid_t process, const std::string& name) {
    return folder / (std::string(prefix) + "-" + std::to_string(process) + "-0-" + name);
}
pid_t dead_process() {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    waitpid(child, nullptr, 0);
    return child;
}

TEST(Leftovers, StayWhileTheyAreLocked) {
    const TemporaryFolder folder;
    const fs::path hidden = hidden_name(folder.path(), unfinished_prefix, dead_process(), "out");
    fs::create_directory(hidden);
    const int lock = lock_path(hidden);  // of a process that cannot be seen from here
    ASSERT_GE(lock, 0);
    clear_leftovers(folder.path());
    EXPECT_TRUE(fs::exists(hidden));
    close(lock);
    clear_leftovers(folder.path());
    EXPECT_FALSE(fs::exists(hidden));
}

TEST(Leftovers, OfAnEarlierProcessWithThisOnesNumber) {
    const TemporaryFolder folder;
    const fs::path hidden = hidden_name(folder.path(), unfinished_prefix, getpid(), "out");
    fs::create_directory(hidden);
    make_folder(folder.path() / "out", "a");
    EXPECT_EQ(names_in(folder.path()), Names{"out"});
}

TEST(Leftovers, FilesOfOthersStay) {
    const TemporaryFolder folder;
    const std::string dead = std::to_string(dead_process());
    const Names others = {".tmp-1-0-out", ".radiafit-tmp-" + dead + "-0", ".radiafit-tmp-x-0-out", ".radiafit"};
    for (const std::string& name : others) write_file(folder.path() / name, "x");
    clear_leftovers(folder.path());
    EXPECT_EQ(names_in(folder.path()), others);
}

TEST(Leftovers, AFolderThatWasBeingReplacedGetsItsNameBack) {
    const TemporaryFolder folder;
    const fs::path target = folder.path() / "out",
                   old = hidden_name(folder.path(), replaced_prefix, dead_process(), "out");
    for (const bool by_a_reader : {true, false}) {
        make_folder(old, "earlier");
        by_a_reader ? restore_interrupted(target) : clear_leftovers(folder.path());
        EXPECT_EQ(names_in(folder.path()), Names{"out"});
        EXPECT_EQ(names_in(target), Names{"earlier"});
        fs::remove_all(target);
    }
    make_folder(target, "newer");
    fs::create_directory(old);
    restore_interrupted(target);
    EXPECT_TRUE(fs::exists(old)) << "readers remove nothing";
    clear_leftovers(folder.path());
    EXPECT_EQ(names_in(folder.path()), Names{"out"});
    EXPECT_EQ(names_in(target), Names{"newer"});
}

}  // namespace
}  // namespace radiafit
