#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// The photographs that calibrations and lists name, as they lie on this machine. Files are copied between systems and
/// converted after they were listed: paths turn absolute or get backslashes, letters are composed otherwise, endings
/// change.
namespace radiafit::tools {

/// The name in Unicode's canonical composition (NFC), which a Mac's file system decomposes. What is no UTF-8 stays.
std::string composed_name(const std::string& name);
/// The same with letter cases folded: "Münze.JPG" is "münze.jpg". Of what is no UTF-8, A to Z are folded.
std::string comparable_name(const std::string& name);

class ImageFinder {
public:
    /// folder: of the photographs. list: the file that names them, for messages.
    ImageFinder(std::filesystem::path folder, std::filesystem::path list);

    /// The photograph of a name, as a path from the folder; none: it is not there. Tried one after another, until one
    /// finds a file: the name as it is; with slashes for backslashes; without its first folders, one after the other;
    /// each of these with letters that differ in case or Unicode composition; the same with another ending, of
    /// photographs (image/image_format.h). Throws UserError where several files may be meant.
    std::optional<std::filesystem::path> find(const std::string& name);

    /// How many names led to files of other names, and by what; one line each, empty where all were as listed.
    std::vector<std::string> remarks() const;

    /// "IMAGES/NAME: no such image, but LIST names it": what all messages about a missing photograph begin with.
    std::string missing(const std::string& name) const;

private:
    using Names = std::multimap<std::string, std::string>;  ///< by comparable_name()
    struct Listing {
        Names folders, files;  ///< hidden ones left out
        Names stems;           ///< photographs by their names without ending
    };
    struct Guess {
        size_t count = 0;
        std::string name, file;  ///< the first
    };
    using Parts = std::vector<std::filesystem::path>;
    const Listing& list(const std::filesystem::path& folder);
    std::optional<std::filesystem::path> exact(const std::filesystem::path& path) const;
    enum class Endings { count, vary };
    std::optional<std::filesystem::path> alike(const Parts& path, const std::string& file_name, Endings endings);
    std::filesystem::path guessed(const char* how, const std::string& name, std::filesystem::path file);

    std::filesystem::path folder_, list_;
    std::map<std::filesystem::path, Listing> listings_;
    std::map<std::string, Guess> guesses_;  ///< by how
};

}  // namespace radiafit::tools
