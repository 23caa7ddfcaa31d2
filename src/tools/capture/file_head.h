#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace radiafit::tools {

/// Words and numbers at the beginning of a file, behind them bytes. All throw UserError where the file ends before, or
/// holds something else.
class FileHead {
public:
    FileHead(std::filesystem::path file, std::string_view bytes) : file_(std::move(file)), rest_(bytes) {}

    /// Up to the line's end, without blanks there.
    std::string_view line();
    /// The next number between blanks and line breaks; `what` it is.
    double number(const char* what);
    int whole(const char* what, int least, int most);
    /// What behind the last number belongs to its line: blanks and a line break.
    void end_line();
    /// So many bytes.
    std::string_view bytes(uint64_t count);
    std::string_view rest() const { return rest_; }

    [[noreturn]] void fail(const std::string& why) const;
    const std::filesystem::path& file() const { return file_; }

private:
    std::string_view word(const char* what);

    std::filesystem::path file_;
    std::string_view rest_;
};

}  // namespace radiafit::tools
