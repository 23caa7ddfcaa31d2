#include "gl/pass_costs.h"

#include <algorithm>

namespace radiafit {
namespace {

// One line each, as tests/check_costs.py reads them and says them where they are wrong:
// shader, variant, targets, a fragment's {operations, reads, bytes read}, {} or the same of an entry of its loop
// clang-format off
constexpr PassCost table[] = {
    {"combine/direction.frag", "BATCH=4 COLOUR=8 PROJECTED STORAGE=0 TERMS=1", 4, {407, 7, 80}, {}},
    {"combine/gradient.frag", "BATCH=4 COLOUR=8 DIAGONAL STORAGE=0 TERMS=1", 3, {116, 1, 16}, {}},
    {"combine/tile_direction.frag", "BATCH=4 COLOUR=8 CORNERS=1 DIAGONAL FIRST=2 STORAGE=0 TERMS=1", 4, {13, 2, 20}, {35, 2, 32}},
    {"combine/tile_direction.frag", "BATCH=4 COLOUR=8 CORNERS=1 FIRST=0 STORAGE=0 TERMS=1 WITH_ERROR", 5, {15, 6, 84}, {175, 2, 32}},
    {"combine/tile_direction.frag", "BATCH=4 COLOUR=8 CORNERS=1 FIRST=1 STORAGE=0 TERMS=1 WITH_ERROR", 5, {15, 6, 84}, {173, 2, 32}},
    {"combine/tile_direction.frag", "BATCH=4 COLOUR=8 CORNERS=1 FIRST=2 STORAGE=0 TERMS=1 WITH_ERROR", 5, {15, 6, 84}, {173, 2, 32}},
    {"combine/tile_direction.frag", "BATCH=4 COLOUR=8 CORNERS=2 DIAGONAL FIRST=0 STORAGE=0 TERMS=1", 8, {13, 2, 20}, {59, 3, 48}},
    {"combine/tile_line.frag", "BATCH=4 COLOUR=8 CORNERS=1 FIRST=2 QUARTIC STORAGE=0 TERMS=1", 4, {271, 13, 196}, {458, 6, 64}},
    {"combine/tile_line.frag", "BATCH=4 COLOUR=8 CORNERS=2 FIRST=0 QUARTIC STORAGE=0 TERMS=1", 8, {271, 21, 324}, {722, 8, 96}},
    {"combine/tile_line.frag", "BATCH=4 COLOUR=8 CORNERS=3 COUNT FIRST=0 STORAGE=0 TERMS=1", 3, {271, 5, 68}, {278, 4, 32}},
    {"combine/tile_line.frag", "BATCH=4 COLOUR=8 CORNERS=3 FIRST=0 STORAGE=0 TERMS=1", 6, {271, 29, 452}, {842, 10, 128}},
    {"distribute/item.frag", "", 1, {21, 0, 0}, {}},
    {"distribute/item.frag", "COLOUR=16", 1, {27, 1, 8}, {}},
    {"distribute/item.frag", "COLOUR=8", 1, {29, 1, 4}, {}},
    {"distribute/pixel_index.frag", "", 1, {51, 2, 8}, {}},
    {"gather/band_sum.frag", "", 1, {7, 0, 0}, {9, 1, 16}},
    {"gather/band_sum.frag", "MAXIMUM", 1, {7, 0, 0}, {11, 1, 16}},
    {"gather/footprint.frag", "NEAREST STORAGE=0 TERMS=1", 2, {93, 4, 64}, {}},
    {"gather/footprint.frag", "STORAGE=0 TERMS=1", 2, {89, 4, 64}, {}},
    {"gather/line_term.frag", "ALONG QUANTITY=0 STORAGE=0 TERMS=1 VALUES=1", 1, {15, 3, 48}, {}},
    {"gather/line_term.frag", "ALONG QUANTITY=1 STORAGE=0 TERMS=1 VALUES=1", 1, {12, 2, 32}, {}},
    {"gather/line_term.frag", "ALONG QUANTITY=2 STORAGE=0 TERMS=1 VALUES=1", 1, {18, 3, 48}, {}},
    {"gather/line_term.frag", "ALONG QUANTITY=3 STORAGE=0 TERMS=1 VALUES=1", 1, {9, 2, 32}, {}},
    {"gather/look_up.frag", "STORAGE=0 TERMS=1", 1, {38, 6, 96}, {}},
    {"gather/residual.frag", "PROJECTED STORAGE=0 TARGET_ONLY TERMS=1", 1, {61, 2, 8}, {}},
    {"gather/residual.frag", "PROJECTED STORAGE=0 TERMS=1 VALUES=1", 1, {70, 3, 24}, {}},
    {"gather/ring_sum.frag", "", 1, {166, 15, 240}, {}},
    {"gather/ring_sum.frag", "MAXIMUM", 1, {194, 15, 240}, {}},
    {"gather/scatter.frag", "DIAGONAL STORAGE=0 TERMS=1", 1, {10, 1, 16}, {}},
    {"gather/scatter.frag", "STORAGE=0 TERMS=1", 1, {9, 1, 16}, {}},
    {"gather/store.frag", "FROM_STORAGE STORAGE=0", 1, {2, 1, 16}, {}},
    {"gather/store.frag", "STORAGE=0", 1, {2, 1, 16}, {}},
    {"gather/surface_gradient.frag", "DIAGONAL STORAGE=0 TERMS=1 VALUES=1", 1, {8, 1, 16}, {}},
    {"gather/surface_gradient.frag", "STORAGE=0 TERMS=1 VALUES=1", 1, {5, 1, 16}, {}},
    {"gather/tile_texels.frag", "DIAGONAL PRODUCT STORAGE=0 TERMS=1", 1, {33, 1, 4}, {22, 2, 32}},
    {"gather/tile_texels.frag", "MAXIMUM STORAGE=0 TERMS=1", 1, {33, 1, 4}, {17, 1, 16}},
    {"gather/tile_texels.frag", "PRODUCT STORAGE=0 TERMS=1", 1, {33, 1, 4}, {19, 2, 32}},
    {"gather/tile_texels.frag", "SQUARE STORAGE=0 TERMS=1", 1, {33, 1, 4}, {19, 1, 16}},
    {"gather/tile_texels.frag", "STORAGE=0 TERMS=1", 1, {33, 1, 4}, {15, 1, 16}},
    {"gather/view_sum.frag", "", 1, {264, 16, 256}, {}},
    {"gather/view_sum.frag", "MAXIMUM", 1, {248, 16, 256}, {}},
    {"optimize/advance.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {16, 5, 80}, {}},
    {"optimize/advance.frag", "STORAGE=0 TERMS=1", 1, {15, 5, 80}, {}},
    {"optimize/after_direction.frag", "", 8, {203, 14, 224}, {}},
    {"optimize/after_line.frag", "", 2, {827, 9, 144}, {}},
    {"optimize/dot.frag", "PRODUCT=0 STORAGE=0 TERMS=1 VIEW_MAPS", 1, {15, 2, 32}, {}},
    {"optimize/dot.frag", "PRODUCT=0 STORAGE=0 TERMS=1", 1, {15, 2, 32}, {}},
    {"optimize/dot.frag", "PRODUCT=1 STORAGE=0 TERMS=1 VIEW_MAPS", 1, {15, 3, 48}, {}},
    {"optimize/dot.frag", "PRODUCT=1 STORAGE=0 TERMS=1", 1, {15, 3, 48}, {}},
    {"optimize/dot.frag", "PRODUCT=2 STORAGE=0 TERMS=1 VIEW_MAPS", 1, {5, 2, 32}, {}},
    {"optimize/dot.frag", "PRODUCT=2 STORAGE=0 TERMS=1", 1, {5, 2, 32}, {}},
    {"optimize/gradient.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {117, 9, 144}, {}},
    {"optimize/gradient.frag", "STORAGE=0 TERMS=1", 1, {118, 8, 128}, {}},
    {"optimize/laplacian.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {65, 5, 80}, {}},
    {"optimize/laplacian.frag", "STORAGE=0 TERMS=1", 1, {68, 5, 80}, {}},
    {"optimize/penalty_curvature.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {34, 4, 64}, {}},
    {"optimize/penalty_curvature.frag", "STORAGE=0 TERMS=1", 1, {33, 3, 48}, {}},
    {"optimize/penalty_error.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {56, 3, 48}, {}},
    {"optimize/penalty_error.frag", "STORAGE=0 TERMS=1", 1, {55, 2, 32}, {}},
    {"optimize/precondition.frag", "FLOORED STORAGE=0 TERMS=1 VIEW_MAPS", 1, {25, 4, 64}, {}},
    {"optimize/precondition.frag", "FLOORED STORAGE=0 TERMS=1", 1, {24, 3, 48}, {}},
    {"optimize/precondition.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 1, {13, 3, 48}, {}},
    {"optimize/precondition.frag", "STORAGE=0 TERMS=1", 1, {12, 2, 32}, {}},
    {"optimize/update_direction.frag", "STORAGE=0 TERMS=1 VIEW_MAPS", 4, {36, 9, 144}, {}},
    {"optimize/update_direction.frag", "STORAGE=0 TERMS=1", 4, {35, 9, 144}, {}},
    {"peaks/copy.frag", "", 1, {2, 1, 16}, {}},
    {"peaks/fetch.frag", "", 1, {2, 0, 0}, {114, 16, 256}},
    {"peaks/fused.frag", "", 1, {9, 0, 0}, {386, 0, 0}},
    {"reflect/advance.frag", "MODEL=lafortune STORAGE=0", 1, {10, 5, 68}, {}},
    {"reflect/advance.frag", "MODEL=lambert STORAGE=0", 1, {10, 5, 68}, {}},
    {"reflect/after_direction.frag", "MODEL=lafortune STORAGE=0", 2, {71, 7, 76}, {}},
    {"reflect/after_direction.frag", "MODEL=lambert STORAGE=0", 2, {71, 7, 76}, {}},
    {"reflect/after_line.frag", "MODEL=lafortune STORAGE=0", 2, {223, 5, 56}, {}},
    {"reflect/after_line.frag", "MODEL=lambert STORAGE=0", 2, {223, 5, 56}, {}},
    {"reflect/count.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {28, 3, 48}, {}},
    {"reflect/count.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=1 STORAGE=0", 1, {4, 1, 16}, {}},
    {"reflect/count.frag", "BATCH=1 GRID KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {28, 3, 48}, {}},
    {"reflect/count.frag", "BATCH=1 GRID KEPT MODEL=lambert ONLY=1 STORAGE=0", 1, {4, 1, 16}, {}},
    {"reflect/count.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {28, 3, 48}, {}},
    {"reflect/count.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=1 STORAGE=0", 1, {4, 1, 16}, {}},
    {"reflect/count.frag", "BATCH=1 KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {28, 3, 48}, {}},
    {"reflect/count.frag", "BATCH=1 KEPT MODEL=lambert ONLY=1 STORAGE=0", 1, {4, 1, 16}, {}},
    {"reflect/count.frag", "BATCH=4 COLOUR=16 GRID MODEL=lafortune STORAGE=0", 2, {314, 10, 64}, {}},
    {"reflect/count.frag", "BATCH=4 COLOUR=16 GRID MODEL=lambert STORAGE=0", 2, {314, 10, 64}, {}},
    {"reflect/count.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lafortune STORAGE=0", 2, {436, 6, 96}, {}},
    {"reflect/count.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lambert STORAGE=0", 2, {436, 6, 96}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL GRID KEPT MODEL=lafortune ONLY=3 STORAGE=0", 1, {133, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL GRID KEPT MODEL=lafortune ONLY=4 STORAGE=0", 1, {118, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL GRID KEPT MODEL=lambert ONLY=1 STORAGE=0", 1, {27, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL KEPT MODEL=lafortune ONLY=3 STORAGE=0", 1, {133, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL KEPT MODEL=lafortune ONLY=4 STORAGE=0", 1, {118, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 DIAGONAL KEPT MODEL=lambert ONLY=1 STORAGE=0", 1, {27, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=1 STORAGE=0", 1, {117, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=2 STORAGE=0", 1, {135, 5, 80}, {}},
    {"reflect/direction.frag", "BATCH=1 GRID KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=1 STORAGE=0", 1, {117, 4, 64}, {}},
    {"reflect/direction.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=2 STORAGE=0", 1, {135, 5, 80}, {}},
    {"reflect/direction.frag", "BATCH=1 KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 DIAGONAL GRID MODEL=lafortune STORAGE=0", 5, {727, 13, 112}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 DIAGONAL GRID MODEL=lambert STORAGE=0", 2, {383, 11, 80}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 DIAGONAL ITEMS MODEL=lafortune STORAGE=0", 5, {849, 9, 144}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 DIAGONAL ITEMS MODEL=lambert STORAGE=0", 2, {505, 7, 112}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 GRID MODEL=lafortune STORAGE=0", 3, {687, 13, 112}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 GRID MODEL=lambert STORAGE=0", 1, {375, 11, 80}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lafortune STORAGE=0", 3, {809, 9, 144}, {}},
    {"reflect/direction.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lambert STORAGE=0", 1, {497, 7, 112}, {}},
    {"reflect/dots.frag", "MODEL=lafortune STORAGE=0", 1, {90, 12, 192}, {}},
    {"reflect/dots.frag", "MODEL=lambert STORAGE=0", 1, {36, 4, 64}, {}},
    {"reflect/gradient.frag", "MODEL=lafortune STORAGE=0", 1, {42, 3, 36}, {}},
    {"reflect/gradient.frag", "MODEL=lambert STORAGE=0", 1, {42, 3, 36}, {}},
    {"reflect/line.frag", "BATCH=1 GRID KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {186, 8, 128}, {}},
    {"reflect/line.frag", "BATCH=1 GRID KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {35, 4, 64}, {}},
    {"reflect/line.frag", "BATCH=1 KEPT MODEL=lafortune ONLY=0 STORAGE=0", 1, {186, 8, 128}, {}},
    {"reflect/line.frag", "BATCH=1 KEPT MODEL=lambert ONLY=0 STORAGE=0", 1, {35, 4, 64}, {}},
    {"reflect/line.frag", "BATCH=4 COLOUR=16 GRID MODEL=lafortune STORAGE=0", 1, {786, 16, 160}, {}},
    {"reflect/line.frag", "BATCH=4 COLOUR=16 GRID MODEL=lambert STORAGE=0", 1, {329, 11, 80}, {}},
    {"reflect/line.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lafortune STORAGE=0", 1, {908, 12, 192}, {}},
    {"reflect/line.frag", "BATCH=4 COLOUR=16 ITEMS MODEL=lambert STORAGE=0", 1, {451, 7, 112}, {}},
    {"reflect/penalty.frag", "ALONG MODEL=lafortune STORAGE=0", 1, {67, 6, 96}, {}},
    {"reflect/penalty.frag", "ALONG MODEL=lambert STORAGE=0", 1, {25, 2, 32}, {}},
    {"reflect/penalty.frag", "MODEL=lafortune STORAGE=0", 1, {128, 3, 48}, {}},
    {"reflect/penalty.frag", "MODEL=lambert STORAGE=0", 1, {44, 1, 16}, {}},
    {"reflect/precondition.frag", "MODEL=lafortune STORAGE=0", 1, {31, 4, 52}, {}},
    {"reflect/precondition.frag", "MODEL=lambert STORAGE=0", 1, {17, 2, 20}, {}},
    {"reflect/residual.frag", "BATCH=1 COLOUR=16 GRID MODEL=lafortune STORAGE=0 TARGET_ONLY", 1, {75, 4, 40}, {}},
    {"reflect/residual.frag", "BATCH=1 COLOUR=16 GRID MODEL=lafortune STORAGE=0", 1, {158, 7, 88}, {}},
    {"reflect/residual.frag", "BATCH=1 COLOUR=16 GRID MODEL=lambert STORAGE=0 TARGET_ONLY", 1, {75, 4, 40}, {}},
    {"reflect/residual.frag", "BATCH=1 COLOUR=16 GRID MODEL=lambert STORAGE=0", 1, {87, 5, 56}, {}},
    {"reflect/residual.frag", "BATCH=1 MODEL=lafortune PROJECTED STORAGE=0 TARGET_ONLY", 1, {114, 4, 44}, {}},
    {"reflect/residual.frag", "BATCH=1 MODEL=lafortune PROJECTED STORAGE=0", 1, {197, 7, 92}, {}},
    {"reflect/residual.frag", "BATCH=1 MODEL=lambert PROJECTED STORAGE=0 TARGET_ONLY", 1, {114, 4, 44}, {}},
    {"reflect/residual.frag", "BATCH=1 MODEL=lambert PROJECTED STORAGE=0", 1, {126, 5, 60}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=1 FIRST=0 GRID KEPT MODEL=lambert ONLY=0 RESULTS=1 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=1 FIRST=0 KEPT MODEL=lambert ONLY=0 RESULTS=1 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=0 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=0 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {36, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=12 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=12 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=16 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=16 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=20 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {122, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=20 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {122, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=24 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {123, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=24 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {123, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=28 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {116, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=28 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {116, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=4 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {123, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=4 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {123, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=8 GRID KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=1 CANDIDATES=5 FIRST=8 KEPT MODEL=lafortune ONLY=0 RESULTS=1 STORAGE=0", 1, {133, 3, 48}, {}},
    {"reflect/start.frag", "BATCH=4 CANDIDATES=1 COLOUR=16 FIRST=0 GRID MODEL=lambert RESULTS=1 STORAGE=0", 1, {327, 10, 64}, {}},
    {"reflect/start.frag", "BATCH=4 CANDIDATES=1 COLOUR=16 FIRST=0 ITEMS MODEL=lambert RESULTS=1 STORAGE=0", 1, {449, 6, 96}, {}},
    {"reflect/start.frag", "BATCH=4 CANDIDATES=5 COLOUR=16 FIRST=0 GRID MODEL=lafortune RESULTS=8 STORAGE=0", 8, {855, 10, 64}, {}},
    {"reflect/start.frag", "BATCH=4 CANDIDATES=5 COLOUR=16 FIRST=0 ITEMS MODEL=lafortune RESULTS=8 STORAGE=0", 8, {977, 6, 96}, {}},
    {"reflect/update_direction.frag", "MODEL=lafortune STORAGE=0", 4, {29, 8, 128}, {}},
    {"reflect/update_direction.frag", "MODEL=lambert STORAGE=0", 4, {29, 8, 128}, {}},
};
// clang-format on

// Sizes that constants in the program stand for; the test counts with two values of each.
constexpr const char* sizes[] = {"VIEW_SIDE", "COLUMNS", "SIDE",        "RECTANGLES", "ROWS",
                                 "BANDS",     "ENTRIES", "SOURCE_SIDE", "TARGET_SIDE"};

}  // namespace

std::span<const PassCost> pass_costs() { return table; }

std::string pass_variant(const Defines& defines) {
    std::vector<std::string> items;
    for (const auto& [name, value] : defines)
        if (std::find(std::begin(sizes), std::end(sizes), name) == std::end(sizes))
            items.push_back(value.empty() ? name : name + "=" + value);
    std::sort(items.begin(), items.end());
    std::string variant;
    for (const std::string& item : items) variant += (variant.empty() ? "" : " ") + item;
    return variant;
}

const PassCost* find_pass_cost(const std::string& shader, const std::string& variant) {
    const auto found = std::find_if(std::begin(table), std::end(table), [&](const PassCost& cost) {
        return cost.shader == shader && cost.variant == variant;
    });
    return found == std::end(table) ? nullptr : found;
}

}  // namespace radiafit
