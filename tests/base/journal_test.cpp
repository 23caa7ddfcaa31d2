// What is kept comes back byte for byte, also from files that were cut or have rotted, and never from another's.
#include "base/journal.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <numeric>

#include "base/error.h"
#include "base/read_file.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
constexpr double at_once = 1e-9;
constexpr size_t blocks = 6;

std::string block(size_t i) { return std::string(i * 7 % 50, char('a' + i % 26)); }

/// How many blocks are the last run's. None is anything else.
size_t found(const fs::path& file, const std::string& key = "key") {
    const Journal journal(file, key, 0);
    size_t count = 0;
    for (size_t i = 0; i < blocks + 1; ++i) {
        const auto bytes = journal.find(0, i);
        EXPECT_EQ(bytes.value_or(block(i)), block(i)) << i;
        count += bytes.has_value();
    }
    return count;
}

class JournalTest : public ::testing::Test {
protected:
    void SetUp() override {
        Journal journal(file, "key", at_once);
        for (size_t i = 0; i < blocks; ++i) journal.keep(0, i, block(i));
        journal.flush();
        bytes = read_file(file, "journal");
        testing::internal::CaptureStderr();  // warnings
    }
    void TearDown() override { testing::internal::GetCapturedStderr(); }
    void write(const std::string& text) const { std::ofstream(file, std::ios::binary) << text; }

    const TemporaryFolder folder;
    const fs::path file = folder.path() / "new" / "a.journal";
    std::string bytes;
};

TEST_F(JournalTest, WhatIsKeptComesBackByStageAndBlock) {
    EXPECT_EQ(found(file), blocks);
    Journal again(file, "key", at_once);
    again.keep(1, 0, "more");
    again.flush();
    EXPECT_EQ(found(file), blocks);
    EXPECT_EQ(Journal(file, "key", at_once).find(1, 0), "more");
    EXPECT_FALSE(Journal(file, "key", at_once).find(1, 1));
    EXPECT_EQ(Journal::key_of(file), "key");
}

TEST_F(JournalTest, NothingIsWrittenBeforeItsTimeOrWhereItIsOff) {
    {
        Journal waiting(folder.path() / "waiting", "key", 1000), off(folder.path() / "off", "key", 0);
        waiting.keep(0, 1, "one");
        off.keep(0, 1, "one");
        off.flush();
    }
    EXPECT_FALSE(path_exists(folder.path() / "waiting"));
    EXPECT_FALSE(path_exists(folder.path() / "off"));
}

TEST_F(JournalTest, OfACutFileTheWholeBlocksCount) {
    size_t before = 0;
    for (size_t size = 0; size < bytes.size(); ++size) {
        write(bytes.substr(0, size));
        const size_t count = found(file);
        EXPECT_GE(count, before);
        before = count;
        if (size % 5) continue;
        Journal journal(file, "key", at_once);  // what is kept from now on stands behind the last whole block
        journal.keep(0, blocks, block(blocks));
        journal.flush();
        EXPECT_EQ(found(file), count + 1) << size;
    }
    EXPECT_EQ(before, blocks - 1);
}

TEST_F(JournalTest, NoFlippedBitComesBack) {
    for (size_t at = 0; at < bytes.size(); ++at) {
        std::string wrong = bytes;
        wrong[at] = char(wrong[at] ^ 4);
        write(wrong);
        EXPECT_LT(found(file), blocks) << at;
    }
}

TEST_F(JournalTest, NothingOfAnotherKeyCounts) {
    EXPECT_EQ(found(file, "other"), 0u);
    EXPECT_EQ(found(file, "ke"), 0u);
    std::ofstream(file) << "yek" + bytes.substr(3);
    EXPECT_EQ(found(file, "yek"), 0u);
    EXPECT_EQ(Journal::key_of(file), "yek");
}

TEST_F(JournalTest, ADiskThatTakesNoMoreEndsTheKeepingAndNotTheWork) {
    std::ofstream(folder.path() / "file") << "in the way";
    Journal journal(folder.path() / "file" / "a.journal", "key", at_once);
    for (size_t i = 0; i < 3; ++i) journal.keep(0, i, "x");
    const std::string said = testing::internal::GetCapturedStderr();
    testing::internal::CaptureStderr();
    EXPECT_NE(said.find("is kept no longer"), std::string::npos);
    EXPECT_EQ(said.find("is kept no longer"), said.rfind("is kept no longer"));  // once
}

/// Two stages of the same blocks; each leaves numbers and a vector of another length.
struct Work {
    static constexpr size_t count = 20;
    std::vector<float> numbers = std::vector<float>(2 * count);
    std::vector<std::vector<int>> rows = std::vector<std::vector<int>>(count);
    std::atomic<int> worked = 0, done = 0;

    void run(Journal* journal, int stop_after = 1 << 30) {
        for (int stage = 0; stage < 2; ++stage) {
            const auto fields = [&](auto& visit, size_t b) {
                visit(std::span(numbers).subspan(2 * b, 2));
                visit(rows[b]);
            };
            const auto work = [&](size_t b, int) {
                if (++worked > stop_after) throw Interrupted{2, {}};
                numbers[2 * b] = float(b) + numbers[2 * b] / 3;
                numbers[2 * b + 1] = float(stage);
                rows[b].resize(b + size_t(stage));
                std::iota(rows[b].begin(), rows[b].end(), stage);
            };
            finish_blocks(journal, count, fields, work, [&](size_t) { ++done; });
        }
    }
};

TEST_F(JournalTest, StagesThatAreStoppedEndAsOthersDo) {
    Work whole;
    whole.run(nullptr);
    for (const int stop : {0, 1, 15, 25, 39}) {
        const fs::path kept = folder.path() / std::to_string(stop);
        {
            Journal journal(kept, "key", 1000);  // a signal has it written
            Work work;
            EXPECT_THROW(work.run(&journal, stop), Interrupted);
        }
        Journal journal(kept, "key", 1000);
        Work again;
        again.run(&journal);
        EXPECT_EQ(again.numbers, whole.numbers) << stop;
        EXPECT_EQ(again.rows, whole.rows) << stop;
        EXPECT_LE(again.worked, int(2 * Work::count) - stop);
        EXPECT_EQ(again.done, int(2 * Work::count));
    }
}

TEST_F(JournalTest, ABlockOfAnotherSizeIsRefused) {
    Journal journal(file, "key", 1000);
    uint32_t number = 0;
    const auto fields = [&](auto& visit, size_t) { visit(std::span(&number, 1)); };
    EXPECT_THROW(finish_blocks(&journal, 2, fields, [](size_t, int) {}), UserError);
}

}  // namespace
}  // namespace radiafit
