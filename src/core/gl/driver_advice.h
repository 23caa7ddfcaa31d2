#pragma once
#include <filesystem>
#include <string>

namespace radiafit {

/// A graphics chip that this machine seems to have.
struct ChipSigns {
    bool nvidia = false;  ///< a driver of NVIDIA's is loaded: the machine surely has a chip
    std::string advice;   ///< why OpenGL may not find it, and the cure, in one line; empty where nothing speaks of one
};

/// For when OpenGL offers no graphics chip. `root`: of the file system, whose /proc and /dev are looked at.
ChipSigns look_for_chip(const std::filesystem::path& root = "/");

}  // namespace radiafit
