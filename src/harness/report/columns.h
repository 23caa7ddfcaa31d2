#pragma once
#include <concepts>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/rings.h"

/// What the columns of a file of rows are. One description, in experiments/rows/NAME.h, is what an experiment writes
/// its rows by (report/csv_file.h), what `radiafit compare` judges two runs by, and what docs/results.md says of them.
namespace radiafit::harness {

enum class ColumnKind {
    key,         ///< rows of two runs that have the same keys are compared
    device,      ///< a key, of which only counts whether it is the CPU or OpenGL
    repetition,  ///< rows with the same keys measured the same several times
    work,        ///< what a row's other figures are of: where it differs, nothing of the row is compared
    exact,       ///< an accuracy figure, or a count, that is the same in every run: compared as text
    absolute,    ///< an accuracy figure with a tolerance in its own unit
    relative,    ///< an accuracy figure with a tolerance as a share of the larger of the two
    iterations,  ///< a count of iterations; below 0: never, which is like no count
    time,        ///< seconds: the lower the better
    memory,      ///< bytes that were reckoned or counted: the same in every run
    shown        ///< said by the experiment, not compared
};

struct ColumnRule {
    ColumnKind kind;
    double tolerance = 0;   ///< of absolute, relative and iterations
    const char* unit = "";  ///< of absolute, in messages
};

/// How a column is compared and written.
struct ColumnType {
    ColumnRule rule;
    const char* format = "{}";  ///< of fmt, for numbers with a point
    const char* unit = "";      ///< in docs/results.md

    ColumnType in(const char* other_unit) const { return {rule, format, other_unit}; }
};

namespace columns {

constexpr ColumnType key(const char* format = "{}") { return {{ColumnKind::key}, format}; }
constexpr ColumnType device() { return {{ColumnKind::device}}; }
constexpr ColumnType repetition() { return {{ColumnKind::repetition}}; }
constexpr ColumnType work() { return {{ColumnKind::work}}; }
constexpr ColumnType exact(const char* format = "{}") { return {{ColumnKind::exact}, format}; }
/// PSNR is written with four digits: its last one may round the other way.
constexpr ColumnType decibels(const char* format) { return {{ColumnKind::absolute, 1e-4, "dB"}, format, "dB"}; }
/// PSNR of fits that are stopped on their way.
constexpr ColumnType rough_decibels(const char* format) { return {{ColumnKind::absolute, 0.01, "dB"}, format, "dB"}; }
/// Shares of problems, texels or vertices: one in a thousand may fall on the other side of a threshold.
constexpr ColumnType shares(const char* format) { return {{ColumnKind::absolute, 1e-3}, format, "share"}; }
/// Errors are sums of squares in 32 bits, written with four to eight digits.
constexpr ColumnType errors(const char* format, double tolerance = 1e-4) {
    return {{ColumnKind::relative, tolerance}, format};
}
/// An error that passes a threshold by a rounding does so one iteration sooner or later.
constexpr ColumnType iterations(const char* format = "{}") {
    return {{ColumnKind::iterations, 1}, format, "iterations"};
}
/// Ratios of such counts of iterations.
constexpr ColumnType ratios(const char* format) { return {{ColumnKind::relative, 0.01}, format}; }
constexpr ColumnType times(const char* format) { return {{ColumnKind::time}, format, "s"}; }
constexpr ColumnType memory() { return {{ColumnKind::memory}, "{}", "bytes"}; }
constexpr ColumnType shown(const char* format = "{}") { return {{ColumnKind::shown}, format}; }

/// In place of what a column is: an earlier file of the experiment says it.
inline constexpr const char* as_before = nullptr;
/// A slow machine writes fewer rows: those of one run only say nothing.
inline constexpr bool partial = true;

}  // namespace columns

/// Neighbouring columns that are described in one line.
struct Columns {
    const char* spaced_names;  ///< between blanks; "*" is any number of columns, named where the file is written
    ColumnType type;
    const char* what;  ///< or as_before

    std::vector<std::string> names() const;
    bool any() const { return *spaced_names == '*'; }
};

/// Throws std::logic_error unless `columns` has so many names.
void require_as_many(const Columns& columns, int count);

/// A file of rows that some experiment leaves.
class RowFile {
public:
    /// name: may begin with "*", which stands for a dataset's name. what: of a row.
    RowFile(const char* name, const char* what, std::vector<Columns> columns, bool partial = false)
        : name_(name), what_(what), columns_(std::move(columns)), partial_(partial) {}

    const std::string& name() const { return name_; }
    const char* what() const { return what_; }
    const std::vector<Columns>& columns() const { return columns_; }
    bool partial() const { return partial_; }
    bool covers(std::string_view file) const;
    /// The rule of a column; null if there is none.
    const ColumnRule* rule(std::string_view column) const;
    /// The header of a file with `several` columns in place of "*".
    std::vector<std::string> header(const std::vector<std::string>& several) const;

private:
    std::string name_;
    const char* what_;
    std::vector<Columns> columns_;
    bool partial_;
};

using Fields = std::vector<std::string>;
inline void append_field(Fields& fields, const std::string& text, const char*) { fields.push_back(text); }
void append_field(Fields& fields, double value, const char* format);
inline void append_field(Fields& fields, bool value, const char*) { fields.emplace_back(value ? "1" : "0"); }
template <std::integral Whole>
void append_field(Fields& fields, Whole value, const char*) {
    fields.push_back(std::to_string(value));
}
/// Nothing is an empty field.
template <class Value>
void append_field(Fields& fields, const std::optional<Value>& value, const char* format) {
    if (value)
        append_field(fields, *value, format);
    else
        fields.emplace_back();
}
template <class Value>
void append_field(Fields& fields, const std::vector<Value>& values, const char* format) {
    for (const Value& value : values) append_field(fields, value, format);
}

/// Writes a member of a row, whatever its type.
template <class Row>
struct MemberWriter {
    constexpr MemberWriter() = default;
    template <class Value>
    MemberWriter(Value Row::*member)
        : member(reinterpret_cast<char Row::*>(member)),
          write([](const MemberWriter& w, const Row& row, Fields& fields, const char* format) {
              append_field(fields, row.*reinterpret_cast<Value Row::*>(w.member), format);
          }) {}

    char Row::*member = nullptr;
    void (*write)(const MemberWriter&, const Row&, Fields&, const char* format) = nullptr;
};

/// Columns and the members of a row that they show, in order. Nothing to destroy, so that long lists compile fast.
template <class Row>
struct ColumnsOf : Columns {
    using Member = MemberWriter<Row>;
    /// Throws std::logic_error unless there is a member for each name.
    ColumnsOf(const char* names, const ColumnType& type, const char* what, Member a, Member b = {}, Member c = {},
              Member d = {})
        : Columns{names, type, what}, members{a, b, c, d} {
        require_as_many(*this, bool(a.write) + bool(b.write) + bool(c.write) + bool(d.write));
    }
    void write(const Row& row, Fields& fields) const {
        for (const Member& member : members)
            if (member.write) member.write(member, row, fields, type.format);
    }

    Member members[4];
};

template <class Row>
class RowFileOf : public RowFile {
public:
    RowFileOf(const char* name, const char* what, std::initializer_list<ColumnsOf<Row>> columns, bool partial = false)
        : RowFile(name, what, {columns.begin(), columns.end()}, partial), columns_of_(columns) {}
    Fields fields(const Row& row) const {
        Fields fields;
        for (const ColumnsOf<Row>& columns : columns_of_) columns.write(row, fields);
        return fields;
    }

private:
    std::vector<ColumnsOf<Row>> columns_of_;
};

}  // namespace radiafit::harness
