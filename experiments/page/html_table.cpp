#include "page/html_table.h"

#include <stdexcept>

namespace radiafit::harness {
namespace {

Attributes with(Attributes attributes, const char* name, const char* value) {
    attributes.emplace_back(name, value);
    return attributes;
}

/// The fields of a line of a pipe table, "\|" read back.
std::vector<std::string> fields_of(std::string_view line) {
    std::vector<std::string> fields(1);
    for (size_t i = 1; i < line.size(); ++i) {
        if (line.substr(i, 2) == "\\|")
            fields.back() += line[++i];
        else if (line[i] == '|')
            fields.emplace_back();
        else
            fields.back() += line[i];
    }
    fields.pop_back();  // behind the last bar
    for (std::string& field : fields) {
        field.erase(0, field.find_first_not_of(' '));
        field.erase(field.find_last_not_of(' ') + 1);
    }
    return fields;
}

bool is_row(std::string_view line) { return line.size() > 1 && line.starts_with('|') && line.ends_with('|'); }
bool is_rule(std::string_view line) { return is_row(line) && line.find_first_not_of("|-: ") == std::string_view::npos; }

/// The table whose header is line `at`; moves `at` behind it. Rows are cut or padded to the header's length.
Table table_at(const std::vector<std::string_view>& lines, size_t& at) {
    const std::vector<std::string> header = fields_of(lines[at]);
    Table table(header);
    for (at += 2; at < lines.size() && is_row(lines[at]); ++at) {
        std::vector<std::string> fields = fields_of(lines[at]);
        fields.resize(header.size());
        table.add(std::move(fields));
    }
    return table;
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        lines.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

}  // namespace

Html html_table(const Html& caption, const std::vector<std::string>& header, const std::vector<HtmlRow>& rows,
                const std::vector<bool>& numeric, const Attributes& attributes) {
    const auto is_numeric = [&](size_t column) { return column < numeric.size() && numeric[column]; };
    Html names, body;
    for (size_t i = 0; i < header.size(); ++i) {
        Attributes own = {{"scope", "col"}};
        names << element("th", is_numeric(i) ? with(own, "class", "number") : own, header[i]);
    }
    for (const HtmlRow& row : rows) {
        if (row.cells.size() != header.size())
            throw std::logic_error("html_table: as many fields as the header, please");
        Html fields;
        for (size_t i = 0; i < row.cells.size(); ++i) {
            const auto& [inside, own] = row.cells[i];
            const Attributes all = is_numeric(i) ? with(own, "class", "number") : own;
            fields << (i == 0 ? element("th", with(all, "scope", "row"), inside) : element("td", all, inside));
        }
        body << element("tr", row.attributes, fields);
    }
    Html inside;
    if (!caption.empty()) inside << element("caption", caption);
    inside << element("thead", element("tr", names)) << element("tbody", body);
    return element("table", attributes, inside);
}

Html html_table(const Html& caption, const Table& table) {
    std::vector<bool> numeric;
    for (size_t i = 0; i < table.header().size(); ++i) numeric.push_back(table.numeric(i));
    std::vector<HtmlRow> rows;
    for (const auto& fields : table.rows()) {
        rows.emplace_back();
        for (const std::string& field : fields) rows.back().cells.emplace_back(field);
    }
    return html_table(caption, table.header(), rows, numeric);
}

Html scroll_box(const std::string& label, const Html& inside) {
    return element("div", {{"class", "scroll"}, {"role", "region"}, {"aria-label", label}, {"tabindex", "0"}}, inside);
}

Html html_of_markdown(const std::string& label, std::string_view text) {
    const std::vector<std::string_view> lines = lines_of(text);
    Html html;
    for (size_t at = 0; at < lines.size();) {
        if (is_row(lines[at]) && at + 1 < lines.size() && is_rule(lines[at + 1])) {
            html << scroll_box(label, html_table({}, table_at(lines, at)));
        } else if (lines[at].starts_with('#')) {
            const std::string_view heading = lines[at++];
            html << element("h4", heading.substr(std::min(heading.find_first_not_of("# "), heading.size())));
        } else if (lines[at].empty()) {
            ++at;
        } else {
            std::string paragraph(lines[at++]);
            while (at < lines.size() && !lines[at].empty() && !lines[at].starts_with('#') && !is_row(lines[at]))
                paragraph.append(1, ' ').append(lines[at++]);
            html << element("p", paragraph);
        }
    }
    return html;
}

}  // namespace radiafit::harness
