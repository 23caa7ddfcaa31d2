// completion: what a shell reads to complete commands, options and values.
#include "cli/commands.h"
#include "command_line/completion.h"

namespace radiafit::tools {

void add_completion(CommandLine& program) {
    using Make = std::string (*)(const CommandDescription&);
    auto make = std::make_shared<Make>(nullptr);
    CommandLine& command = program.add_command("completion", "what a shell reads to complete commands and options");
    command
        .add_choice<Make>("shell", *make,
                          {{"bash", bash_completion}, {"zsh", zsh_completion}, {"fish", fish_completion}},
                          "bash, zsh or fish")
        .required();
    command.on_run([make, &program] { fmt::print("{}", (*make)(program.describe())); });
}

}  // namespace radiafit::tools
