#include "command_line/command_line.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "base/config.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/running_command.h"
#include "base/wording.h"
#include "command_line/input_state.h"

namespace radiafit::harness {
namespace {

/// The command that was reached, a subcommand's subcommand at last.
const CLI::App& reached(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    return chosen.empty() ? app : reached(*chosen.front());
}

std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

/// The options of a command and of all commands above it.
std::vector<std::string> options_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* at = &app; at; at = at->get_parent())
        for (const CLI::Option* option : at->get_options())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// A command's name below the program's: "import colmap".
std::string words_of(const CLI::App& command) {
    std::string words;
    for (const CLI::App* at = &command; at->get_parent(); at = at->get_parent())
        words = at->get_name() + (words.empty() ? "" : " " + words);
    return words;
}

/// One line for a command line that could not be parsed.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = reached(app);
    const std::vector<std::string> rest = app.remaining(true), commands = commands_of(command);
    const std::string unknown = rest.empty() ? "" : rest.front();
    const std::string help =
        fmt::format("see {} {}--help", app.get_name(), words_of(command).append(command.get_parent() ? " " : ""));
    if (unknown.starts_with("-"))
        return fmt::format("option '{}' does not exist; the nearest is {}; {}", unknown,
                           nearest(unknown.substr(0, unknown.find('=')), options_of(command)), help);
    if (!unknown.empty() && !commands.empty())
        return fmt::format("command '{}' does not exist; choose one of {} (nearest: {}); {}", unknown,
                           fmt::join(commands, ", "), nearest(unknown, commands), help);
    if (!unknown.empty()) return fmt::format("'{}' is one argument too many; leave it out, or {}", unknown, help);
    return fmt::format("{}; {}", error.what(), help);
}

}  // namespace

std::string plain_name(const std::string& names) {
    const std::string last = names.substr(names.find_last_of(',') + 1);
    return last.substr(last.find_first_not_of('-'));
}

CommandOption& CommandOption::choices(std::vector<std::string> names) {
    notes_->choices = std::move(names);
    return *this;
}
CommandOption& CommandOption::input() {
    notes_->input = true;
    return *this;
}
CommandOption& CommandOption::idle() {
    notes_->idle = true;
    return *this;
}
CommandOption& CommandOption::required() {
    option_->required();
    return *this;
}
CommandOption& CommandOption::excludes(const std::string& other) {
    option_->excludes(other);
    return *this;
}
CommandOption& CommandOption::hide_default() {
    option_->default_str("");
    return *this;
}
CommandOption& CommandOption::group(const std::string& name) {
    option_->group(name);
    return *this;
}

CommandLine::CommandLine(const std::string& name, const std::string& about, const std::string& version)
    : own_(std::make_unique<CLI::App>(about, name)), app_(own_.get()) {
    if (!version.empty()) app_->set_version_flag("--version", version);
    app_->fallthrough();  // its options may come after a command
}
CommandLine::CommandLine(CLI::App& app) : app_(&app) {}
CommandLine::~CommandLine() = default;

CommandLine& CommandLine::add_command(const std::string& name, const std::string& about) {
    app_->require_subcommand(1);
    commands_.push_back(std::unique_ptr<CommandLine>(new CommandLine(*app_->add_subcommand(name, about))));
    return *commands_.back();
}

void CommandLine::on_run(std::function<void()> run) {
    app_->callback([this, run = std::move(run)] {
        set_running_command(words_of(*app_));
        targets_ ? run_once(run) : run();
    });
}

void CommandLine::writes(std::function<std::vector<OutputTarget>()> targets, std::function<void()> tell_done,
                         std::function<std::vector<std::filesystem::path>()> more_input) {
    targets_ = std::move(targets);
    tell_done_ = std::move(tell_done);
    more_input_ = std::move(more_input);
    add_flag("--replace", replace_,
             "put the new one in the place of an earlier output, which stays until the new one is whole")
        .idle();
}

void CommandLine::run_once(const std::function<void()>& run) const {
    std::vector<OutputTarget> targets = targets_();
    const OutputClaims claims(std::move(targets), made_by_this(), replace_);
    if (!claims.done()) return run();
    log_info(fmt::format("{}: done already, by this command on the same input; {} does it again", claims.names(),
                         option_name("replace")));
    if (tell_done_) tell_done_();
}

MadeBy CommandLine::made_by_this() const {
    std::string all;
    for (const CLI::Option* option : app_->get_options()) {
        const auto found = notes_.find(option);
        if (found == notes_.end() || found->second.idle || option->count() == 0) continue;
        all += option->get_name() + "\n";
        for (const std::string& value : option->results())
            all += (found->second.input ? input_state(value) : value) + "\n";
    }
    if (more_input_)
        for (const std::filesystem::path& path : more_input_()) all += input_state(path) + "\n";
    return {words_of(*app_), fmt::format("{:016x}", hash_byte_by_byte(all.data(), all.size()))};
}

bool CommandLine::parse(int argc, const char* const* argv) {
    try {
        app_->parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0) throw UserError(explain(*app_, e));
        app_->exit(e);
        return false;
    }
    return true;
}

bool CommandLine::given(const std::string& name) const { return app_->count(name) > 0; }

CommandOption CommandLine::described(CLI::Option& option) { return CommandOption(option, notes_[&option]); }

CommandDescription CommandLine::describe() const {
    CommandDescription out{app_->get_name(), app_->get_description(), {}, {}};
    for (const CLI::Option* option : app_->get_options()) {
        OptionDescription o;
        for (const std::string& name : option->get_snames()) o.names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) o.names.push_back("--" + name);
        o.positional = o.names.empty();
        if (o.positional) o.names.push_back(option->get_name());
        if (option->get_type_size() != 0) o.type = option->get_type_name();
        o.default_text = option->get_default_str();
        o.help = option->get_description();
        o.group = option->get_group() == "Options" ? "" : option->get_group();
        o.required = option->get_required();
        if (const auto found = notes_.find(option); found != notes_.end()) o.choices = found->second.choices;
        out.options.push_back(std::move(o));
    }
    for (const auto& command : commands_) out.commands.push_back(command->describe());
    return out;
}

CommandOption CommandLine::add(const std::string& name, const std::string& type, const std::string& default_text,
                               const std::string& help, const std::function<void(const std::string&)>& read) {
    CLI::Option* option = app_->add_option_function<std::string>(name, read, help);
    option->type_name(type);
    if (!default_text.empty()) option->default_str(default_text);
    return described(*option);
}

CommandOption CommandLine::add_word(const std::string& name, std::string& value, const std::string& help) {
    return add(name, "TEXT", value, help, [&value](const std::string& text) { value = text; });
}

CommandOption CommandLine::add_words(const std::string& name, std::vector<std::string>& values,
                                     const std::string& help) {
    return described(*app_->add_option(name, values, help)->allow_extra_args(false));
}

CommandOption CommandLine::add_rest(const std::string& name, std::vector<std::string>& values,
                                    const std::string& help) {
    return described(*app_->add_option(name, values, help)->expected(1, 1 << 20));
}

CommandOption CommandLine::add_numbers(const std::string& name, std::vector<double>& values, int count,
                                       const std::string& help) {
    return described(*app_->add_option(name, values, help)->expected(count)->delimiter(','));
}

CommandOption CommandLine::add_flag(const std::string& name, bool& value, const std::string& help) {
    return described(*app_->add_flag(name, value, help));
}

CommandOption CommandLine::add_switch(const std::string& name, const std::function<void()>& act,
                                      const std::string& help) {
    return described(*app_->add_flag_callback(name, act, help));
}

}  // namespace radiafit::harness
