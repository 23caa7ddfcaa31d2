#include "base/toml.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace radiafit {
namespace {

TEST(Toml, ValuesBecomeJson) {
    const auto json = nlohmann::json::parse(json_of_toml(
        "day = 2026-11-27\n[a]\nlist = [{ x = 1.5, y = true }, { x = 2 }]\n[[a.b]]\ntext = \"O(N\u00b3)\"\n"));
    EXPECT_EQ(json["day"], "2026-11-27");
    EXPECT_EQ(json["a"]["list"][0]["x"], 1.5);
    EXPECT_EQ(json["a"]["list"][0]["y"], true);
    EXPECT_EQ(json["a"]["list"][1]["x"], 2);
    EXPECT_EQ(json["a"]["b"][0]["text"], "O(N\u00b3)");
}

TEST(Toml, ErrorsNameTheLine) {
    for (const char* text : {"a = 1\nb =\n", "a = 1\nb = 12:00:00\n"}) try {
            json_of_toml(text);
            ADD_FAILURE() << text;
        } catch (const std::logic_error& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with("line 2: ")) << e.what();
        }
}

}  // namespace
}  // namespace radiafit
