#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

/// Reads a text file line by line and knows where it is, so that every complaint can name file and line.
class TextFile {
public:
    /// Lines may end as any system ends them. A byte order mark is left out, and UTF-16 that begins with one becomes
    /// UTF-8. Throws UserError when the file cannot be read, is UTF-16 without a mark or damaged UTF-16, or holds zero
    /// bytes, as after a crash of the system that wrote it; `what` names its role, such as "gain table".
    TextFile(const std::filesystem::path& file, const std::string& what);
    /// A text already read, which begins after `lines_before` lines of the file.
    TextFile(std::filesystem::path file, std::string text, size_t lines_before);

    /// The next line, trimmed of blanks at both ends; false at the end of the file. Stays valid as long as this. A last
    /// line without a line break, which is how many editors leave a file but also how a cut file ends, is taken; who
    /// then asks for more without complaining about it warns of it.
    bool next_line(std::string_view& line);
    /// Whether a line break ends the line last read, or it is blank or a comment.
    bool ended() const { return ended_; }
    /// The next line that is neither blank nor a comment (#).
    bool next_entry(std::string_view& line);

    size_t line_number() const { return number_; }
    std::string where() const;  ///< "file:line" of the line last read
    /// Throws a UserError at the line last read, which says so where no line break ends that line.
    [[noreturn]] void fail(const std::string& problem) const;

    /// Whole-token conversions; `what` names the quantity. A value that is no number, not finite (double, float) or out
    /// of range is a UserError.
    double to_double(std::string_view token, const char* what) const;
    float to_float(std::string_view token, const char* what) const;
    uint64_t to_unsigned(std::string_view token, const char* what) const;
    int64_t to_signed(std::string_view token, const char* what) const;

private:
    std::filesystem::path file_;
    std::string text_;
    size_t at_ = 0, number_ = 0;
    bool ended_ = true;
};

/// UTF-8 without a byte order mark, its lines ended by line feeds, of text as any editor saves it. Throws UserError as
/// TextFile does.
std::string plain_text(std::string text, const std::filesystem::path& file);

/// Tokens of a line between blanks and tabs.
std::vector<std::string_view> split_tokens(std::string_view line);

}  // namespace radiafit
