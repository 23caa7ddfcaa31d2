#pragma once
#include <any>
#include <map>
#include <typeindex>

#include "base/rings.h"

namespace radiafit::fits {

/// Options that belong to a family alone: a struct of each type that is asked for, with its defaults until it is
/// written to.
class OwnOptions {
public:
    template <class Block>
    const Block& get() const {
        static const Block defaults{};
        const auto found = blocks_.find(typeid(Block));
        return found == blocks_.end() ? defaults : *std::any_cast<Block>(&found->second);
    }
    template <class Block>
    Block& get() {
        std::any& block = blocks_[typeid(Block)];
        if (!block.has_value()) block = Block{};
        return *std::any_cast<Block>(&block);
    }

private:
    std::map<std::type_index, std::any> blocks_;
};

}  // namespace radiafit::fits
