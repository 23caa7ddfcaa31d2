// A finished output is replaced only where that was asked for, and the command that made it knows it again.
#include "base/output_claims.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

const MadeBy drawing{"draw lines", "0123456789abcdef"}, other_drawing{"draw lines", "fedcba9876543210"},
    painting{"paint", "0123456789abcdef"};

std::string text_of(const fs::path& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::string refusal(const OutputTarget& target, const MadeBy& made, bool replace = false) {
    try {
        const OutputClaims claims({target}, made, replace);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

void make_folder(const fs::path& folder, const MadeBy& made, const std::string& text, bool replace = false) {
    const OutputClaims claims({{.path = folder}}, made, replace);
    ASSERT_FALSE(claims.done());
    AtomicFolder output(folder);
    write_file(output.path() / "text", text);
    output.commit();
}

TEST(OutputClaims, AFolderSaysWhoMadeIt) {
    const TemporaryFolder place;
    const fs::path out = place.path() / "out";
    make_folder(out, drawing, "lines");
    EXPECT_EQ(made_by(out), drawing);
    EXPECT_TRUE(as_it_was_made(out));
    EXPECT_TRUE(OutputClaims({{.path = out}}, drawing, false).done());
    EXPECT_FALSE(OutputClaims({{.path = out}}, drawing, true).done()) << "it is to be made again";
    const std::string other = refusal({.path = out}, other_drawing);
    EXPECT_NE(other.find("with other options or of another input"), std::string::npos) << other;
    EXPECT_NE(other.find("'replace'"), std::string::npos) << other;
    EXPECT_NE(refusal({.path = out}, painting).find("made by radiafit draw lines"), std::string::npos);
    EXPECT_NE(refusal({.path = out}, painting, true).find("replaces only what it made"), std::string::npos);
    EXPECT_EQ(text_of(out / "text"), "lines");
    make_folder(out, other_drawing, "more", true);
    EXPECT_EQ(text_of(out / "text"), "more");
    EXPECT_EQ(made_by(out), other_drawing);
}

TEST(OutputClaims, WhatWasChangedSinceIsNotDone) {
    const TemporaryFolder place;
    const fs::path out = place.path() / "out";
    make_folder(out, drawing, "lines");
    std::ofstream(out / "text") << "cut";
    EXPECT_FALSE(as_it_was_made(out));
    EXPECT_NE(refusal({.path = out}, drawing).find("changed since"), std::string::npos);
    fs::remove(out / "text");
    EXPECT_FALSE(as_it_was_made(out));
    EXPECT_EQ(refusal({.path = out}, drawing, true), "");
}

TEST(OutputClaims, AnEmptyFolderIsAsGoodAsNone) {
    const TemporaryFolder place;
    const fs::path out = place.path() / "out";
    fs::create_directory(out);
    make_folder(out, drawing, "lines");
    EXPECT_EQ(made_by(out), drawing);
}

TEST(OutputClaims, WhatNobodyMadeStays) {
    const TemporaryFolder place;
    const fs::path out = place.path() / "out";
    fs::create_directory(out);
    std::ofstream(out / "mine") << "x";
    EXPECT_NE(refusal({.path = out}, drawing).find("nothing says which command made it"), std::string::npos);
    EXPECT_NE(refusal({.path = out}, drawing, true).find("remove it"), std::string::npos);
    const auto not_a_drawing = [] { throw UserError("no drawing"); };
    EXPECT_EQ(refusal({.path = out, .check = not_a_drawing}, drawing), "no drawing");
    EXPECT_EQ(refusal({.path = out, .check = not_a_drawing}, drawing, true), "no drawing");
}

TEST(OutputClaims, TheCommandLineThatAFolderKeepsIsNamed) {
    const TemporaryFolder place;
    const fs::path out = place.path() / "out";
    fs::create_directory(out);
    std::ofstream(out / "about.json")
        << R"({"provenance": {"program": "radiafit", "arguments": ["draw", "--thick", "3"]}})";
    EXPECT_NE(refusal({.path = out, .check = [] {}}, drawing).find("made by `radiafit draw --thick 3`"),
              std::string::npos);
}

TEST(OutputClaims, AFileCarriesAWord) {
    const TemporaryFolder place;
    const fs::path file = place.path() / "a.ply";
    std::ofstream(file) << "ply\ncomment " << made_by_word(drawing) << "\nend_header\n";
    EXPECT_EQ(made_by(file), drawing);
    EXPECT_TRUE(OutputClaims({{.path = file}}, drawing, false).done());
    EXPECT_NE(refusal({.path = file}, other_drawing), "");
    EXPECT_EQ(refusal({.path = file}, other_drawing, true), "");
    std::ofstream(file) << "radiafit_made_by_draw_0123456789abcdeX radiafit_made_by__0123456789abcdef";
    EXPECT_EQ(made_by(file), std::nullopt);
    std::ofstream(file) << made_by_word(drawing) << "9f_and more";
    EXPECT_EQ(made_by(file), drawing) << "no blank behind it";
    std::ofstream(file) << "radiafit_made_by_";
    std::ofstream(file, std::ios::app) << std::string(5 << 20, '-')
                                       << made_by_word({"cut-mesh now", "00000000000000ff"});
    EXPECT_EQ(made_by(file), (MadeBy{"cut-mesh now", "00000000000000ff"})) << "at the end of a long file";
    EXPECT_EQ(made_by(place.path() / "none"), std::nullopt);
}

TEST(OutputClaims, FilesTogetherAreDoneTogether) {
    const TemporaryFolder place;
    const auto name = [&](const char* ending) { return fs::path(place.path() / "view").concat(ending); };
    const OutputTarget target{.path = name(""), .files = {name(".png"), name(".txt")}, .check = [] {}};
    std::ofstream(name(".png")) << made_by_word(drawing);
    EXPECT_NE(refusal(target, drawing), "") << "one is missing";
    std::ofstream(name(".txt")) << "says nothing";
    EXPECT_TRUE(OutputClaims({target}, drawing, false).done());
    std::ofstream(name(".txt")) << made_by_word(other_drawing);
    EXPECT_NE(refusal(target, drawing), "");
}

TEST(OutputClaims, ASharedFolderAsksForEachFile) {
    const TemporaryFolder place;
    const fs::path folder = place.path() / "all";
    fs::create_directory(folder);
    std::ofstream(folder / "mine") << "x";
    {
        const OutputClaims claims({{.path = folder, .shared = true}}, drawing, false);
        EXPECT_FALSE(claims.done());
        EXPECT_THROW(require_replaceable(folder / "mine"), UserError);
        require_replaceable(folder / "line");
        AtomicFiles files(folder);
        write_file(files.path() / "line", made_by_remark());
        files.commit();
        require_replaceable(folder / "line");
    }
    EXPECT_TRUE(OutputClaims({{.path = folder, .shared = true}}, drawing, false).done());
    EXPECT_NE(refusal({.path = folder, .shared = true}, other_drawing), "");
    EXPECT_EQ(refusal({.path = folder, .shared = true}, other_drawing, true), "");
    EXPECT_NE(refusal({.path = folder, .shared = true}, painting, true), "");
    EXPECT_EQ(text_of(folder / "mine"), "x");
}

TEST(OutputClaims, SeveralAreDoneOnlyTogether) {
    const TemporaryFolder place;
    const fs::path first = place.path() / "first", second = place.path() / "second";
    make_folder(first, drawing, "lines");
    EXPECT_FALSE(OutputClaims({{.path = first}, {.path = second}}, drawing, false).done());
    make_folder(second, drawing, "lines");
    EXPECT_TRUE(OutputClaims({{.path = first}, {.path = second}}, drawing, false).done());
}

TEST(OutputClaims, NothingIsMarkedWithoutACommand) {
    const TemporaryFolder place;
    AtomicFolder output(place.path() / "out");
    write_file(output.path() / "text", "x");
    output.commit();
    EXPECT_EQ(made_by(place.path() / "out"), std::nullopt);
    EXPECT_EQ(made_by_remark(), "");
    require_replaceable(place.path() / "out" / "text");
}

TEST(OutputClaims, OneRunAtATime) {
    const TemporaryFolder place;
    const OutputClaims first({{.path = place.path() / "out"}}, drawing, false);
    EXPECT_NE(refusal({.path = place.path() / "out"}, drawing).find("another run is writing it"), std::string::npos);
    EXPECT_EQ(refusal({.path = place.path() / "out", .lock = false}, drawing), "");
}

}  // namespace
}  // namespace radiafit
