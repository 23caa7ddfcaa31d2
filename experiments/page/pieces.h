#pragma once
#include <string>

#include "page/html.h"
#include "report/row_files.h"

/// What several parts of the report are put together from.
namespace radiafit::harness {

/// A verdict as a mark that is recognized by its word and shape as well as by its colour.
Html verdict_mark(const std::string& verdict);
/// The mark "not run", and why.
Html not_run(const std::string& why);
/// A command line as it is typed.
Html command_line(const std::string& command);
Html link(const std::string& target, const Html& inside);

/// Rows for people: a table of a CSV file, in which a column that says the same in all rows moves to the caption.
/// Throws UserError as read_rows() does.
Html rows_table(const RunRecord& run, const std::string& file);

/// An image within the page: of SVG and PNG the one that is sharper, unless it is large. `files`: without extension;
/// `alt`: what is to be seen.
Html image(const std::filesystem::path& files, const std::string& alt);

}  // namespace radiafit::harness
