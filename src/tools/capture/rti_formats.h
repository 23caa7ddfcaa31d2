#pragma once
#include <span>

#include "capture/rti_file.h"

/// What reads each format, for read_rti(): as it says.
namespace radiafit::tools {

RtiFile read_ptm(const std::filesystem::path& file, std::string_view bytes, const RtiSizeCheck& check);
/// Of .rti files those of hemispherical harmonics.
RtiFile read_hsh(const std::filesystem::path& file, std::string_view bytes, const RtiSizeCheck& check);
/// info: its info.json, of this text.
RtiFile read_relight(const std::filesystem::path& info, std::string_view text, const RtiSizeCheck& check);

/// Throws UserError unless what numbers are stored with is finite and no larger than any file needs, and some scale is
/// not 0.
void check_quantization(const std::filesystem::path& file, std::span<const float> scale, std::span<const float> bias);
void check_quantization(const std::filesystem::path& file, const char* what, double value);

}  // namespace radiafit::tools
