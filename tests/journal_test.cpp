// What is kept comes back byte for byte, also from files that were cut or have rotted, and never from another's.
#include "base/journal.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "base/log.h"
#include "base/read_file.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
constexpr double at_once = 1e-9;

std::string block(size_t i) { return std::string(i * 7 % 50, char('a' + i % 26)); }

void write_blocks(const fs::path& file, size_t count) {
    Journal journal(file, "key", at_once);
    for (size_t i = 0; i < count; ++i) journal.keep(i, block(i));
    journal.flush();
}

TEST(Journal, WhatIsKeptComesBack) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "new" / "a.journal";
    write_blocks(file, 20);
    Journal again(file, "key", at_once);
    EXPECT_EQ(again.kept(), 20u);
    for (size_t i = 0; i < 20; ++i) EXPECT_EQ(again.find(i), block(i));
    EXPECT_FALSE(again.find(20));
    again.keep(20, "more");
    again.flush();
    EXPECT_EQ(Journal(file, "key", at_once).find(20), "more");
    EXPECT_EQ(Journal::key_of(file), "key");
}

TEST(Journal, NothingIsWrittenBeforeItsTimeOrWhereItIsOff) {
    const TemporaryFolder folder;
    {
        Journal waiting(folder.path() / "a.journal", "key", 1000), off(folder.path() / "b.journal", "key", 0);
        waiting.keep(1, "one");
        off.keep(1, "one");
        off.flush();
    }
    EXPECT_FALSE(stands(folder.path() / "a.journal"));
    EXPECT_FALSE(stands(folder.path() / "b.journal"));
}

TEST(Journal, ASignalHasItWritten) {
    const TemporaryFolder folder;
    Journal journal(folder.path() / "a.journal", "key", 1000);
    const auto work = [&]() -> int {
        journal.keep(1, "one");
        throw Interrupted{2, {}};
    };
    EXPECT_THROW(keeping(journal, work), Interrupted);
    EXPECT_EQ(Journal(folder.path() / "a.journal", "key", 1).find(1), "one");
}

TEST(Journal, OfACutFileTheWholeBlocksCount) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.journal";
    write_blocks(file, 6);
    const std::string bytes = read_file(file, "journal");
    size_t before = 0;
    for (size_t size = 0; size < bytes.size(); ++size) {
        std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(size));
        if (!Journal::key_of(file)) {
            EXPECT_THROW(Journal(file, "key", 1), UserError);
            continue;
        }
        Journal cut(file, "key", at_once);
        for (size_t i = 0; i < cut.kept(); ++i) EXPECT_EQ(cut.find(i), block(i)) << size;
        EXPECT_GE(cut.kept(), before);
        before = cut.kept();
        if (size % 5) continue;
        // what is kept from now on stands behind the last whole block
        cut.keep(99, "new");
        cut.flush();
        EXPECT_EQ(Journal(file, "key", 1).kept(), before + 1);
    }
    EXPECT_EQ(before, 5u);
}

TEST(Journal, NoFlippedBitComesBack) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.journal";
    write_blocks(file, 6);
    const std::string bytes = read_file(file, "journal");
    for (size_t at = 0; at < bytes.size(); ++at) {
        std::string wrong = bytes;
        wrong[at] = char(wrong[at] ^ 4);
        std::ofstream(file, std::ios::binary) << wrong;
        try {
            const Journal journal(file, "key", 1);
            EXPECT_LT(journal.kept(), 6u) << at;
            for (size_t i = 0; i < journal.kept(); ++i) EXPECT_EQ(journal.find(i), block(i)) << at;
        } catch (const UserError&) {
        }
    }
}

TEST(Journal, AnothersIsRefused) {
    const TemporaryFolder folder;
    write_blocks(folder.path() / "a.journal", 1);
    EXPECT_THROW(Journal(folder.path() / "a.journal", "other", 1), UserError);
    std::ofstream(folder.path() / "b.journal") << "no journal at all, but long enough for a head";
    EXPECT_THROW(Journal(folder.path() / "b.journal", "key", 1), UserError);
    EXPECT_FALSE(Journal::key_of(folder.path() / "b.journal"));
}

TEST(Journal, ADiskThatTakesNoMoreEndsTheKeepingAndNotTheWork) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "file") << "in the way";
    testing::internal::CaptureStderr();
    Journal journal(folder.path() / "file" / "a.journal", "key", at_once);
    for (size_t i = 0; i < 3; ++i) journal.keep(i, "x");
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("is kept no longer"), std::string::npos);
    EXPECT_EQ(said.find("is kept no longer"), said.rfind("is kept no longer"));  // once
}

TEST(Journal, FieldsOfABlockAreReadAsTheyWereWritten) {
    const TemporaryFolder folder;
    struct Result {
        std::vector<float> parameters{0, 0, 0};
        std::vector<int> rows;
        uint64_t number = 0;
        auto fields() {
            return [this](auto& visit) {
                visit(std::span(parameters).subspan(1, 2));
                visit(rows);
                visit(number);
            };
        }
    } first, second;
    {
        Journal journal(folder.path() / "a.journal", "key", at_once);
        once(&journal, 3, first.fields(), [&] { first = {{1, 2, 3}, {4, 5}, 6}; });
    }
    Journal journal(folder.path() / "a.journal", "key", at_once);
    once(&journal, 3, second.fields(), [] { FAIL() << "done again"; });
    EXPECT_EQ(second.parameters, (std::vector<float>{0, 2, 3}));
    EXPECT_EQ(second.rows, first.rows);
    EXPECT_EQ(second.number, 6u);
    // of another size: of a program whose blocks are others
    uint32_t shorter = 0;
    const auto other = [&](auto& visit) { visit(shorter); };
    EXPECT_THROW(once(&journal, 3, other, [] {}), UserError);
    bool done = false;
    once(nullptr, 3, other, [&] { done = true; });
    EXPECT_TRUE(done);
}

}  // namespace
}  // namespace radiafit
