#pragma once
#include <string_view>

namespace radiafit {

/// Whether the value of an attribute in an OpenEXR header is as long as its type, and what stands in it, say. OpenEXR
/// reads values of most types without regard to the length before them: where the two disagree, it takes what follows
/// for another attribute than one who steps from length to length. True of types that it does not know.
/// Source: OpenEXR File Layout, "Attribute types".
bool exr_attribute_fits(std::string_view type, std::string_view value);

}  // namespace radiafit
