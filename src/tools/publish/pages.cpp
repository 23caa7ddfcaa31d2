#include "publish/pages.h"

#include "fitting/family.h"

namespace radiafit::tools {

PageModel page_model_of(Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    return std::visit(
        [&](const auto& m) {
            if constexpr (requires { page_model_of(m.fit, dataset.mesh); })
                return page_model_of(m.fit, dataset.mesh);
            else if constexpr (requires { page_model_of(m.fit, *m.atlas); })
                return page_model_of(m.fit, *m.atlas);
            else
                return page_model_of(m.fit, *m.atlas, dataset, fitted_views(dataset, m.fit));
        },
        fitted.model);
}

}  // namespace radiafit::tools
