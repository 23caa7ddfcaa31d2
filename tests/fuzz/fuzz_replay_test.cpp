// Without a fuzzer: every target reads its seeds, whole and cut, and what fuzzing once found.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "target.h"

namespace radiafit::fuzz {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

class Reader : public ::testing::TestWithParam<Target> {
protected:
    Bench bench_{GetParam()};
};

TEST_P(Reader, TakesItsSeeds) {
    ASSERT_FALSE(bench_.seeds().empty());
    for (size_t i = 0; i < bench_.seeds().size(); ++i) EXPECT_TRUE(bench_.read(bench_.seeds()[i])) << "seed " << i;
}

TEST_P(Reader, RefusesOrTakesWhatIsCut) {
    for (const std::string& seed : bench_.seeds())
        for (size_t part = 0; part < 50; ++part) EXPECT_NO_THROW(bench_.read(seed.substr(0, seed.size() * part / 50)));
}

TEST_P(Reader, SurvivesWhatFuzzingFound) {
    const fs::path folder = fs::path(RADIAFIT_FUZZ_FINDINGS) / GetParam().name;
    if (!fs::is_directory(folder)) return;
    for (const auto& entry : fs::directory_iterator(folder))
        EXPECT_NO_THROW(bench_.read(bytes_of(entry.path()))) << entry.path();
}

TEST(FuzzFindings, BelongToTargets) {
    const std::vector<Target> all = targets();
    for (const auto& entry : fs::directory_iterator(RADIAFIT_FUZZ_FINDINGS)) {
        const std::string name = entry.path().filename().string();
        EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Target& t) { return t.name == name; })) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Reader, ::testing::ValuesIn(targets()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace radiafit::fuzz
