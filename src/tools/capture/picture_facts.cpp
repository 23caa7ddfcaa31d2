#include "capture/picture_facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace radiafit::tools {
namespace {

/// Texts in the order in which they were met, each with its pictures' number and the first one's name.
class TextCounts {
public:
    void add(const std::string& text, const std::string& name) {
        if (text.empty()) return;
        const auto at = std::ranges::find(entries_, text, &Entry::text);
        if (at == entries_.end())
            entries_.push_back({text, name, 1});
        else
            ++at->count;
    }
    void tell(size_t all, std::vector<std::string>& to) const {
        for (const Entry& e : entries_)
            to.push_back(e.count == all
                             ? e.text
                             : fmt::format("{} of {} pictures, such as {}: {}", e.count, all, e.name, e.text));
    }

private:
    struct Entry {
        std::string text, name;
        size_t count;
    };
    std::vector<Entry> entries_;
};

/// Of photographs that are taken as stored, those that EXIF would turn, unless all would be turned alike.
std::string describe_orientations(std::span<const PictureFacts> pictures, const std::string& cure) {
    std::vector<std::string> names, orientations;
    bool differ = false;
    for (const PictureFacts& picture : pictures) {
        differ |= !picture.turned && picture.orientation != pictures[0].orientation;
        if (picture.turned || picture.orientation == 1) continue;
        names.push_back(picture.name);
        const std::string number = std::to_string(picture.orientation);
        if (std::ranges::count(orientations, number) == 0) orientations.push_back(number);
    }
    if (names.empty() || !differ) return "";
    const size_t count = names.size();
    constexpr size_t most = 4;
    if (count > most) names.resize(most);
    std::ranges::sort(orientations);
    return fmt::format("{} of {} pictures carry an EXIF orientation ({}) that is not applied: {}{}; {}", count,
                       pictures.size(), fmt::join(orientations, ", "), fmt::join(names, ", "),
                       count > most ? ", ..." : "", cure);
}

/// The largest value, if all are whole numbers and there are others than 0 and 1; else 0.
float largest_whole_number(std::span<const float> values) {
    float largest = 0;
    for (const float value : values) {
        if (!(value >= 0 && value == std::floor(value))) return 0;
        largest = std::max(largest, value);
    }
    return largest > 1 ? largest : 0;
}

}  // namespace

PictureFacts facts_of(std::string name, const ImageFile& image, const ColorReading& colors, bool unknown_is_linear) {
    using Kind = ColorReading::Kind;
    PictureFacts facts;
    facts.name = std::move(name);
    facts.ignored = colors.ignored;
    facts.remarks = image.remarks;
    facts.orientation = image.orientation;
    if (const float largest = largest_whole_number(image.rgb32); largest > 0)
        facts.ignored += fmt::format(
            "{}floats that are whole numbers up to {:g} are taken as light of which 1 is white: if they were 8- or "
            "16-bit values, export them as such",
            facts.ignored.empty() ? "" : "; ", largest);
    const std::string kind = image.bits == 32 ? fmt::format("{} of floats", image.format)
                                              : fmt::format("{}-bit {}", image.bits, image.format);
    const std::string by = colors.by;
    if (colors.kind == Kind::srgb)
        facts.colors = fmt::format("{}: sRGB by {}", kind, by);
    else if (colors.kind == Kind::linear && image.bits != 32)
        facts.colors = fmt::format("{}: linear light by {}", kind, by);
    else if (colors.kind == Kind::converted && image.bits == 8)
        facts.colors = fmt::format("{}: converted to sRGB by {}", kind, by);
    else if (colors.kind == Kind::converted)
        facts.colors = fmt::format("{}: converted to linear light of sRGB's primaries by {}", kind, by);
    else if (image.bits == 32)
        facts.colors = fmt::format("{}: linear light", kind);
    else
        facts.colors = fmt::format("{}: taken as {}, since nothing in the file says what the values are", kind,
                                   unknown_is_linear ? "linear light" : "sRGB");
    return facts;
}

PictureWords describe_pictures(std::span<const PictureFacts> pictures, const std::string& orientation_cure) {
    TextCounts colors, ignored, remarks, turned;
    for (const PictureFacts& picture : pictures) {
        colors.add(picture.colors, picture.name);
        ignored.add(picture.ignored, picture.name);
        for (const std::string& remark : picture.remarks) remarks.add(remark, picture.name);
        if (picture.turned)
            turned.add(fmt::format("turned as their EXIF orientation ({}) says", picture.orientation), picture.name);
    }
    PictureWords words;
    colors.tell(pictures.size(), words.remarks);
    remarks.tell(pictures.size(), words.remarks);
    turned.tell(pictures.size(), words.remarks);
    ignored.tell(pictures.size(), words.notes);
    const std::string orientations = describe_orientations(pictures, orientation_cure);
    if (!orientations.empty()) words.notes.push_back(orientations);
    return words;
}

}  // namespace radiafit::tools
