#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace radiafit::tools {

/// What whoever publishes a page says on it. Empty: nothing, or of the title the dataset's name.
struct PageWords {
    std::string title, caption, credit, licence;
    std::optional<double>
        unit_metres;  ///< how long one unit of the surface's coordinates is; none: the page has no scale bar
};

/// Metres of a length such as "1mm" or "2.5 cm". Throws UserError, prefixed by `name`, for another text and for none
/// above 0.
double parse_length(std::string_view name, std::string_view text);

}  // namespace radiafit::tools
