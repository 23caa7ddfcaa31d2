#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/error.h"
#include "report/csv_file.h"
#include "report/experiments.h"
#include "report/figures.h"
#include "report/finished_runs.h"
#include "report/problem_picture.h"
#include "report/result_folder.h"
#include "report/row_files.h"
#include "report/table.h"
#include "temporary_folder.h"
#include "write_limit.h"

namespace radiafit {
using namespace harness;
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

template <class Error, class Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "not one line: " << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing thrown";
    return "";
}

TEST(Csv, RoundTripOfEveryAwkwardField) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "rows.csv";
    const std::vector<std::vector<std::string>> rows = {
        {"plain", "1"}, {"with, comma", "2.5"}, {"with \"quotes\"", "-1e-7"}, {"two\nlines", "nan"}, {"", "inf"}};
    {
        CsvWriter writer(path, {"na,me", "value"});
        for (const auto& row : rows) writer.row(row);
        EXPECT_FALSE(fs::exists(path)) << "before commit";
        writer.commit();
    }
    EXPECT_TRUE(contents(path).starts_with("\"na,me\",value\nplain,1\n\"with, comma\",2.5\n"));
    const CsvTable table(path);
    EXPECT_EQ(table.header(), (std::vector<std::string>{"na,me", "value"}));
    ASSERT_EQ(table.row_count(), rows.size());
    for (size_t i = 0; i < rows.size(); i++) EXPECT_EQ(table.text(i, "na,me"), rows[i][0]);
    EXPECT_EQ(table.number(2, "value"), -1e-7);
    EXPECT_TRUE(std::isnan(table.number(3, "value")));
    EXPECT_TRUE(std::isinf(table.number(4, "value")));
}

TEST(Csv, WithoutCommitNothingRemains) {
    const TemporaryFolder folder;
    { CsvWriter(folder.path() / "rows.csv", {"a"}).row({"1"}); }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Csv, AFullDiskLeavesTheOlderFile) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "rows.csv";
    write_file(path, "older\n");
    const WriteLimit limit(8);
    CsvWriter writer(path, {"header"});
    writer.row({"1"});
    EXPECT_EQ(message_of<UserError>([&] { writer.commit(); }),
              "cannot write " + path.string() + ": File too large; make room or choose another disk");
    EXPECT_EQ(contents(path), "older\n");
}

TEST(Csv, TheHeaderAndEveryRowAreChecked) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "rows.csv";
    EXPECT_THROW(CsvWriter(path, {}), std::logic_error);
    EXPECT_THROW(CsvWriter(path, {"a", "a"}), std::logic_error);
    EXPECT_THROW(CsvWriter(path, {"a", ""}), std::logic_error);
    CsvWriter writer(path, {"a", "b"});
    EXPECT_THROW(writer.row({"1"}), std::logic_error);
    EXPECT_THROW(writer.row({"1", "2", "3"}), std::logic_error);
}

TEST(Csv, ABadFileIsNamedWithItsLine) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "rows.csv").string();
    const auto error = [&](const std::string& text) {
        write_file(path, text);
        std::string message = message_of<UserError>([&] { (void)CsvTable(path).number(0, "b"); });
        return message.starts_with(path) ? message.substr(path.size()) : message;
    };
    EXPECT_EQ(error("a,b\n1,x\n"), ":2: 'x' in column 'b' is no number; correct or remake the file");
    EXPECT_EQ(error("a,b\n1,2 \n"), ":2: '2 ' in column 'b' is no number; correct or remake the file");
    EXPECT_EQ(error("a,b\n\"x\ny\",2\n1\n"), ":4: 1 fields under 2 names; correct or remake the file");
    EXPECT_EQ(error("a,b\n1,\"2\n"), ":2: a quote is never closed; correct or remake the file");
    EXPECT_EQ(error("a,b\n1,2"), ": no line break behind the last row, so it may have been cut; remake the file");
    EXPECT_EQ(error("a,c\n1,2\n"), ": no column 'b'; remake the file with this version");
    EXPECT_EQ(error(""), ": empty; remake it");
    EXPECT_THROW(CsvTable("no/such.csv"), UserError);
    write_file(path, "a,b\r\n1,2\r\n");
    EXPECT_EQ(CsvTable(path).number(0, "b"), 2) << "line ends of other systems";
}

// Rows that are structs.

struct Measured {
    std::string name;
    double error, share;
    bool reached;
    std::optional<int64_t> bytes;
    std::vector<int> arrived;
};
const RowFileOf<Measured> measured{"*_measured.csv",
                                   "One row.",
                                   {{"name", columns::key(), "", &Measured::name},
                                    {"error share", columns::errors("{:.3g}"), "", &Measured::error, &Measured::share},
                                    {"reached", columns::exact(), "", &Measured::reached},
                                    {"bytes", columns::memory(), "", &Measured::bytes},
                                    {"*", columns::iterations(), "", &Measured::arrived}}};

TEST(CsvFile, AMemberForEachColumnWrittenByItsFormat) {
    const TemporaryFolder folder;
    CsvFile file(folder.path(), measured, {"cg", "sd"}, "star");
    file.add({"a, b", 1.23456, 0.5, true, 12, {3, -1}});
    file.add({"c", 1e-9, NAN, false, {}, {0, 1}});
    EXPECT_THROW(file.add({"d", 0, 0, false, {}, {1}}), std::logic_error);
    file.commit();
    EXPECT_EQ(contents(folder.path() / "star_measured.csv"),
              "name,error,share,reached,bytes,cg,sd\n\"a, b\",1.23,0.5,1,12,3,-1\nc,1e-09,nan,0,,0,1\n");
    EXPECT_TRUE(measured.covers("bust_measured.csv"));
    EXPECT_FALSE(measured.covers("measured"));
    EXPECT_EQ(measured.rule("share")->kind, ColumnKind::relative);
    EXPECT_EQ(measured.rule("any")->kind, ColumnKind::iterations);
    EXPECT_THROW(ColumnsOf<Measured>("one two", columns::key(), "", &Measured::name), std::logic_error);
}

TEST(Experiments, EachFileHasItsColumnsOnce) {
    for (const ExperimentEntry* entry : all_experiments())
        for (const RowFile* file : entry->files) {
            EXPECT_EQ(find_row_file(entry->name, file->name()), file) << entry->name;
            const std::vector<std::string> header = file->header({});
            EXPECT_EQ(std::set(header.begin(), header.end()).size(), header.size()) << entry->name << file->name();
        }
    EXPECT_EQ(find_row_file("passes", "times.csv"), nullptr);
}

TEST(Table, TextAndMarkdown) {
    Table table({"name", "µ", "n|m"});
    table.add({"star", "-0.5", ""});
    table.add({"bäst|x", "12.25 MB", "7"});
    EXPECT_EQ(table.text(),
              "name           µ  n|m\n"
              "------  --------  ---\n"
              "star        -0.5\n"
              "bäst|x  12.25 MB    7\n");
    EXPECT_EQ(table.markdown(),
              "| name    |        µ | n\\|m |\n"
              "| ------- | -------: | ---: |\n"
              "| star    |     -0.5 |      |\n"
              "| bäst\\|x | 12.25 MB |    7 |\n");
    EXPECT_THROW(table.add({"too", "few"}), std::logic_error);
    EXPECT_EQ(Table({"empty"}).text(), "empty\n-----\n");
}

TEST(ResultFolder, SlugsAreSafeNames) {
    EXPECT_EQ(slug("llvmpipe (LLVM 15.0.6, 256 bits)"), "llvmpipe-llvm-15-0-6-256-bits");
    EXPECT_EQ(slug("cpu, 2 threads"), "cpu-2-threads");
    EXPECT_EQ(slug("../../etc"), "etc");
    EXPECT_EQ(slug("µ"), "unknown");
    EXPECT_EQ(slug(""), "unknown");
}

Record record() {
    const char* arguments[] = {"fig", "--profile", "smoke"};
    return make_record(3, arguments);
}

std::vector<fs::path> newest(const fs::path& root, const std::string& profile) {
    std::vector<fs::path> folders;
    for (const RunRecord& run : newest_runs(root, "fig7", profile)) folders.push_back(run.folder);
    return folders;
}

TEST(ResultFolder, AppearsWholeWithItsRecordAndNeverOverwrites) {
    const TemporaryFolder root;
    std::vector<fs::path> made;
    for (int run = 0; run < 3; run++) {  // within one second, at least two of them
        ResultFolder results(root.path(), "fig7", "CPU, 2 threads", record());
        EXPECT_EQ(newest_runs(root.path(), "fig7", "smoke").empty(), run == 0) << "an unfinished run is no run";
        write_file(results.path() / "rows.csv", std::to_string(run));
        results.record().more.emplace_back("peaks", "[1, 2]");
        results.record().more.emplace_back("profile", "\"smoke\"");
        ResultFolder moved(std::move(results));
        moved.commit();
        made.push_back(moved.path());
        EXPECT_EQ(moved.path().parent_path(), root.path() / "fig7" / "cpu-2-threads");
        EXPECT_NE(moved.path().filename().string().find(git_revision()), std::string::npos);
        const std::string json = contents(moved.path() / "run.json");
        for (const char* expected : {"\"--profile\"", "\"peaks\"", "\"wall_s\"", "\"git_revision\""})
            EXPECT_NE(json.find(expected), std::string::npos) << expected;
    }
    for (int run = 0; run < 3; run++) EXPECT_EQ(contents(made[size_t(run)] / "rows.csv"), std::to_string(run));
    { const ResultFolder abandoned(root.path(), "fig7", "other device", record()); }
    EXPECT_EQ(newest(root.path(), "smoke"), std::vector{made[2]});
    EXPECT_TRUE(newest_runs(root.path(), "no such", "smoke").empty());
}

TEST(ResultFolder, NewestStandardRunOfEachDevice) {
    const TemporaryFolder root;
    const auto add = [&](const std::string& name, const std::string& profile, const std::string& more = "") {
        fs::create_directories(root.path() / "fig7" / name);
        write_file(
            root.path() / "fig7" / name / "run.json",
            R"({"program": "fig7", "utc_start": "u", "git_revision": "r", "compiler": "c", "cpu": "C", "cores": 2,
                       "threads": 2, "config": {}, "profile": ")" +
                profile + "\"" + more + "}");
    };
    add("b/20240101T000000Z-x", "paper");
    add("b/20231231T235959Z-y", "smoke");
    add("b/20240102T000000Z-x", "paper", ", \"standard\": false");
    add("a/20200101T000000Z-z", "paper", ", \"standard\": true");
    add("a/20200102T000000Z-z", "paper", ", \"rounds_left_out\": true");
    add("c/20200101T000000Z-z", "paper", ", \"rounds_left_out\": true");
    add("c/20200102T000000Z-z", "paper", ", \"rounds_left_out\": true");
    add("a/.radiafit-tmp-1-0-later", "paper");
    fs::create_directories(root.path() / "fig7" / "a" / "20990101T000000Z-without-record");
    fs::create_directories(root.path() / "fig7" / "a" / "20990102T000000Z-damaged");
    write_file(root.path() / "fig7/a/20990102T000000Z-damaged/run.json", "{}");
    EXPECT_EQ(newest(root.path(), "paper"),
              (std::vector{root.path() / "fig7/a/20200101T000000Z-z", root.path() / "fig7/b/20240101T000000Z-x",
                           root.path() / "fig7/c/20200102T000000Z-z"}))
        << "one cut short only where there is no other";
    EXPECT_EQ(newest(root.path(), "smoke"), std::vector{root.path() / "fig7/b/20231231T235959Z-y"});
}

TEST(ResultFolder, AnUnwritableRootIsNamed) {
    const TemporaryFolder folder;
    write_file(folder.path() / "file", "");
    EXPECT_NE(message_of<UserError>([&] {
                  ResultFolder(folder.path() / "file", "fig7", "cpu", record());
              }).find("choose a writable folder"),
              std::string::npos);
}

class Figures : public ::testing::Test {
protected:
    void SetUp() override {
        if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is absent";
    }
    fs::path script(const std::string& text) {
        write_file(folder_.path() / "figure.gp", text);
        return folder_.path() / "figure.gp";
    }
    TemporaryFolder folder_;
    fs::path stem_ = folder_.path() / "out" / "figure";
};

constexpr const char* good_script = R"(
if (terminal eq 'svg') { set terminal svg size 300,200 } else { set terminal pngcairo size 300,200 }
set output output
set title caption noenhanced
plot rows using 1:2 with lines
)";

TEST_F(Figures, SvgAndPngWithVariablesPassed) {
    fs::create_directory(stem_.parent_path());
    write_file(folder_.path() / "it's.dat", "0 0\n1 1\n2 4\n");
    draw_figure(script(good_script), stem_,
                {{"rows", (folder_.path() / "it's.dat").string()}, {"caption", "it's \"quoted\" $HOME \\n `id`"}});
    const std::string svg = contents(stem_.string() + ".svg");
    EXPECT_NE(svg.find("<svg"), std::string::npos);
    EXPECT_NE(svg.find("it's \"quoted\" $HOME \\n `id`"), std::string::npos) << "the caption, untouched";
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    const std::string png = contents(stem_.string() + ".png");
    EXPECT_TRUE(png.starts_with("\x89PNG"));
    EXPECT_NE(png.find("IEND"), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(stem_.parent_path()), fs::directory_iterator()), 2);
}

TEST_F(Figures, AFailingScriptLeavesNothingAndSaysWhy) {
    fs::create_directory(stem_.parent_path());
    EXPECT_NE(
        message_of<SystemError>([&] { draw_figure(script("no_such_command\n"), stem_, {}); }).find("invalid command"),
        std::string::npos);
    EXPECT_NE(
        message_of<SystemError>([&] { draw_figure(script("set terminal svg\n"), stem_, {}); }).find("drew nothing"),
        std::string::npos);
    EXPECT_NE(message_of<SystemError>([&] {
                  draw_figure(script("set output output\nset print output\nprint '<svg>'\n"), stem_, {});
              }).find("drew only a part"),
              std::string::npos);
    EXPECT_TRUE(fs::is_empty(stem_.parent_path()));
    EXPECT_NE(message_of<UserError>([&] { draw_figure(folder_.path() / "missing.gp", stem_, {}); }).find("missing.gp"),
              std::string::npos);
    EXPECT_NE(message_of<UserError>([&] {
                  draw_figure(script("x = 1\n"), folder_.path() / "figure.gp" / "figure", {});
              }).find("cannot write"),
              std::string::npos);
}

TEST_F(Figures, AFullDiskLeavesTheOlderFigure) {
    fs::create_directory(stem_.parent_path());
    write_file(folder_.path() / "line.dat", "0 0\n1 1\n");
    const auto draw = [&] {
        draw_figure(script(good_script), stem_,
                    {{"rows", (folder_.path() / "line.dat").string()}, {"caption", "a line"}});
    };
    draw();
    const std::string svg = contents(stem_.string() + ".svg"), png = contents(stem_.string() + ".png");
    for (const size_t room : {size_t(0), size_t(1000), png.size() - 1, svg.size() - 1}) {
        fs::path script_file = script(good_script);  // before the disk is full
        const WriteLimit limit(room);
        EXPECT_NE(message_of<UserError>([&] {
                      draw_figure(script_file, stem_,
                                  {{"rows", (folder_.path() / "line.dat").string()}, {"caption", "another line"}});
                  }).find("make room"),
                  std::string::npos)
            << room;
        EXPECT_EQ(contents(stem_.string() + ".svg"), svg);
        EXPECT_EQ(contents(stem_.string() + ".png"), png);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(stem_.parent_path()), fs::directory_iterator()), 2);
}

TEST(ProblemPicture, TheSameBytesInEveryRunAndNoHiddenNames) {
    if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is absent";
    const TemporaryFolder folder;
    ProblemPicture picture;
    picture.width = picture.height = 2;
    picture.status = picture.iterations = picture.samples = picture.rms = {0, 1, 1, NAN};
    picture.status_names = {"converged", "failed"};
    picture.title = "four problems";
    picture.unit = "grey";
    picture.mark = "a_test";
    std::vector<std::string> drawn;
    for (const char* stem : {"a", "b"}) {
        draw_problems(picture, folder.path() / stem);
        drawn.push_back(contents(folder.path() / (std::string(stem) + ".svg")));
    }
    EXPECT_EQ(drawn[0], drawn[1]);
    EXPECT_LT(drawn[0].find("a_test"), 1u << 14);
    EXPECT_EQ(drawn[0].find(folder.path().filename().string()), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 4);
}

TEST(FiguresWithoutGnuplot, SaysWhatToInstall) {
    const TemporaryFolder folder;
    write_file(folder.path() / "figure.gp", "");
    const std::string path = std::getenv("PATH");
    setenv("PATH", folder.path().c_str(), 1);
    const std::string message =
        message_of<UserError>([&] { draw_figure(folder.path() / "figure.gp", folder.path() / "figure", {}); });
    setenv("PATH", path.c_str(), 1);
    EXPECT_NE(message.find("install gnuplot-nox"), std::string::npos);
}

TEST(RunFiles, AreWhatTheRunWrote) {
    const TemporaryFolder root;
    ResultFolder results(root.path(), "fig7", "CPU", record());
    write_file(results.path() / "rows.csv", "a\n1\n");
    results.record().more.emplace_back("profile", "\"smoke\"");
    results.commit();
    const RunRecord run = read_run(results.path());
    EXPECT_EQ(run_files(run.folder), std::vector<std::string>{"rows.csv"});
    EXPECT_EQ(read_rows(run, "rows.csv").text(0, "a"), "1");
    EXPECT_THROW(read_rows(run, "others.csv"), UserError);
    for (const char* other : {"a\n2\n", "a\n1\n1\n", "a\n1", ""}) {
        write_file(run.folder / "rows.csv", other);
        EXPECT_THROW(read_rows(run, "rows.csv"), UserError) << other;
    }
    write_file(run.folder / "more.csv", "a\n1\n");
    EXPECT_THROW(read_rows(run, "more.csv"), UserError) << "not of this run";
}

}  // namespace
}  // namespace radiafit
