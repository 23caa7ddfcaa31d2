#pragma once
#include <filesystem>
#include <initializer_list>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "eval/render.h"
#include "report/problem_picture.h"

/// What render leaves on the disk.
namespace radiafit::tools {

/// Throws UserError where there is something at `file` that is not render's: it has no picture_mark, nor is it
/// the PNG that gnuplot draws beside an SVG that does.
void check_ours(const std::filesystem::path& file);

/// Where one view goes: FILE.png, FILE.exr and FILE.svg alike name FILE.
std::filesystem::path picture_stem(const std::string& output);

/// The pictures of one command. They are made under hidden names and appear together, over earlier ones of render and
/// over nothing else.
class Pictures {
public:
    /// background: of PNG files; EXR files have the coverage.
    explicit Pictures(const std::filesystem::path& folder, const Background& background = {});

    /// Refuses a name that exists with one of `endings` and is not render's: a fit's map, a photograph; or another
    /// picture of render's that the user didn't ask to replace.
    void check(const std::string& name, std::initializer_list<const char*> endings);
    /// Any thread, as add_sheet(). Messages are in the order of the names.
    void add(const std::string& name, const LightImage& image);
    void add_sheet(const std::string& name, const ByteImage& sheet, const std::string& content);
    void add(const std::string& name, const ProblemPicture& picture);
    void commit();

private:
    void add(const std::string& name, const ByteImage& bytes) const;

    std::filesystem::path folder_;
    Background background_;
    AtomicFiles files_;
    std::vector<std::filesystem::path> checked_;
    void say(const std::string& name, std::string message);

    std::mutex mutex_;
    std::multimap<std::string, std::string> messages_;  ///< by name
};

}  // namespace radiafit::tools
