#pragma once
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

/// The dialect of models' texts (docs/texel-models.md), as far as derivative_text needs to read it.
namespace radiafit {

struct Token {
    std::string text;
    int line;
    bool name() const;  ///< an identifier, or a word of the language
};

/// Throws UserError, "file:line: ...".
[[noreturn]] void refuse_text(const std::string& file, int line, const std::string& what);

/// A text without comments and without what C++ alone reads, as tokens; its definitions of constants apart.
class TextScanner {
public:
    /// read: what a file that the text includes holds; it must outlive the scanner.
    TextScanner(std::string file, const std::function<std::string(const std::string& file)>& read)
        : file_(std::move(file)), read_(read) {}
    /// Throws UserError at what is in no text of the dialect.
    void scan(const std::string& text);

    const std::vector<Token>& tokens() const { return tokens_; }
    /// Of a definition; empty: there is none.
    std::string value_of(const std::string& name) const { return defines(name) ? defined_.at(name) : ""; }
    bool defines(const std::string& name) const { return defined_.contains(name); }
    bool has_function(const std::string& name) const;
    /// What is not in the dialect, which says nothing where no derivatives are made.
    struct Unknown {
        std::string file;
        int line = 0;  ///< 0: there is none
        std::string what;
    };
    const Unknown& first_unknown() const { return unknown_; }

private:
    void add_tokens(const std::string& line, int number);
    void define(const std::string& rest, int number);
    void not_in_dialect(int number, const std::string& what);
    void include(const std::string& rest, int number);

    std::string file_;
    const std::function<std::string(const std::string&)>& read_;
    std::vector<Token> tokens_;
    std::map<std::string, std::string> defined_;
    std::set<std::string> included_;
    Unknown unknown_;
};

}  // namespace radiafit
