#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

/// Reads a text file line by line and knows where it is, so that every complaint can name file and line.
class TextFile {
public:
    /// Throws UserError when the file cannot be opened; `what` names its role, such as "gain table".
    TextFile(const std::filesystem::path& file, const std::string& what);

    /// The next line, trimmed of blanks at both ends; false at the end of the file.
    bool next_line(std::string_view& line);
    /// The next line that is neither blank nor a comment (#).
    bool next_entry(std::string_view& line);

    std::string where() const;  ///< "file:line" of the line last read
    [[noreturn]] void fail(const std::string& problem) const;

    /// Whole-token conversions; `what` names the quantity. A value that is no number, not finite (double) or out of
    /// range is a UserError.
    double to_double(std::string_view token, const char* what) const;
    uint64_t to_unsigned(std::string_view token, const char* what) const;

private:
    std::filesystem::path file_;
    std::ifstream stream_;
    std::string line_;
    size_t number_ = 0;
};

/// Tokens of a line between blanks and tabs.
std::vector<std::string_view> split_tokens(std::string_view line);

}  // namespace radiafit
