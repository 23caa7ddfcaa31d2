#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "base/read_file.h"
#include "gl/derivative_text.h"
#include "gl/shader_text.h"
#include "model/texel_model_of.h"

#define RADIAFIT_TEXEL_MODEL several_shapes
#define RADIAFIT_TEXEL_FILE "several_shapes.glsl"
#include "model/define_texel_text.h"

namespace radiafit::testing {

inline std::string several_shapes_text() {
    return read_file(std::filesystem::path(RADIAFIT_TEST_TEXTS) / "several_shapes.glsl", "model");
}

/// The model several_shapes, known to the engines of OpenGL from then on by its name; its derivatives are made.
inline const TexelModel& several_shapes() {
    static const TexelModel& model = [] {
        static constexpr const char* name = "model/several_shapes.glsl";
        add_shader(name, [] { return with_derivatives(name, several_shapes_text(), 3, shader_file); });
        return std::ref(add_texel_model(std::make_unique<TexelModelOf<texel_text::several_shapes<float>>>()));
    }();
    return model;
}

}  // namespace radiafit::testing
