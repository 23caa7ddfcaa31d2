#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// A texel-local model by its name, for what needn't be fast: what it is called, its bounds, its values. Kernels use
/// the texts themselves (model/texel_local.h).
class TexelModel {
public:
    virtual ~TexelModel() = default;

    const char* name = "";  ///< of shaders/model/NAME.glsl
    int terms = 0;          ///< numbers of a sample that no parameter enters
    int basis = 0;          ///< coefficients per channel; those of basis function k are parameters 3 k + channel
    int shape = 0;          ///< parameters that the channels share, behind the coefficients
    int shaped = 0;         ///< basis functions that depend on the shape, the last ones
    int parameters = 0;     ///< 3 basis + shape
    int independent = 0;    ///< so many samples a texel needs at least
    std::vector<std::string> coefficient_names;  ///< [basis]
    std::vector<std::string> shape_names;        ///< [shape]
    std::vector<std::array<double, 2>> bounds;   ///< [parameters] lowest and highest value
    std::vector<std::vector<double>> starts;     ///< [..][shape] where fits may begin; empty for a model without shape
    std::optional<int> diffuse;                  ///< the coefficient that is a diffuse albedo, where one is

    std::string parameter_name(int i) const;  ///< "rho_d.R", "Cx"
    bool held(int i) const { return bounds[size_t(i)][0] == bounds[size_t(i)][1]; }
    bool any_held() const {
        return std::any_of(bounds.begin(), bounds.end(), [](const auto& of) { return of[0] == of[1]; });
    }
    int columns() const { return basis + shaped * shape; }
    /// Reflected radiance per channel where a white diffuse surface that faces the lamp has 1. u, v: unit directions to
    /// lamp and camera in the texel's frame; 0 unless u_z > 0 and v_z > 0.
    virtual std::array<float, 3> value(std::span<const float> p, const Vec3f& u, const Vec3f& v) const = 0;
    /// Derivatives at p, in double, which all channels share: out[k], k < basis, is basis function k, and so channel
    /// c's derivative by its own coefficient 3 k + c; out[basis + shape l + i] that of the shaped basis function l by
    /// shape parameter i. The value is linear in the coefficients: sum over k of p[3 k + c] out[k]. out [columns()]; 0
    /// unless u_z > 0 and v_z > 0.
    virtual void columns(std::span<const float> p, const Vec3f& u, const Vec3f& v, std::span<double> out) const = 0;
    /// Where a fit begins with one shape: model/start_sums.h.
    virtual double coefficients_of(std::span<const float> sums, std::span<float> out) const = 0;
    /// The parameter that the canonical gauge holds at p, which is canonical: of the shape's, the one that moves most
    /// along the gauge. -1: there is no gauge.
    virtual int held_by_gauge(std::span<const float> p) const = 0;
    /// n of the cosine's power cos^n that is as sharp as the lobe of the last coefficient; none: it has no lobe.
    virtual std::optional<float> lobe_exponent(std::span<const float> p) const = 0;
    /// The same values by other parameters: the only gauge in which two of them may be compared.
    virtual void make_canonical(std::span<float> p) const = 0;
};

/// Those that are part of the library.
std::span<const TexelModel* const> texel_models();
/// Of these and of those that were added. Null if there is none of this name.
const TexelModel* find_texel_model(const std::string& name);
/// One more, for as long as the program runs. Throws std::invalid_argument where there is one of this name.
const TexelModel& add_texel_model(std::unique_ptr<const TexelModel> model);

}  // namespace radiafit
