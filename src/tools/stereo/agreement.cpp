#include "stereo/agreement.h"

#include <cmath>

namespace radiafit::tools {
namespace {

constexpr float most_depth_difference = 0.01f, most_pixels = 1.5f, least_cosine = 0.7071f;

/// What is known of one other map.
struct Other {
    const PlaneMap* map;
    CameraPair there;
    CameraPair back;
    Eigen::Matrix3f rotation;

    bool agrees(const InversePlane& plane, const Vec3f& ray, float x, float y) const {
        const Camera& camera = map->camera;
        const AffineMap seen = there.map(plane, ray);
        if (seen.none() ||
            !(seen.x >= 0 && seen.y >= 0 && seen.x < float(camera.width) && seen.y < float(camera.height)))
            return false;
        const size_t at = size_t(seen.y) * size_t(camera.width) + size_t(seen.x);
        if (!map->known(at)) return false;
        const InversePlane& other = map->planes[at];
        const Vec3f other_ray = ray_of(camera, seen.x, seen.y);
        const float inverse_depth = other.dot(other_ray), z = seen.depth / plane.dot(ray);
        if (!(std::abs(inverse_depth * z - 1) <= most_depth_difference)) return false;
        if (normal_of(other).dot(rotation * normal_of(plane)) < least_cosine) return false;
        const AffineMap returned = back.map(other, other_ray);
        return !returned.none() && std::hypot(returned.x - x, returned.y - y) <= most_pixels;
    }
};

}  // namespace

PlaneMap agreed_planes(const PlaneMap& map, std::span<const PlaneMap* const> others, int least) {
    std::vector<Other> known;
    for (const PlaneMap* other : others)
        known.push_back(
            {other, CameraPair(map.camera, other->camera), CameraPair(other->camera, map.camera),
             (other->camera.cam_from_world_rotation * map.camera.cam_from_world_rotation.transpose()).cast<float>()});
    PlaneMap agreed{map.camera, std::vector<InversePlane>(map.planes.size(), InversePlane::Zero())};
    size_t at = 0;
    for (int y = 0; y < map.camera.height; ++y)
        for (int x = 0; x < map.camera.width; ++x, ++at) {
            if (!map.known(at)) continue;
            const Vec3f ray = ray_of(map.camera, x + 0.5, y + 0.5);
            int count = 0;
            for (const Other& other : known) {
                count += other.agrees(map.planes[at], ray, float(x) + 0.5f, float(y) + 0.5f);
                if (count == least) break;
            }
            if (count >= least) agreed.planes[at] = map.planes[at];
        }
    return agreed;
}

}  // namespace radiafit::tools
