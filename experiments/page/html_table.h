#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "page/html.h"
#include "report/table.h"

namespace radiafit::harness {

/// A field of a table, or a row of them, and the attributes of its element.
struct HtmlCell {
    HtmlCell(Html content, Attributes own = {}) : inside(std::move(content)), attributes(std::move(own)) {}
    Html inside;
    Attributes attributes;
};
struct HtmlRow {
    std::vector<HtmlCell> cells;
    Attributes attributes = {};
};

/// A <table> with its caption, a <thead> of column headers, and the first field of each row as that row's header.
/// `numeric`: columns whose fields are of class "number"; none where it is shorter. Throws std::logic_error for a row
/// that is not as long as the header.
Html html_table(const Html& caption, const std::vector<std::string>& header, const std::vector<HtmlRow>& rows,
                const std::vector<bool>& numeric = {}, const Attributes& attributes = {});
Html html_table(const Html& caption, const Table& table);

/// A box of the page's width in which something wider scrolls, by keyboard too. `label`: what is in it.
Html scroll_box(const std::string& label, const Html& inside);

/// What our experiments write as Markdown: headings (as <h4>), paragraphs, and Table::markdown()'s tables, each in a
/// scroll box. `label`: what the tables are of.
Html html_of_markdown(const std::string& label, std::string_view text);

}  // namespace radiafit::harness
