#pragma once
#include "fitting/parts/parts.h"

namespace radiafit::fits {

/// Fits with a problem per texel. Units are texels; places are triangles, or rows of a grid.
class DividedTexels : public Divided {
public:
    std::span<const Vec3f> places() const override { return places_; }
    std::span<const uint64_t> weights() const override { return weights_; }
    /// With the whole's normals per texel: at the rim, those of the part alone would differ.
    Part cut(std::span<const uint32_t> places) const override;
    uint64_t held_bytes() const override;
    uint64_t merge_bytes(size_t parts) const override;
    void add(const PartResult& result, const std::string& name) override;

protected:
    /// dataset, request: as Family::divide has them. parameters: of a texel.
    DividedTexels(const Dataset& dataset, const FitRequest& request, std::unique_ptr<Atlas> atlas, size_t parameters);

    /// Which texel of a part's atlas its i-th unit is: a grid stays whole.
    size_t texel_in(const Part& part, size_t i) const { return dataset_->has_grid() ? part.units[i] : i; }
    /// The result of a part that was fitted: `fit` has a problem, and `all` parameters, for each texel of its atlas.
    PartResult result_of(const Part& part, const FitRecord& fit, const std::vector<float>& all,
                         std::string run_json) const;
    /// Puts all parts into the whole's fit: its problems and `all` parameters, and what describes its request and
    /// dataset. Throws UserError if texels are missing.
    void put_together(FitRecord& fit, std::vector<float>& all);

    const Dataset* dataset_;
    FitRequest request_;
    std::vector<uint32_t> views_;
    std::unique_ptr<Atlas> atlas_;
    RunSum run_;

private:
    Dataset mesh_part(std::span<const uint32_t> triangles, std::span<const uint32_t> texels) const;
    uint64_t result_bytes() const;

    size_t numbers_;  ///< parameters of a texel
    std::shared_ptr<const Mesh> mesh_;
    uint32_t per_place_ = 0;  ///< texels
    std::vector<Vec3f> places_;
    std::vector<uint64_t> weights_;
    // Results of the parts that were added.
    std::vector<uint8_t> done_;  ///< [texels]
    std::vector<float> parameters_;
    FitRecord problems_;
};

}  // namespace radiafit::fits
