#include "model/texel_model.h"

#include <mutex>
#include <stdexcept>
#include <vector>

#include "model/texel_model_of.h"
#include "model/texel_texts.h"

namespace radiafit {
namespace {

struct Added {
    std::mutex mutex;
    std::vector<std::unique_ptr<const TexelModel>> models;
};
Added& added() {
    static Added all;
    return all;
}

}  // namespace

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
    const std::scoped_lock lock(added().mutex);
    for (const auto& model : added().models)
        if (model->name == name) return model.get();
    return nullptr;
}

const TexelModel& add_texel_model(std::unique_ptr<const TexelModel> model) {
    if (find_texel_model(model->name)) throw std::invalid_argument(std::string(model->name) + ": added twice");
    const std::scoped_lock lock(added().mutex);
    return *added().models.emplace_back(std::move(model));
}

}  // namespace radiafit
