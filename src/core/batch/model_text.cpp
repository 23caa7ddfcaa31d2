#include "batch/model_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "base/error.h"
#include "base/read_file.h"
#include "base/text_file.h"

namespace radiafit::batch {
namespace {

bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// The text with blanks in place of comments, line by line.
std::string without_comments(const std::string& text) {
    std::string out = text;
    for (size_t i = 0; i + 1 < out.size(); ++i) {
        const bool line = out[i] == '/' && out[i + 1] == '/', block = out[i] == '/' && out[i + 1] == '*';
        if (!line && !block) continue;
        const size_t found = text.find(line ? "\n" : "*/", i + 2);
        const size_t end = found == std::string::npos ? out.size() : line ? found : found + 2;
        for (; i < end; ++i)
            if (out[i] != '\n') out[i] = ' ';
        --i;
    }
    return out;
}

class Reader {
public:
    Reader(const std::string& name, const std::string& text) : name_(name), text_(without_comments(text)) {}

    [[noreturn]] void fail(size_t at, const std::string& problem) const {
        const auto line =
            1 + std::count(text_.begin(), text_.begin() + std::ptrdiff_t(std::min(at, text_.size())), '\n');
        throw UserError(fmt::format("{}:{}: {}", name_, line, problem));
    }
    [[noreturn]] void fail(const std::string& problem) const { throw UserError(fmt::format("{}: {}", name_, problem)); }

    void reject_directives() const {
        for (const char* directive : {"#include", "#version", "#line", "#extension"})
            if (const size_t at = find_directive(directive); at != std::string::npos)
                fail(at, fmt::format("{} can't be in a model's text; write all of the model into one file", directive));
    }

    /// The names of a struct's members.
    std::vector<std::string> members(const std::string& structure, size_t most) const {
        const std::string form = fmt::format("struct {} {{ real NAME, ...; }};", structure);
        size_t at = find_word("struct", 0);
        for (; at != std::string::npos; at = find_word("struct", at + 1))
            if (const size_t name = skip_blanks(at + 6); word_at(name) == structure) {
                at = skip_blanks(name + structure.size());
                break;
            }
        if (at == std::string::npos) fail(fmt::format("has no {}; write it as `{}`", structure, form));
        if (at >= text_.size() || text_[at] != '{') fail(at, fmt::format("expected `{}`", form));
        std::vector<std::string> names;
        for (at = skip_blanks(at + 1); at < text_.size() && text_[at] != '}'; at = skip_blanks(at)) {
            if (word_at(at) != "real") fail(at, fmt::format("members of {} are of type `real`: `{}`", structure, form));
            at += 4;
            do {
                at = skip_blanks(at);
                const std::string member(word_at(at));
                if (member.empty() || std::isdigit(static_cast<unsigned char>(member[0])))
                    fail(at, fmt::format("expected the name of a member of {}: `{}`", structure, form));
                if (std::ranges::count(names, member))
                    fail(at, fmt::format("{} has two members {}", structure, member));
                names.push_back(member);
                at = skip_blanks(at + member.size());
            } while (at < text_.size() && text_[at++] == ',');
            if (at > text_.size() || text_[at - 1] != ';')
                fail(at - 1, fmt::format("expected `,` or `;` behind {} in {}; members are numbers: `{}`", names.back(),
                                         structure, form));
        }
        if (names.empty()) fail(at, fmt::format("{} has no members; write it as `{}`", structure, form));
        if (names.size() > most)
            fail(at, fmt::format("{} has {} members; {} at most are possible", structure, names.size(), most));
        return names;
    }

    void require_value() const {
        for (size_t at = find_word("Values", 0); at != std::string::npos; at = find_word("Values", at + 1)) {
            const size_t name = skip_blanks(at + 6);
            if (word_at(name) == "value" && text_.substr(skip_blanks(name + 5), 1) == "(") return;
        }
        fail("has no function `Values value(Parameters p, Terms t) { ... }`");
    }

private:
    size_t skip_blanks(size_t at) const {
        while (at < text_.size() && std::isspace(static_cast<unsigned char>(text_[at]))) ++at;
        return at;
    }
    std::string_view word_at(size_t at) const {
        size_t end = at;
        while (end < text_.size() && is_name_part(text_[end])) ++end;
        return std::string_view(text_).substr(std::min(at, text_.size()), end - at);
    }
    size_t find_word(const std::string& word, size_t from) const {
        for (size_t at = text_.find(word, from); at != std::string::npos; at = text_.find(word, at + 1))
            if ((at == 0 || !is_name_part(text_[at - 1])) && word_at(at) == word) return at;
        return std::string::npos;
    }
    size_t find_directive(const std::string& directive) const {
        for (size_t at = text_.find('#'); at != std::string::npos; at = text_.find('#', at + 1))
            if (word_at(skip_blanks(at + 1)) == std::string_view(directive).substr(1)) return at;
        return std::string::npos;
    }

    std::string name_, text_;
};

}  // namespace

ModelText read_model(std::string name, std::string text) {
    const Reader reader(name, text);
    reader.reject_directives();
    ModelText model;
    model.terms = reader.members("Terms", most_terms);
    model.parameters = reader.members("Parameters", most_parameters);
    model.values = reader.members("Values", most_values);
    reader.require_value();
    model.name = std::move(name);
    model.text = std::move(text);
    return model;
}

ModelText read_model_file(const std::filesystem::path& file) {
    return read_model(file.string(), plain_text(read_file(file, "model"), file));
}

}  // namespace radiafit::batch
