#include "renderers_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "gl/context.h"
#include "page/html_table.h"

namespace radiafit::harness {
namespace {

using ByRenderer = std::map<std::string, const Finding*>;

/// "llvmpipe (LLVM 15.0.6, 256 bits), OSMesa" of a name that ends with the processor, as software's do.
std::string opengl_of(const std::string& renderer) {
    const std::string osmesa = ", OSMesa";
    const size_t end = renderer.find("), ");
    if (end == std::string::npos) return renderer;
    return renderer.substr(0, end + 1) + (renderer.compare(end + 1, osmesa.size(), osmesa) == 0 ? osmesa : "");
}

/// The first finding of each software renderer that measured anything; none where all of them are one OpenGL.
ByRenderer of_software(const std::vector<Finding>& findings) {
    ByRenderer found;
    std::set<std::string> opengl;
    for (const Finding& f : findings) {
        if (!is_software_renderer(f.evidence.renderer) || f.judgement.measures.empty()) continue;
        found.emplace(f.evidence.renderer, &f);
        opengl.insert(opengl_of(f.evidence.renderer));
    }
    return opengl.size() < 2 ? ByRenderer() : found;
}

std::string figure_of(const Finding& finding, const std::string& what) {
    const auto& measures = finding.judgement.measures;
    const auto m = std::ranges::find(measures, what, &Measure::of);
    return m == measures.end() ? "" : fmt::format("{} ({})", m->value_text(), m->interval_text());
}

}  // namespace

Html renderers_part(std::span<const ClaimFindings> claims) {
    Html part;
    for (const ClaimFindings& claim : claims) {
        auto found = of_software(claim.judged);
        if (found.empty()) found = of_software(claim.smaller);
        if (found.empty()) continue;
        std::vector<std::string> header = {"figure"};
        for (const auto& [renderer, finding] : found) header.push_back(renderer);
        const Finding& first = *found.begin()->second;
        std::vector<HtmlRow> rows;
        for (const Measure& m : first.judgement.measures) {
            HtmlRow& row = rows.emplace_back(HtmlRow{{Html(m.of)}});
            for (const auto& [renderer, finding] : found) row.cells.emplace_back(figure_of(*finding, m.of));
        }
        const std::string title = fmt::format("{}: {}", claim.claim->id, claim.claim->states);
        part << scroll_box(
            title, html_table(fmt::format("{}; {} profile; in brackets intervals of 95 %", title, first.profile),
                              header, rows));
    }
    if (part.empty()) return part;
    Html whole = element("p",
                         "The same rows by several OpenGLs in software: how much of a figure is the driver's. None of "
                         "them is a graphics chip, and no verdict rests on them.");
    return whole << part;
}

}  // namespace radiafit::harness
