// Maps of pages as they are stored, and pages as they are written.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/rng.h"
#include "publish/coded_map.h"
#include "publish/page.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace tools;
namespace {

namespace fs = std::filesystem;

PageMap random_map(float most, bool root) {
    PageMap map{.name = "map", .image = {33, 17, {"R", "G", "B"}, {}, {}}, .root = root};
    for (size_t i = 0; i < 33 * 17 * 3; ++i)
        map.image.values.push_back(i % 7 == 0 ? 0 : most * (2 * random_uniform(3, i) - 1));
    return map;
}

class CodedMaps : public ::testing::TestWithParam<bool> {};

TEST_P(CodedMaps, ComeBackToHalfAStepAndZerosToZero) {
    for (const float most : {0.1f, 3.0f, 800.0f})
        for (const float step : {0.01f, 0.002f}) {
            const PageMap map = random_map(most, GetParam());
            const CodedMap coded = code_map(stepped_map(map, {step, 2 * step, 4 * step}));
            const PageMap decoded = decoded_map(stepped_map(coded), map);
            for (size_t i = 0; i < map.image.values.size(); ++i) {
                const float before = map.image.values[i], after = decoded.image.values[i];
                if (before == 0) {
                    EXPECT_EQ(after, 0);
                    continue;
                }
                // Steps are as asked for, but where 16 bits would not do.
                const float wanted = step * float(1 << i % 3), used = coded.scale[i % 3];
                EXPECT_LE(used, std::max(wanted, 2.1f * most / 65000));
                const float off = std::abs(stored_number(map, after) - stored_number(map, before));
                EXPECT_LE(off, 0.501f * used + 1e-5f * most) << i << " of " << most;
            }
        }
}

TEST_P(CodedMaps, OfFewStepsHaveOneImage) {
    const auto coded = [](float step) { return code_map(stepped_map(random_map(1, GetParam()), {step, step, step})); };
    EXPECT_TRUE(coded(0.01f).high.empty());
    EXPECT_FALSE(coded(0.001f).high.empty());
}

INSTANTIATE_TEST_SUITE_P(AsTheyAreAndAsRoots, CodedMaps, ::testing::Bool());

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Page, ReplacesItsLikeAloneAndEscapesText) {
    const TemporaryFolder folder;
    const fs::path place = folder.path() / "page", file = folder.path() / "page.html", other = folder.path() / "mine";
    Page page{"<a & \"b\">", R"({"about":"</script><!--"})", {{"map", std::string("\0\1\2\3", 4)}}};
    write_page(place, false, page);
    EXPECT_NE(text_of(place / "index.html").find("&lt;a &amp; &quot;b&quot;>"), std::string::npos);
    EXPECT_EQ(text_of(place / "data" / "page.js"), "window.radiafit_page = {\"about\":\"<\\/script><\\!--\"};\n");
    EXPECT_EQ(text_of(place / "data" / "map.js"), "radiafit_data(\"map\", \"AAECAw==\");\n");
    page.blobs = {{"other", "x"}};
    write_page(place, false, page);
    EXPECT_FALSE(fs::exists(place / "data" / "map.js"));
    write_file(place / "notes.txt", "mine");
    EXPECT_THROW(write_page(place, false, page), UserError);
    write_file(other, "no page");
    EXPECT_THROW(check_page_target(other, true), UserError);
    EXPECT_THROW(check_page_target(other, false), UserError);
    write_page(file, true, page);
    EXPECT_NO_THROW(check_page_target(file, true));
}

}  // namespace
}  // namespace radiafit
