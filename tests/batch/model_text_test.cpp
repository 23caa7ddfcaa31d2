#include "batch/model_text.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace radiafit::batch {
namespace {

const std::string line_text = R"(// A line.
struct Terms { real x; };
struct Parameters {
    real slope, offset;  // of the line
};
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(p.slope * t.x + p.offset); }
)";

std::string complaint(const std::string& text) {
    try {
        read_model("line.glsl", text);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}
std::string replaced(const std::string& from, const std::string& to) {
    std::string text = line_text;
    return text.replace(text.find(from), from.size(), to);
}

TEST(ModelText, NamesAreThoseOfTheStructs) {
    const ModelText model = read_model("line.glsl", line_text);
    EXPECT_EQ(model.terms, std::vector<std::string>{"x"});
    EXPECT_EQ(model.parameters, (std::vector<std::string>{"slope", "offset"}));
    EXPECT_EQ(model.values, std::vector<std::string>{"y"});
    EXPECT_EQ(read_model("a", replaced("real slope, offset;", "real slope; real offset ;")).parameters.size(), 2u);
    EXPECT_EQ(read_model("a", replaced("// A line.", "/* struct Terms { real no; };\n */")).terms[0], "x");
}

TEST(ModelText, ComplaintsNameTheLine) {
    EXPECT_EQ(complaint(replaced("struct Terms { real x; };", "")),
              "line.glsl: has no Terms; write it as `struct Terms { real NAME, ...; };`");
    EXPECT_EQ(complaint(replaced("real slope, offset;", "float slope, offset;")).substr(0, 12), "line.glsl:4:");
    EXPECT_NE(complaint(replaced("offset;", "slope;")).find("line.glsl:4: Parameters has two members slope"),
              std::string::npos);
    EXPECT_NE(complaint(replaced("real x;", "real x[3];")).find("line.glsl:2: expected `,` or `;` behind x"),
              std::string::npos);
    EXPECT_NE(complaint(replaced("real x;", "")).find("Terms has no members"), std::string::npos);
    EXPECT_NE(complaint(replaced("// A line.", "#include <string>")).find("line.glsl:1: #include"), std::string::npos);
    EXPECT_NE(complaint(replaced("value(", "values(")).find("has no function `Values value(Parameters p, Terms t)"),
              std::string::npos);
    for (const char* cut : {"struct", "struct Terms", "struct Terms {", "struct Terms { real", "struct Terms { real x",
                            "struct Terms { real x,", "struct Terms { real x;", ""})
        EXPECT_NE(complaint(cut), "") << cut;
}

TEST(ModelText, MoreThanThereIsRoomForIsRefused) {
    std::string many = "struct Parameters { real p0";
    for (size_t i = 1; i <= most_parameters; ++i) many += ", p" + std::to_string(i);
    EXPECT_NE(complaint(replaced("struct Parameters {\n    real slope, offset;  // of the line\n}", many + "; }"))
                  .find("Parameters has 33 members; 32 at most"),
              std::string::npos);
}

}  // namespace
}  // namespace radiafit::batch
