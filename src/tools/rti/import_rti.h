#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "model/value_curve.h"

namespace radiafit::tools {

struct RtiImportOptions {
    std::filesystem::path file;
    std::filesystem::path dataset;  ///< the packed images that the file was made of; empty: some are made of the file
    std::filesystem::path images;   ///< where those go
    /// Of the file's values, in place of what it says or what such files mostly have.
    std::optional<ValueCurve> curve = {};
    std::string provenance_json;  ///< of the fit: a JSON object
    bool force = false;           ///< go on where memory or disk will not suffice
};

struct RtiImportReport {
    std::string kind, model;
    int width = 0, height = 0;
    std::filesystem::path dataset;  ///< of the fit
    double difference = 0;          ///< RtiFit::difference
};

/// Makes a fit of a file of RTI: read_rti(), fit_of(). Images that are made show what the file does under 24 lamps
/// spread over the hemisphere, 8 bits of sRGB; three of them are held out. Throws UserError; nothing is left at `out`
/// then.
RtiImportReport import_rti(const RtiImportOptions& options, const std::filesystem::path& out);

}  // namespace radiafit::tools
