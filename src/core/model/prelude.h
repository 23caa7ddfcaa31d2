#pragma once
#include <algorithm>
#include <cmath>

#include "base/select_number.h"

/// The C++ side of the dialect that model and optimizer texts under shaders/ are written in. A text is included inside
/// `template <class real> struct NAME : shared_text::Types<real> { ... }`; see shaders/model/prelude.glsl.
/// `real` may be float, double, a SIMD pack or a ceres::Jet.
namespace radiafit::shared_text {

template <class real>
struct real2_t {
    real x, y;
    real2_t() = default;
    real2_t(const real& a, const real& b) : x(a), y(b) {}
};

template <class real>
struct real3_t {
    real x, y, z;
    real3_t() = default;
    real3_t(const real& a, const real& b, const real& c) : x(a), y(b), z(c) {}
    friend real3_t operator+(const real3_t& a, const real3_t& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend real3_t operator-(const real3_t& a, const real3_t& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend real3_t operator*(const real3_t& a, const real3_t& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend real3_t operator*(const real3_t& a, const real& b) { return {a.x * b, a.y * b, a.z * b}; }
    friend real3_t operator*(const real& a, const real3_t& b) { return b * a; }
};

template <class real>
struct real4_t {
    real x, y, z, w;
    real4_t() = default;
    real4_t(const real& a, const real& b, const real& c, const real& d) : x(a), y(b), z(c), w(d) {}
};

}  // namespace radiafit::shared_text

// The texts are macros' only users; each inclusion site undefines nothing, so keep the names out of public headers.
#define INOUT(T) T&
#define SELECT(c, a, b) (::radiafit::select_number<real>((c), (a), (b)))
#define SHARED_FN static inline
