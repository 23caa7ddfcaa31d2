#pragma once
#include <cmath>

#include "base/statistics.h"
#include "report/columns.h"
#include "report/csv.h"

namespace radiafit::harness {

/// Rows of a file, each a struct, written as the file's columns say. The file appears at commit(), as CsvWriter's does.
template <class Row>
class CsvFile {
public:
    /// several: names of the columns that "*" stands for; dataset: what a "*" in the file's name stands for.
    CsvFile(const std::filesystem::path& folder, const RowFileOf<Row>& file,
            const std::vector<std::string>& several = {}, const std::string& dataset = "")
        : file_(file),
          writer_(folder / (file.name()[0] == '*' ? dataset + file.name().substr(1) : file.name()),
                  file.header(several)) {}
    void add(const Row& row) { writer_.row(file_.fields(row)); }
    void commit() { writer_.commit(); }

private:
    const RowFileOf<Row>& file_;
    CsvWriter writer_;
};

/// The ends of an interval, as columns `low` and `high` have them: empty where there is none.
struct IntervalEnds {
    std::optional<double> low, high;
};
inline IntervalEnds ends_of(const std::optional<Interval>& interval) {
    return interval ? IntervalEnds{interval->low, interval->high} : IntervalEnds{};
}

/// The value; nothing where it is not a number.
inline std::optional<double> unless_nan(double value) {
    return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// All rows of a file.
template <class Row>
void write_rows(const std::filesystem::path& folder, const RowFileOf<Row>& file, const std::vector<Row>& rows,
                const std::string& dataset = "") {
    CsvFile<Row> csv(folder, file, {}, dataset);
    for (const Row& row : rows) csv.add(row);
    csv.commit();
}

}  // namespace radiafit::harness
