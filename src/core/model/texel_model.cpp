#include "model/texel_model.h"

#include "model/texel_model_of.h"
#include "model/texel_texts.h"

namespace radiafit {
std::string TexelModel::parameter_name(int i) const {
    if (i >= 3 * basis) return shape_names[size_t(i - 3 * basis)];
    return coefficient_names[size_t(i / 3)] + "." + "RGB"[i % 3];
}

std::span<const TexelModel* const> texel_models() {
#define EACH(NAME) static const TexelModelOf<texel_text::NAME<float>> NAME;
    RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH
#define EACH(NAME) &NAME,
    static const TexelModel* const all[] = {RADIAFIT_TEXEL_MODELS(EACH)};
#undef EACH
    return all;
}

const TexelModel* find_texel_model(const std::string& name) {
    for (const TexelModel* model : texel_models())
        if (model->name == name) return model;
    return nullptr;
}

}  // namespace radiafit
