// Pages and what they are put together from.
#include "page/html.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "page/html_table.h"

namespace radiafit {
using namespace harness;
namespace {

TEST(Html, TextIsEscapedWhereverItStands) {
    const std::string text = "<b a=\"1\">'x' & y</b>";
    const std::string safe = "&lt;b a=&quot;1&quot;&gt;&#39;x&#39; &amp; y&lt;/b&gt;";
    EXPECT_EQ(Html(text).source(), safe);
    EXPECT_EQ(element("p", {{"title", text}}, text).source(), "<p title=\"" + safe + "\">" + safe + "</p>\n");
}

TEST(Html, WhatNoBrowserMayReadIsReplaced) {
    const std::string unknown = "\xef\xbf\xbd";
    EXPECT_EQ(Html(std::string("a\0b\x1b\x7f", 5)).source(), "a" + unknown + "b" + unknown + unknown);
    EXPECT_EQ(Html("two\n\tlines").source(), "two\n\tlines");
    EXPECT_EQ(Html("\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80").source(), "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80");
    EXPECT_EQ(Html("\xe2\x82").source(), unknown + unknown) << "cut";
    EXPECT_EQ(Html("\xc0\xaf").source(), unknown + unknown) << "a slash in too many bytes";
    EXPECT_EQ(Html("\xed\xa0\x80").source(), unknown + unknown + unknown) << "half of a pair";
    EXPECT_EQ(Html("\xf5\x80\x80\x80").source(), unknown + unknown + unknown + unknown) << "beyond U+10FFFF";
}

TEST(Html, ElementsNest) {
    Html list;
    for (const char* item : {"one", "two"}) list << element("li", item);
    EXPECT_EQ(element("ul", list).source(), "<ul><li>one</li>\n<li>two</li>\n</ul>\n");
    EXPECT_EQ((Html("see ") << element("a", {{"href", "#x"}}, "this") << ".").source(), "see <a href=\"#x\">this</a>.");
    EXPECT_EQ(empty_element("img", {{"alt", ""}}).source(), "<img alt=\"\">\n");
}

TEST(Html, WhatIsNoElementIsRefused) {
    EXPECT_THROW(element("", "x"), std::logic_error);
    EXPECT_THROW(element("p onclick", "x"), std::logic_error);
    EXPECT_THROW(element("p", {{"a b", "1"}}, "x"), std::logic_error);
    EXPECT_THROW(element("p", {{"id", "1"}, {"id", "2"}}, "x"), std::logic_error);
    EXPECT_THROW(element("img", "x"), std::logic_error);
    EXPECT_THROW(empty_element("p", {}), std::logic_error);
    EXPECT_THROW(style_sheet("p::after { content: '</STYLE>' }"), std::logic_error);
    EXPECT_THROW(script("const text = '</script>';"), std::logic_error);
    EXPECT_THROW(script("const text = '<!-- <script>';"), std::logic_error);
    EXPECT_EQ(style_sheet("p > a { color: red }\n").source(), "<style>\np > a { color: red }\n</style>\n");
}

TEST(Html, PageHasHeadAndBody) {
    EXPECT_EQ(html_page(element("title", "A & B"), element("p", "x")),
              "<!doctype html>\n<html lang=\"en\">\n<head><title>A &amp; "
              "B</title>\n</head>\n<body><p>x</p>\n</body>\n</html>\n");
}

// RFC 4648, 10.
TEST(Html, FilesWithinThePage) {
    const std::pair<const char*, const char*> known[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"},
                                                         {"\xff\xfe\xfd", "//79"}};
    for (const auto& [bytes, text] : known)
        EXPECT_EQ(data_uri("image/png", bytes), std::string("data:image/png;base64,") + text);
}

Table sample() {
    Table table({"name", "a|b", "seconds"});
    table.add({"x | <y>", "", "1.5"});
    table.add({"z", "text", "20"});
    return table;
}

TEST(HtmlTable, HeadersFieldsAndNumbers) {
    EXPECT_EQ(
        html_table("what it is", sample()).source(),
        "<table><caption>what it is</caption>\n<thead><tr><th scope=\"col\">name</th>\n<th scope=\"col\">a|b</th>\n"
        "<th scope=\"col\" class=\"number\">seconds</th>\n</tr>\n</thead>\n"
        "<tbody><tr><th scope=\"row\">x | &lt;y&gt;</th>\n<td></td>\n<td class=\"number\">1.5</td>\n</tr>\n"
        "<tr><th scope=\"row\">z</th>\n<td>text</td>\n<td class=\"number\">20</td>\n</tr>\n</tbody>\n</table>\n");
    EXPECT_THROW(html_table({}, {"a", "b"}, {{{Html("one")}}}), std::logic_error);
}

TEST(HtmlTable, MarkdownTablesComeBackAsTheyWere) {
    EXPECT_EQ(html_of_markdown("t", sample().markdown()).source(), scroll_box("t", html_table({}, sample())).source());
}

TEST(HtmlTable, MarkdownAroundTables) {
    const std::string page = "# Head & line\n\nOne\nparagraph.\n\n" + sample().markdown() + "\nAfter | it\n";
    EXPECT_EQ(html_of_markdown("t", page).source(), "<h4>Head &amp; line</h4>\n<p>One paragraph.</p>\n" +
                                                        scroll_box("t", html_table({}, sample())).source() +
                                                        "<p>After | it</p>\n");
    for (const char* odd :
         {"", "|", "||", "| a |", "| a |\n|", "| a |\n| - |", "| a |\n| - |\n| b | c |\n", "#", "\n\n"})
        EXPECT_NO_THROW(html_of_markdown("t", odd)) << odd;
}

}  // namespace
}  // namespace radiafit
