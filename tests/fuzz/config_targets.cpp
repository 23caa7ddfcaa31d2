#include "base/config.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

template <class T>
void take(Config& config, const char* key) {
    T value{};
    config.read(key, value);
}

void read_config(const fs::path& folder) {
    for (const char* profile : {"", "smoke"}) {
        Config config(folder / "experiment.toml", profile, {"count=3", "names=[\"a\", \"b\"]"});
        take<bool>(config, "on");
        take<int>(config, "count");
        take<int64_t>(config, "large");
        take<double>(config, "share");
        take<std::string>(config, "name");
        take<std::vector<std::string>>(config, "names");
        take<std::vector<int>>(config, "counts");
        take<std::vector<double>>(config, "shares");
        config.finish();
    }
}

/// The text of `--set name=TEXT`.
void read_override(const fs::path& folder) {
    Config config(folder / "experiment.toml", "", {"name=" + bytes_of(folder / "override")});
    take<std::string>(config, "name");
    config.finish();
}

std::vector<std::string> overrides(const fs::path& folder) {
    put_bytes(folder / "experiment.toml", "name = 'a'\n");
    return {"\"star\"", "star", "2024", "1979-05-27"};
}

}  // namespace

std::vector<Target> config_targets() {
    const std::string seed =
        "# an experiment\non = true\ncount = 25\nlarge = 9_000_000_000\nshare = 1.5e-3\nname = \"star\"\n"
        "names = ['a', \"b\\u00fc\"]\ncounts = [1, 2,\n 3]\nshares = [0.5, 2]\n";
    const std::string finite =
        "shares = [0.5, 2]\ncounts = [0x10, 0o7, 0b1]\n[profile.smoke]\ncount = 2\n"
        "name = '''x'''\n[profile.paper]\nshare = 1\n";
    return {{"config", "experiment.toml",
             [=](const fs::path&) {
                 return std::vector<std::string>{finite, seed + "[profile.smoke]\non = false\n"};
             },
             read_config},
            {"config_override", "override", overrides, read_override}};
}

}  // namespace radiafit::fuzz
