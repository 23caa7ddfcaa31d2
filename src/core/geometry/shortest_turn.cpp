#include "geometry/shortest_turn.h"

namespace radiafit {

Eigen::Quaterniond shortest_turn(const Vec3d& from, const Vec3d& to) {
    const Vec3d a = from.normalized(), b = to.normalized();
    const double twice_real = (a + b).norm();  // twice the cosine of half the angle
    Eigen::Quaterniond turn(0, 0, 0, 0);
    if (twice_real > 1e-8) {
        turn.w() = twice_real / 2;
        turn.vec() = a.cross(b) / twice_real;
    } else {
        turn.vec() = a.unitOrthogonal();
    }
    return turn.normalized();
}

}  // namespace radiafit
