#pragma once
#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/choose.h"
#include "base/error.h"
#include "base/output_claims.h"
#include "base/range.h"
#include "base/rings.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Command lines whose options are checked by their rule as they are read. CLI11 parses them; its header, half a minute
/// of compilation, is seen by one file only.
namespace radiafit::harness {

/// "--surface-side" is "surface-side" in messages; of "-o,--output" the last name is the plain one.
std::string plain_name(const std::string& names);

/// What there is of a command line, for pages and completions.
struct OptionDescription {
    std::vector<std::string> names;    ///< "-o", "--output"; of a positional argument its name
    std::string type, default_text;    ///< "INT", "FLOAT", "TEXT", "NAME"; empty of a flag
    std::string help, group;           ///< group: in --help; empty for options in none
    std::vector<std::string> choices;  ///< where values are names
    bool positional = false, required = false;
};
struct CommandDescription {
    std::string name, about;
    std::vector<OptionDescription> options;
    std::vector<CommandDescription> commands;
};

/// What an option's values are to its command.
struct OptionNotes {
    std::vector<std::string> choices;  ///< for completions: values that there are
    bool input = false;                ///< files or folders that are read, or texts that may name one
    bool idle = false;                 ///< what the command writes is the same whatever it is
};

/// An option or positional argument of a command.
class CommandOption {
public:
    CommandOption(CLI::Option& option, OptionNotes& notes) : option_(&option), notes_(&notes) {}
    CommandOption& choices(std::vector<std::string> names);  ///< these three: see OptionNotes
    CommandOption& input();
    CommandOption& idle();
    CommandOption& required();
    CommandOption& excludes(const std::string& other);  ///< an option of the same command, named before
    CommandOption& hide_default();                      ///< of a default that means "not given"
    CommandOption& group(const std::string& name);      ///< of --help

private:
    CLI::Option* option_;
    OptionNotes* notes_;
};

/// A program, or one of its commands.
class CommandLine {
public:
    /// A program. `version` is what --version prints, if anything.
    CommandLine(const std::string& name, const std::string& about, const std::string& version = "");
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    /// Adds a command, of which one has to be given. It lives as long as this.
    CommandLine& add_command(const std::string& name, const std::string& about);
    /// What runs once the whole command line is read, if this command is in it.
    void on_run(std::function<void()> run);
    /// Says what the command writes, once its options are read, and adds --replace: what is there already is left, and
    /// UserError names it, unless this very command made it of the same input: then `tell_done` runs in place of the
    /// command. `more_input`: what is read and no option marked as input names.
    void writes(std::function<std::vector<OutputTarget>()> targets, std::function<void()> tell_done = {},
                std::function<std::vector<std::filesystem::path>()> more_input = {});

    /// False where only help or the version was asked for, and printed. Throws UserError: one line with what is wrong,
    /// the nearest name that exists, and the cure; and whatever a command throws.
    bool parse(int argc, const char* const* argv);
    CommandDescription describe() const;
    /// Whether an option is in the command line.
    bool given(const std::string& name) const;

    // Names are "--name", "-n,--name", or without a dash of a positional argument. Values are written while the command
    // line is parsed, and must outlive that.
    /// Gives `read` the option's text in the command line.
    CommandOption add(const std::string& name, const std::string& type, const std::string& default_text,
                      const std::string& help, const std::function<void(const std::string&)>& read);
    /// Any text.
    CommandOption add_word(const std::string& name, std::string& value, const std::string& help);
    /// Any texts, one per time that the option is given.
    CommandOption add_words(const std::string& name, std::vector<std::string>& values, const std::string& help);
    /// All positional arguments, one at least.
    CommandOption add_rest(const std::string& name, std::vector<std::string>& values, const std::string& help);
    /// So many numbers, between commas or blanks.
    CommandOption add_numbers(const std::string& name, std::vector<double>& values, int count, const std::string& help);
    /// "--yes" or "--yes,!--no".
    CommandOption add_flag(const std::string& name, bool& value, const std::string& help);
    /// A flag that does something as it is read.
    CommandOption add_switch(const std::string& name, const std::function<void()>& act, const std::string& help);

    /// A number. `value` may have a narrower type than the range, or be optional.
    template <class T, class Number>
    CommandOption add_number(const std::string& name, T& value, const Range<Number>& range, const std::string& help) {
        std::string default_text;
        if constexpr (std::is_arithmetic_v<T>) default_text = fmt::format("{}", value);
        return add(name, std::is_integral_v<Number> ? "INT" : "FLOAT", default_text, help,
                   [&value, range, plain = plain_name(name)](const std::string& text) {
                       value = static_cast<T>(parse_number(plain, text, range));
                   });
    }
    /// A file, a folder or another text that says nothing if it is empty.
    template <class Text>
    CommandOption add_text(const std::string& name, Text& value, const std::string& help) {
        return add(name, "TEXT", std::string(value), help, [&value, plain = plain_name(name)](const std::string& text) {
            if (text.empty()) throw UserError(fmt::format("{} = '': give a name", plain));
            value = text;
        });
    }
    /// A name for one of several values.
    template <class Choice>
    CommandOption add_choice(const std::string& name, Choice& value,
                             std::vector<std::pair<std::string, Choice>> choices, const std::string& help) {
        std::vector<std::string> names;
        for (const auto& choice : choices) names.push_back(choice.first);
        return add(name, "NAME", "", help,
                   [&value, choices = std::move(choices), plain = plain_name(name)](const std::string& text) {
                       value = choose(plain, text, choices);
                   })
            .choices(std::move(names));
    }

private:
    explicit CommandLine(CLI::App& app);
    CommandOption described(CLI::Option& option);
    void run_once(const std::function<void()>& run) const;
    MadeBy made_by_this() const;

    std::unique_ptr<CLI::App> own_;  ///< of a program
    CLI::App* app_;
    std::vector<std::unique_ptr<CommandLine>> commands_;
    std::map<const CLI::Option*, OptionNotes> notes_;
    std::function<std::vector<OutputTarget>()> targets_;
    std::function<void()> tell_done_;
    std::function<std::vector<std::filesystem::path>()> more_input_;
    bool replace_ = false;
};

}  // namespace radiafit::harness
