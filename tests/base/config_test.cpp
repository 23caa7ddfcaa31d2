#include "base/config.h"

#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

constexpr const char* example = R"(# line 1
iterations = 100
rate = 2                 # an integer where a double is wanted
name = "star"
paper = false
solvers = ["cg", "sd"]
sides = [8, 16]
weights = [0.5, 1]

[profile.smoke]
iterations = 5
name = "bust"

[profile.standard]
)";

struct Options {
    bool paper = true;
    int iterations = 25;
    int64_t bytes = 1;
    double rate = 0.5;
    std::string name = "none";
    std::vector<std::string> solvers;
    std::vector<int> sides;
    std::vector<double> weights;

    void read(Config& config) {
        config.read("iterations", iterations);
        config.read("bytes", bytes);
        config.read("rate", rate);
        config.read("name", name);
        config.read("paper", paper);
        config.read("solvers", solvers);
        config.read("sides", sides);
        config.read("weights", weights);
    }
};

class ConfigTest : public ::testing::Test {
protected:
    std::string write(const std::string& text) {
        write_file(path_, text);
        return path_.string();
    }

    /// Message of the UserError from reading `text` as Options, with the file's path taken off.
    std::string error(const std::string& text, const std::string& profile = "",
                      const std::vector<std::string>& overrides = {}) {
        try {
            Config config(write(text), profile, overrides);
            Options options;
            options.read(config);
            config.finish();
        } catch (const UserError& user_error) {
            std::string message = user_error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << "not one line: " << message;
            if (message.starts_with(path_.string())) message.replace(0, path_.string().size(), "FILE");
            return message;
        }
        return "no error";
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "example.toml";
};

TEST_F(ConfigTest, TopLevelThenProfileThenOverride) {
    write(example);
    const auto read = [&](const std::string& profile, const std::vector<std::string>& overrides) {
        Config config(path_, profile, overrides);
        Options options;
        options.read(config);
        config.finish();
        return options;
    };
    const Options plain = read("", {});
    EXPECT_EQ(plain.iterations, 100);
    EXPECT_EQ(plain.bytes, 1) << "an absent key keeps the struct's default";
    EXPECT_EQ(plain.rate, 2.0);
    EXPECT_EQ(plain.name, "star");
    EXPECT_FALSE(plain.paper);
    EXPECT_EQ(plain.solvers, (std::vector<std::string>{"cg", "sd"}));
    EXPECT_EQ(plain.sides, (std::vector{8, 16}));
    EXPECT_EQ(plain.weights, (std::vector{0.5, 1.0}));
    const Options smoke = read("smoke", {});
    EXPECT_EQ(smoke.iterations, 5);
    EXPECT_EQ(smoke.name, "bust");
    EXPECT_EQ(smoke.rate, 2.0);
    EXPECT_EQ(read("standard", {}).iterations, 100);
    const Options set = read("smoke", {"iterations=7", "iterations=8", "name=2024", "paper=true", "sides=[1]",
                                       "bytes=5000000000", "solvers=[\"lm\"]"});
    EXPECT_EQ(set.iterations, 8);
    EXPECT_EQ(set.name, "2024");
    EXPECT_TRUE(set.paper);
    EXPECT_EQ(set.sides, (std::vector{1}));
    EXPECT_EQ(set.bytes, 5000000000);
    EXPECT_EQ(set.solvers, (std::vector<std::string>{"lm"}));
    EXPECT_EQ(read("", {"name=bare word"}).name, "bare word");
    EXPECT_EQ(read("", {"name=\"quoted\""}).name, "quoted");
}

TEST_F(ConfigTest, AnUnknownKeyNamesFileLineAndTheNearest) {
    EXPECT_EQ(error("name = 'x'\niteratons = 3\n"), "FILE:2: unknown key 'iteratons'; did you mean 'iterations'?");
    EXPECT_EQ(error("[profile.smoke]\nrat = 3\n"), "FILE:2: unknown key 'rat'; did you mean 'rate'?")
        << "also in a profile that isn't chosen";
    EXPECT_EQ(error("", "", {"sidez=[1]"}), "override sidez=[1]: unknown key 'sidez'; did you mean 'sides'?");
    EXPECT_EQ(error("[rate]\nx = 1\n"), "FILE:1: 'rate' must be a finite number, not a table");
}

TEST_F(ConfigTest, AWrongTypeNamesFileAndLine) {
    EXPECT_EQ(error("\niterations = 'many'"), "FILE:2: 'iterations' must be an integer of 32 bits, not a string");
    EXPECT_EQ(error("iterations = 1.5"), "FILE:1: 'iterations' must be an integer of 32 bits, not a number");
    EXPECT_EQ(error("iterations = 3000000000"), "FILE:1: 'iterations' must be an integer of 32 bits, not an integer");
    EXPECT_EQ(error("rate = nan"), "FILE:1: 'rate' must be a finite number, not a number");
    EXPECT_EQ(error("paper = 1"), "FILE:1: 'paper' must be true or false, not an integer");
    EXPECT_EQ(error("name = 3"), "FILE:1: 'name' must be a string, not an integer");
    EXPECT_EQ(error("sides = [1, 'two']"), "FILE:1: 'sides' must be a list of integers of 32 bits, not a list");
    EXPECT_EQ(error("sides = 8"), "FILE:1: 'sides' must be a list of integers of 32 bits, not an integer");
    EXPECT_EQ(error("iterations = 1\n[profile.other]\niterations = 'x'\n"),
              "FILE:3: 'iterations' must be an integer of 32 bits, not a string");
    EXPECT_EQ(error("", "", {"iterations=many"}),
              "override iterations=many: 'iterations' must be an integer of 32 bits, not a string");
}

TEST_F(ConfigTest, ARuleHoldsForEveryValueInAnyProfile) {
    const auto refusal = [&](const std::string& text, const std::vector<std::string>& overrides = {}) -> std::string {
        try {
            Config config(write(text + "\n[profile.smoke]\n"), "smoke", overrides);
            int terms = 1;
            std::vector<int> sides = {8};
            std::vector<double> levels = {0.5};
            std::vector<std::string> shapes = {"star"};
            config.read("terms", terms, Range<int>{1, 16});
            config.read("sides", sides, Range<int>{2, 64});
            config.read("levels", levels, Range<double>{0, 1});
            config.read("shapes", shapes, [](const std::string& name) {
                if (name != "star" && name != "bust") throw UserError("no shape " + name);
            });
        } catch (const UserError& e) {
            std::string message = e.what();
            if (message.starts_with(path_.string())) message.replace(0, path_.string().size(), "FILE");
            return message;
        }
        return "taken";
    };
    EXPECT_EQ(refusal("terms = 16\nsides = [2, 64]\nlevels = [0.0, 1]\nshapes = ['bust', 'star']"), "taken");
    EXPECT_EQ(refusal("\nterms = 17"), "FILE:2: terms = 17: choose a whole number from 1 to 16");
    EXPECT_EQ(refusal("[profile.other]\nterms = 0"), "FILE:2: terms = 0: choose a whole number from 1 to 16");
    EXPECT_EQ(refusal("sides = [8, 65]"), "FILE:1: sides = 65: choose a whole number from 2 to 64");
    EXPECT_EQ(refusal("levels = [-0.5]"), "FILE:1: levels = -0.5: choose a number from 0 to 1");
    EXPECT_EQ(refusal("shapes = ['star', 'moon']"), "FILE:1: no shape moon");
    for (const char* key : {"sides", "levels", "shapes"})
        EXPECT_EQ(refusal(std::string(key) + " = []"), "FILE:1: " + std::string(key) + " = []: give one or more");
    EXPECT_EQ(refusal("", {"sides=[]"}), "override sides=[]: sides = []: give one or more");
}

TEST_F(ConfigTest, AMalformedFileProfileOrOverride) {
    EXPECT_TRUE(error("a = 1\nb = \n").starts_with("FILE:2: ")) << error("a = 1\nb = \n");
    EXPECT_TRUE(error("a = 1\na = 2\n").starts_with("FILE:2: "));
    EXPECT_TRUE(error("a = 1\n[" + std::string(2, '\0') + "]").starts_with("FILE:2: a character that is no"));
    EXPECT_TRUE(error("[$").starts_with("FILE:1: "));
    EXPECT_TRUE(error("name = 3\u00fc").starts_with("FILE:1: a character that is no"));
    EXPECT_TRUE(error("name = '#' \u00fc").starts_with("FILE:1: a character that is no"));
    EXPECT_EQ(error("# \u00fc"), "no error");
    EXPECT_EQ(error("", "", {"name=\u00fc"}), "no error");
    EXPECT_EQ(error(example, "huge"), "FILE: no profile 'huge'; choose one of: smoke, standard");
    EXPECT_EQ(error("rate = 1", "smoke"), "FILE: no profile 'smoke'; add a table [profile.smoke]");
    EXPECT_EQ(error("profile = 3", "smoke"), "FILE:1: 'profile' must hold tables such as [profile.smoke]");
    EXPECT_EQ(error("[profile]\nsmoke = 1"), "FILE:2: 'profile.smoke' must be a table");
    EXPECT_EQ(error("", "", {"iterations"}), "override iterations: write it as key=value");
    EXPECT_EQ(error("", "", {"=3"}), "override =3: write it as key=value");
    EXPECT_THROW(Config("no/such/file.toml"), UserError);
}

TEST_F(ConfigTest, ResolvedHoldsDefaultsAndGivenValuesInReadingOrder) {
    Config config(write(example), "smoke", {"name=a\"b"});
    Options options;
    options.read(config);
    const std::vector<std::pair<std::string, std::string>> expected = {
        {"iterations", "5"},   {"bytes", "1"},          {"rate", "2.0"},
        {"name", R"("a\"b")"}, {"paper", "false"},      {"solvers", R"(["cg","sd"])"},
        {"sides", "[8,16]"},   {"weights", "[0.5,1.0]"}};
    EXPECT_EQ(config.resolved(), expected);
}

TEST_F(ConfigTest, RejectNamesWhereTheValueStands) {
    Config config(write("iterations = 3\n[profile.smoke]\niterations = -1\n"), "smoke");
    try {
        config.reject("iterations", "must be positive");
    } catch (const UserError& user_error) {
        EXPECT_EQ(std::string(user_error.what()), path_.string() + ":3: 'iterations' must be positive");
    }
}

TEST(EditDistance, OnKnownPairs) {
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);  // Levenshtein's textbook pair
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("abc", ""), 3u);
    EXPECT_EQ(edit_distance("same", "same"), 0u);
    EXPECT_EQ(nearest("lamda", {"rate", "lambda", "mu"}), "lambda");
    EXPECT_EQ(nearest("x", {}), "");
}

}  // namespace
}  // namespace radiafit
