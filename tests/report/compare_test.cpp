#include "report/compare.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/read_file.h"
#include "base/rng.h"
#include "report/csv.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace harness;
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<std::vector<std::string>>;  ///< the header first

const Rows errors = {{"dataset", "method", "terms", "train_psnr_db", "train_ape", "iterations", "seconds", "renderer"},
                     {"star", "cpu-low", "1", "27.6355", "5.5399", "15", "1.593", "cpu, 2 threads"},
                     {"star", "cpu-low", "2", "28.1014", "5.1023", "15", "2.011", "cpu, 2 threads"},
                     {"star", "mean", "1", "21.4017", "12.4115", "", "0.155", "cpu, 2 threads"}};

Rows with(Rows table, size_t row, const std::string& column, const std::string& text) {
    table[row][size_t(std::ranges::find(table[0], column) - table[0].begin())] = text;
    return table;
}

/// Runs on two sides, "a" and "b", of a temporary folder.
class Runs : public ::testing::Test {
protected:
    struct Settings {
        std::string experiment = "fig9_error", file = "errors.csv", device = "cpu", revision = "abc", config = "{}";
    };
    Settings settings;

    /// One run, later than those before it.
    fs::path add(const std::string& side, const Rows& table, const Settings& s) {
        const std::string utc = fmt::format("2024-01-01T00:00:{:02}Z", ++runs_);
        const fs::path run = root() / side / s.experiment / s.device / fmt::format("{}-{}", utc, s.revision);
        fs::create_directories(run);
        write_file(run / "run.json",
                   fmt::format(R"({{"program": "{}", "utc_start": "{}", "git_revision": "{}", "profile": "smoke",
            "compiler": "c", "cpu": "{}", "cores": 2, "threads": 2, "config": {}}})",
                               s.experiment, utc, s.revision, s.device, s.config));
        CsvWriter writer(run / s.file, table[0]);
        for (size_t i = 1; i < table.size(); ++i) writer.row(table[i]);
        writer.commit();
        return run;
    }
    fs::path add(const std::string& side, const Rows& table) { return add(side, table, settings); }

    fs::path root() const { return folder_.path(); }
    Pairing pair(const std::string& only = "") {
        return pair_runs(find_runs(root() / "a"), find_runs(root() / "b"), only);
    }
    std::vector<Cell> cells() { return compare_runs(pair().pairs.at(0)); }
    /// All but what is the same and, unless asked for, times of which nothing can be said.
    std::vector<Cell> findings(bool unclear = false) {
        std::vector<Cell> all = cells();
        std::erase_if(all, [&](const Cell& c) {
            return c.verdict == Verdict::same || (!unclear && c.verdict == Verdict::unclear);
        });
        return all;
    }
    /// The one finding where only `after` is `changed`.
    Cell finding(const Rows& before, const Rows& after) {
        fs::remove_all(root() / "a");
        fs::remove_all(root() / "b");
        add("a", before);
        add("b", after);
        const std::vector<Cell> all = findings();
        EXPECT_EQ(all.size(), 1U);
        return all.empty() ? Cell{} : all[0];
    }
    std::string refusal() {
        try {
            cells();
        } catch (const UserError& e) {
            return e.what();
        }
        ADD_FAILURE() << "nothing thrown";
        return "";
    }

private:
    TemporaryFolder folder_;
    int runs_ = 0;
};

TEST_F(Runs, ARunIsTheSameAsItself) {
    add("a", errors);
    add("b", errors);
    EXPECT_TRUE(findings().empty());
    EXPECT_EQ(cells().size(), 3 * 4U) << "PSNR, APE, iterations and time of three rows";
}

TEST_F(Runs, APsnrThatChangedIsDifferent) {
    const Cell c = finding(errors, with(errors, 2, "train_psnr_db", "28.1012"));
    EXPECT_EQ(c.verdict, Verdict::different);
    EXPECT_EQ(c.column, "train_psnr_db");
    EXPECT_EQ(c.row, "star, cpu-low, 2");
    EXPECT_EQ(c.before + " " + c.after, "28.1014 28.1012");
    EXPECT_NEAR(c.amount, 2e-4, 1e-10);
}

TEST_F(Runs, TolerancesAreOfTheColumn) {
    add("a", errors);
    add("b", with(with(errors, 2, "train_psnr_db", "28.1013"), 1, "train_ape", "5.5404"));
    EXPECT_TRUE(findings().empty()) << "the last digit of PSNR; 9e-5 of APE";
    EXPECT_EQ(finding(errors, with(errors, 1, "train_ape", "5.5405")).verdict, Verdict::different) << "1.1e-4";
    EXPECT_EQ(finding(errors, with(errors, 1, "iterations", "16")).verdict, Verdict::different) << "set by the config";
    for (const char* text : {"nan", "inf", ""})
        EXPECT_EQ(finding(errors, with(errors, 1, "train_psnr_db", text)).amount, HUGE_VAL) << text;
    EXPECT_EQ(finding(errors, with(errors, 3, "iterations", "15")).amount, HUGE_VAL) << "nothing, then something";
}

TEST_F(Runs, IterationsMayBeOneMoreOrLessButNotNever) {
    settings.experiment = "stopping", settings.file = "rules.csv";
    const Rows rules = {{"rule", "levels", "optimizer", "median_reached"},
                        {"residual", "0", "cg", "40"},
                        {"residual", "0", "sd", "-1"}};
    add("a", rules);
    add("b", with(rules, 1, "median_reached", "41"));
    EXPECT_TRUE(findings().empty());
    EXPECT_EQ(finding(rules, with(rules, 1, "median_reached", "42")).amount, 2);
    EXPECT_EQ(finding(rules, with(rules, 2, "median_reached", "0")).amount, HUGE_VAL) << "never, then at once";
}

TEST_F(Runs, RowsColumnsAndFilesOfOneRunOnly) {
    Rows fewer = errors;
    fewer.erase(fewer.begin() + 2);
    EXPECT_EQ(finding(errors, fewer).verdict, Verdict::missing);
    EXPECT_EQ(finding(fewer, errors).verdict, Verdict::added);
    EXPECT_EQ(finding(fewer, errors).row, "star, cpu-low, 2");

    Rows narrower = errors;
    for (auto& row : narrower) row.erase(row.begin() + 4);
    EXPECT_EQ(finding(errors, narrower).verdict, Verdict::missing);
    EXPECT_EQ(finding(errors, narrower).column, "train_ape");
    EXPECT_EQ(finding(narrower, errors).verdict, Verdict::added);
}

TEST_F(Runs, RowsMayStandInAnyOrder) {
    Rows turned = errors;
    std::reverse(turned.begin() + 1, turned.end());
    for (auto& row : turned) std::swap(row[0], row[4]);
    add("a", errors);
    add("b", turned);
    EXPECT_TRUE(findings().empty());
}

/// Five timings of one thing.
Rows timings(std::vector<double> seconds) {
    Rows table = {{"problem", "passes", "source", "repetition", "line_s"}};
    for (size_t i = 0; i < seconds.size(); ++i)
        table.push_back({"Lafortune", "paper", "disk", std::to_string(i), fmt::format("{:.6g}", seconds[i])});
    return table;
}

TEST_F(Runs, RepetitionsTellATime) {
    settings.experiment = "streaming", settings.file = "iterations.csv";
    const Rows before = timings({1.000, 1.004, 0.998, 1.002, 1.001});
    const auto against = [&](const Rows& again, const Rows& after) {  // two runs of the old program, one of the new
        fs::remove_all(root());
        settings.revision = "old";
        add("a", before);
        add("a", again);
        settings.revision = "new";
        add("b", after);
        return cells().at(0);
    };
    const Rows slower = timings({1.050, 1.052, 1.049, 1.055, 1.047});
    const Cell c = against(before, slower);
    EXPECT_EQ(c.verdict, Verdict::slower);
    EXPECT_NEAR(c.amount, 1.049, 1e-3);
    EXPECT_EQ(against(before, timings({0.950, 0.952, 0.949, 0.955, 0.947})).verdict, Verdict::faster);
    EXPECT_EQ(against(before, before).verdict, Verdict::same);
    const Cell noisy = against(timings({1.080, 1.084, 1.078, 1.082, 1.081}), slower);
    EXPECT_EQ(noisy.verdict, Verdict::unclear) << "run to run the old program differs by more";
    ASSERT_TRUE(noisy.interval);
    EXPECT_LT(noisy.interval->low, 1);
    EXPECT_GT(noisy.interval->high, 1);
}

TEST_F(Runs, OneRunOfEachProgramDoesNotTellATime) {
    settings.experiment = "streaming", settings.file = "iterations.csv";
    add("a", timings({1, 1, 1, 1, 1}));
    settings.revision = "new";
    add("b", timings({2, 2, 2, 2, 2}));
    const Cell c = cells().at(0);
    EXPECT_EQ(c.verdict, Verdict::unclear);
    EXPECT_EQ(c.reason,
              "no two runs of one program tell how much this time differs from run to run; repeat either side");
}

TEST_F(Runs, TwoRunsOfOneProgramAreNeitherFasterNorSlower) {
    settings.experiment = "streaming", settings.file = "iterations.csv";
    for (const double a : {1.0, 49.0, 3.0})
        for (const double b : {2.0, 1.0, 49.0}) {
            fs::remove_all(root());
            add("a", timings({a, a, a, a, a}));
            add("b", timings({b, b, b, b, b}));
            EXPECT_EQ(cells().at(0).verdict, a == b ? Verdict::same : Verdict::unclear) << a << " " << b;
        }
}

TEST_F(Runs, OneTimingTellsNothing) {
    add("a", errors);
    add("b", with(errors, 1, "seconds", "15.9"));
    const std::vector<Cell> all = findings(true);
    ASSERT_EQ(all.size(), 3U);
    for (const Cell& c : all) EXPECT_EQ(c.reason, "1 and 1 timings; it takes 3 of each");
}

TEST_F(Runs, SeveralRunsOfARevisionTellATime) {
    const auto run = [&](const std::string& side, const char* revision, const char* seconds) {
        settings.revision = revision;
        add(side, with(errors, 1, "seconds", seconds));
    };
    for (const char* seconds : {"1.60", "1.62", "1.61"}) run("a", "old", seconds);
    for (const char* seconds : {"1.90", "1.88", "1.93"}) run("b", "new", seconds);
    const auto slower = [&] {
        const std::vector<Cell> all = findings();
        return std::ranges::any_of(
            all, [](const Cell& c) { return c.row == "star, cpu-low, 1" && c.verdict == Verdict::slower; });
    };
    EXPECT_TRUE(slower());
    EXPECT_EQ(findings()[0].before, "1.61");
    run("a", "older", "9.9");  // the newest is another program, measured once
    EXPECT_FALSE(slower());
}

TEST_F(Runs, ARevisionWithChangedFilesIsNotRepeated) {
    settings.revision = "abc-dirty";
    for (int i = 0; i < 3; ++i) add("a", errors), add("b", errors);
    EXPECT_EQ(pair().pairs.at(0).before.size(), 1U);
}

TEST_F(Runs, TimesOfAnotherDeviceOrConfigAreUnclearAccuracyIsNot) {
    settings = {.experiment = "streaming", .file = "iterations.csv"};
    for (const auto& [setting, value, reason] : {std::tuple(&Settings::device, "other", "of another device"),
                                                 {&Settings::config, R"({"side": 8})", "of another config"}}) {
        fs::remove_all(root() / "a");
        fs::remove_all(root() / "b");
        add("a", timings({1, 1, 1, 1, 1}));
        Settings changed = settings;
        changed.*setting = value;
        add("b", timings({2, 2, 2, 2, 2}), changed);
        const std::vector<Cell> all = findings(true);
        ASSERT_EQ(all.size(), 1U);
        EXPECT_EQ(all[0].verdict, Verdict::unclear);
        EXPECT_EQ(all[0].reason, reason);
        EXPECT_EQ(what_sets_apart(pair().pairs.at(0)).size(), 1U);
    }
    settings = {};
    fs::remove_all(root());
    add("a", errors);
    settings.device = "other";
    add("b", with(errors, 1, "train_psnr_db", "20"));
    EXPECT_EQ(findings().at(0).verdict, Verdict::different);
}

TEST_F(Runs, WhatIsOfOtherWorkIsNotCompared) {
    settings = {.experiment = "solvers", .file = "solvers.csv"};
    const Rows solvers = {
        {"solver", "setting", "vertices", "reached_share"}, {"als", "", "18", "1"}, {"varpro", "", "60", "1"}};
    add("a", solvers);
    add("b", with(with(solvers, 1, "vertices", "17"), 1, "reached_share", "0.5"));
    const std::vector<Cell> all = findings(true);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].reason, "of other vertices");
    EXPECT_EQ(all[0].row, "als");
}

TEST_F(Runs, ASlowMachinesFewerProblemsAreNotMissing) {
    settings = {.experiment = "solvers", .file = "problems.csv"};
    Rows problems = {
        {"solver", "setting", "vertex", "channel", "error"}, {"als", "", "4", "r", "1"}, {"als", "", "5", "r", "1"}};
    add("a", problems);
    problems.pop_back();
    add("b", problems);
    EXPECT_TRUE(findings(true).empty());
}

TEST_F(Runs, DevicesRowsAreMatchedByTheirKind) {
    settings = {.experiment = "fig10_utilization", .file = "peaks.csv"};
    const Rows peaks = {{"device", "peak", "per_second"}, {"llvmpipe", "bytes", "1"}, {"cpu, 2 threads", "bytes", "2"}};
    add("a", peaks);
    add("b", with(with(peaks, 1, "device", "NVIDIA"), 2, "device", "cpu, 64 threads"));
    EXPECT_TRUE(findings(true).empty());
}

TEST_F(Runs, NewestOfEachDeviceAndProfileArePaired) {
    add("a", errors);
    const fs::path newest = add("a", errors);
    add("b", errors);
    settings.device = "other";
    add("b", errors);
    Settings streaming = {.experiment = "streaming", .file = "iterations.csv"};
    add("a", timings({1}), streaming);
    const Pairing both = pair();
    ASSERT_EQ(both.pairs.size(), 1U);
    EXPECT_EQ(both.pairs[0].before[0].folder, newest);
    EXPECT_EQ(both.pairs[0].before.size(), 2U) << "the older one repeats it";
    EXPECT_EQ(both.only_before, std::vector<std::string>{"streaming (smoke, cpu, 2 cores, 2 threads)"});
    EXPECT_EQ(both.only_after, std::vector<std::string>{"fig9_error (smoke, other, 2 cores, 2 threads)"});
    EXPECT_TRUE(pair("fig7").pairs.empty());
    EXPECT_EQ(pair("fig").pairs.size(), 1U);
    EXPECT_TRUE(pair("fig").only_before.empty());
}

TEST_F(Runs, RunsAreFoundAtEveryLevelAndHiddenOnesAreNot) {
    const fs::path run = add("a", errors);
    add("a", errors);
    EXPECT_EQ(find_runs(run).size(), 1U);
    for (const fs::path& folder : {run.parent_path(), run.parent_path().parent_path(), root() / "a"})
        EXPECT_EQ(find_runs(folder).size(), 2U) << folder;
    EXPECT_LT(find_runs(root() / "a")[1].utc, find_runs(root() / "a")[0].utc);
    EXPECT_THROW(find_runs(root()), UserError) << "one level too high: results/reference is no part of results";
    fs::rename(run, run.parent_path() / ".radiafit-tmp-1-1-x");
    EXPECT_EQ(find_runs(root() / "a").size(), 1U);
}

TEST_F(Runs, OthersThanStandardRunsAreTakenWhereTheyAreNamed) {
    add("a", errors);
    const fs::path other = add("a", errors);
    std::string record = read_file(other / "run.json", "record");
    record.insert(1, "\"standard\": false, ");
    write_file(other / "run.json", record);
    ASSERT_EQ(find_runs(root() / "a").size(), 1U);
    EXPECT_NE(find_runs(root() / "a")[0].folder, other);
    EXPECT_EQ(find_runs(other).at(0).folder, other);
}

TEST_F(Runs, WhatCannotBeReadOrMatchedIsNamed) {
    add("a", errors);
    const fs::path run = add("b", errors);
    const std::string file = (run / "errors.csv").string();
    const auto refused = [&](const std::string& text) {
        write_file(file, text);
        const std::string message = refusal();
        EXPECT_TRUE(message.starts_with(file)) << message;
        return message.substr(std::min(message.size(), file.size()));
    };
    EXPECT_EQ(refused("dataset,method,terms,speed\n"),
              ": column 'speed' of fig9_error has no rule; say what it is in experiments/rows");
    EXPECT_EQ(refused("dataset,method,terms,terms\n"), ": column 'terms' appears twice; remake the file");
    EXPECT_EQ(refused("dataset,method,terms\na,b,1\na,b,1\n"), ": two rows of 'a, b, 1'; remake the file");
    EXPECT_TRUE(refused("dataset,method\na,b\n").starts_with(": no column 'terms', by which rows of "));
    EXPECT_TRUE(
        refused("dataset,method,terms,train_ape\nstar,mean,1,x\n").starts_with(":2: 'x' in column 'train_ape'"));
    fs::rename(file, run / "other.csv");
    EXPECT_TRUE(refusal().ends_with(
        "other.csv: no rules for this file of fig9_error; say what its columns are in experiments/rows"));
    fs::remove(run / "run.json");
    EXPECT_TRUE(refusal().ends_with(": rows without their run.json; run the experiment again"));
}

// Times.

std::vector<double> draw(Rng& rng, size_t count, double level, double spread) {
    std::vector<double> values(count);
    for (double& x : values) x = level * (1 + spread * (2 * rng.uniform() - 1));
    return values;
}

TEST(Times, NoiseIsUnclearATightDifferenceIsNot) {
    Rng rng(5);
    for (const size_t count : {3, 4, 5, 9}) {
        EXPECT_EQ(judge_times(draw(rng, count, 1, 0.3), draw(rng, count, 1.05, 0.3), 1).verdict, Verdict::unclear)
            << count;
        EXPECT_EQ(judge_times(draw(rng, count, 1, 0.005), draw(rng, count, 1.05, 0.005), 1).verdict, Verdict::slower)
            << count;
        EXPECT_EQ(judge_times(draw(rng, count, 1.05, 0.005), draw(rng, count, 1, 0.005), 1).verdict, Verdict::faster)
            << count;
        EXPECT_EQ(judge_times(draw(rng, count, 1, 0.003), draw(rng, count, 1.005, 0.003), 1).verdict, Verdict::same)
            << count;
    }
}

// A mean would say: four times as slow.
TEST(Times, ADisturbedTimingChangesNothing) {
    const std::vector<double> calm = {1.000, 1.005, 0.995, 1.000, 1.005, 1.000, 0.995, 1.000, 1.005};
    std::vector<double> disturbed = calm;
    disturbed[3] = 30;
    EXPECT_EQ(judge_times(calm, disturbed, 1).verdict, Verdict::same);
}

// Two sides of one distribution: how often they come out faster or slower.
TEST(Times, FalseAlarmsAreFew) {
    Rng rng(6);
    for (const size_t count : {3, 4, 5, 6, 10}) {
        int alarms = 0;
        for (int trial = 0; trial < 300; ++trial)
            alarms += judge_times(draw(rng, count, 1, 0.2), draw(rng, count, 1, 0.2), 1).verdict != Verdict::unclear;
        EXPECT_LE(alarms, 12) << count << " timings";  // at most 5 are expected
    }
}

TEST(Times, WhatDiffersFromRunToRunWidensTheInterval) {
    const std::vector<double> before = {1.000, 1.001, 0.999, 1.000, 1.001}, after = {1.1, 1.1, 1.1, 1.1, 1.1};
    const Interval narrow = *judge_times(before, after, 1).interval, wide = *judge_times(before, after, 1.2).interval;
    EXPECT_NEAR(wide.low, narrow.low / 1.2, 1e-12);
    EXPECT_NEAR(wide.high, narrow.high * 1.2, 1e-12);
    EXPECT_EQ(judge_times(before, after, 1).verdict, Verdict::slower);
    EXPECT_EQ(judge_times(before, after, 1.2).verdict, Verdict::unclear);
    EXPECT_EQ(judge_times(before, after, {}).verdict, Verdict::unclear);
}

TEST(Times, WhatIsNoTime) {
    EXPECT_EQ(judge_times({0, 0}, {0}, 1).verdict, Verdict::same) << "nothing is streamed";
    EXPECT_EQ(judge_times({1, 1, 1}, {1, 0, 1}, 1).verdict, Verdict::unclear);
    EXPECT_EQ(judge_times({1, 1, 1}, {1, NAN, 1}, 1).verdict, Verdict::unclear);
    EXPECT_EQ(judge_times({}, {1}, 1).reason, "no timing");
}

}  // namespace
}  // namespace radiafit
