#include "report/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace radiafit::harness {

Columns::Columns(const char* names, const ColumnType& type, const char* what) : type(type), what(what) {
    std::istringstream words(names);
    for (std::string name; words >> name;) this->names.push_back(name);
}

bool RowFile::covers(std::string_view file) const {
    return name_.starts_with('*') ? file.ends_with(std::string_view(name_).substr(1)) : file == name_;
}

const ColumnRule* RowFile::rule(std::string_view column) const {
    for (const Columns& group : columns_)
        if (std::ranges::count(group.names, column) || group.names[0] == "*") return &group.type.rule;
    return nullptr;
}

std::vector<std::string> RowFile::header(const std::vector<std::string>& several) const {
    std::vector<std::string> header;
    for (const Columns& group : columns_) {
        const std::vector<std::string>& names = group.names[0] == "*" ? several : group.names;
        header.insert(header.end(), names.begin(), names.end());
    }
    return header;
}

void append_field(Fields& fields, double value, const char* format) {
    fields.push_back(fmt::format(fmt::runtime(format), value));
}

}  // namespace radiafit::harness
