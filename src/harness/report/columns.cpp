#include "report/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace radiafit::harness {

std::vector<std::string> Columns::names() const {
    std::istringstream words(spaced_names);
    return {std::istream_iterator<std::string>(words), {}};
}

void require_as_many(const Columns& columns, int count) {
    if (columns.names().size() != size_t(count))
        throw std::logic_error(std::string(columns.spaced_names) + ": a member for each");
}

bool RowFile::covers(std::string_view file) const {
    return name_.starts_with('*') ? file.ends_with(std::string_view(name_).substr(1)) : file == name_;
}

const ColumnRule* RowFile::rule(std::string_view column) const {
    for (const Columns& group : columns_)
        if (group.any() || std::ranges::count(group.names(), column)) return &group.type.rule;
    return nullptr;
}

std::vector<std::string> RowFile::header(const std::vector<std::string>& several) const {
    std::vector<std::string> header;
    for (const Columns& group : columns_) {
        const std::vector<std::string> names = group.any() ? several : group.names();
        header.insert(header.end(), names.begin(), names.end());
    }
    return header;
}

void append_field(Fields& fields, double value, const char* format) {
    fields.push_back(fmt::format(fmt::runtime(format), value));
}

}  // namespace radiafit::harness
