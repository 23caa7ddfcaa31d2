#include "gl/driver_advice.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <regex>

namespace radiafit {
namespace fs = std::filesystem;
namespace {

bool is_there(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
}

/// "535.183.01" of "NVRM version: NVIDIA UNIX x86_64 Kernel Module  535.183.01  Sun May 12 …", whose open modules say
/// "UNIX Open Kernel Module for x86_64"; empty where the file says none.
std::string nvidia_version(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::smatch found;
    return std::regex_search(line, found, std::regex(R"(Kernel Module.*?\s(\d+(\.\d+)+)\s)")) ? found[1].str() : "";
}

std::string of_nvidia(const fs::path& root) {
    constexpr const char* container = "NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility";
    const std::string version = nvidia_version(root / "proc/driver/nvidia/version");
    const std::string driver = "an NVIDIA driver" + (version.empty() ? "" : " (" + version + ")");
    if (!is_there(root / "dev/nvidiactl"))
        return fmt::format(
            "{} is loaded, but none of its devices is to be seen, as in a container: start it with its "
            "GPUs and {}",
            driver, container);
    return fmt::format(
        "{} is loaded, but its OpenGL is not to be found: in a container, start it with {} and install "
        "libegl1; elsewhere install the packages libegl1 and libnvidia-gl-{} (Debian: libegl-nvidia0)",
        driver, container, version.empty() ? "VERSION" : version.substr(0, version.find('.')));
}

/// The first of the kernel's render nodes; empty where there is none.
fs::path render_node(const fs::path& root) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(root / "dev/dri", ignored))
        if (entry.path().filename().string().starts_with("renderD")) return entry.path();
    return {};
}

std::string of_node(const fs::path& node) {
    if (::access(node.c_str(), R_OK | W_OK) != 0)
        return fmt::format("{} may not be opened by this user: join the group that owns it (render or video)",
                           node.string());
    return fmt::format(
        "{} is there, but no OpenGL of its driver: install libegl-mesa0 and libgl1-mesa-dri, or what the "
        "chip's maker has",
        node.string());
}

}  // namespace

ChipSigns look_for_chip(const fs::path& root) {
    if (is_there(root / "proc/driver/nvidia/version") || is_there(root / "dev/nvidiactl"))
        return {.nvidia = true, .advice = of_nvidia(root)};
    const fs::path node = render_node(root);
    return {.advice = node.empty() ? "" : of_node(node)};
}

}  // namespace radiafit
