#include "viewbasis/view_basis.h"

namespace radiafit::fits {

ViewTerms view_polynomials(const Vec3f& direction) {
    return ViewTerms::Map(ViewText::view_terms({direction.x(), direction.y(), direction.z()}).x);
}

}  // namespace radiafit::fits
