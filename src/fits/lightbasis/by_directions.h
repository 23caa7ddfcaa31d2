#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "lightbasis/light_basis.h"

namespace radiafit::fits {

/// What follows from the directions that texels are lit and seen from, T(directions), held once for all texels that
/// have the same. Thread-safe.
template <class T>
class ByDirections {
public:
    std::shared_ptr<T> of(const std::vector<LampAndHalf>& directions) {
        const std::string key(reinterpret_cast<const char*>(directions.data()),
                              directions.size() * sizeof(LampAndHalf));
        const std::scoped_lock lock(mutex_);
        std::shared_ptr<T>& known = known_[key];
        if (!known) known = std::make_shared<T>(directions);
        return known;
    }

private:
    std::mutex mutex_;
    std::unordered_map<std::string, std::shared_ptr<T>> known_;  ///< by the directions' bytes
};

}  // namespace radiafit::fits
