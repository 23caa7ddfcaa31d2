#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/rng.h"
#include "fit/fit_folder.h"
#include "scenes.h"
#include "temporary_folder.h"

/// A packed dataset on disk and fits with random parameters, for the tests of fit/ and eval/.
namespace radiafit::testing {

/// Writes u8-srgb views: pixel(view, x, y, channel) gives the bytes. Views 2, 5, 8 ... are held out. Opened again.
inline Dataset write_dataset(const std::filesystem::path& folder, Dataset header,
                             const std::function<uint8_t(size_t, int, int, int)>& pixel, bool masks = false) {
    DatasetWriter writer(folder);
    for (size_t i = 0; i < header.views.size(); ++i) {
        View view = header.views[i];
        view.held_out = i % 3 == 2;
        const int w = view.camera.width, h = view.camera.height;
        std::vector<uint8_t> bytes, mask;
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                for (int c = 0; c < 3; ++c) bytes.push_back(pixel(i, x, y, c));
                if (masks) mask.push_back((x / 5 + y / 7) % 4 != 0);
            }
        writer.add(view, bytes.data(), mask);
    }
    writer.finish(header);
    return open_dataset(folder);
}

inline Dataset noise_dataset(const std::filesystem::path& folder, bool masks = false) {
    return write_dataset(
        folder, sheet_dataset(troubled_mesh(3, 7, 1), 5, 48, 2),
        [](size_t view, int x, int y, int c) { return uint8_t(random_bits(view, uint64_t((y * 48 + x) * 3 + c))); },
        masks);
}

/// Random parameters and problem figures: every vertex has samples but the last, the unreferenced one.
inline LightFieldFit random_fit(const Dataset& dataset, int terms, ViewLookup lookup, uint64_t seed,
                                bool own_sides = false) {
    LightFieldFit fit;
    fit.options.terms = terms;
    fit.options.surface_side = 5;
    fit.options.view_side = 3;
    fit.options.lookup = lookup;
    fit.options.lambda_view = 0.1f;
    fit.solver = "stream";
    fit.engine = "cpu";
    if (own_sides) fit.options = with_own_sides(fit.options, dataset.mesh, seed);
    const TriangleAtlas atlas = surface_atlas(dataset.mesh, fit.options);
    const LfmLayout layout(VertexRings(dataset.mesh), atlas, fit.options.view_side, terms);
    Rng rng(seed);
    fit.parameters.resize(layout.size());
    for (size_t i = 0; i < layout.size(); ++i) fit.parameters[i] = i % 4 == 3 ? 0.0f : rng.uniform(0.0f, 0.6f);
    const size_t vertices = dataset.mesh.vertex_count();
    for (size_t q = 0; q < 3 * vertices; ++q) {
        const bool none = q / 3 == vertices - 1;
        fit.status.push_back(none ? Status::no_samples : Status(1 + rng.index(4)));
        fit.iterations.push_back(none ? 0 : rng.index(100));
        fit.samples.push_back(none ? 0 : 1 + rng.index(100000));
        fit.error.push_back(rng.uniform());
    }
    set_dataset(fit, dataset);
    return fit;
}

/// What a UserError says; fails the test if there is none, or if it is longer than one line.
inline std::string user_error(const std::function<void()>& call) {
    try {
        call();
    } catch (const UserError& e) {
        const std::string what = e.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        return what;
    } catch (const std::exception& e) {
        ADD_FAILURE() << "not a UserError: " << e.what();
        return "";
    }
    ADD_FAILURE() << "no error";
    return "";
}

}  // namespace radiafit::testing
