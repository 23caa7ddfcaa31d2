#pragma once
#include <cstdint>
#include <string>

#include "gl/program.h"

namespace radiafit {

/// What something costs. Operations: components of arithmetic, conversions, comparisons and selections, addresses
/// included; a multiply-add is two; a division, a root or a transcendental function is one. Reads: texels fetched.
struct Work {
    uint64_t operations = 0, reads = 0, read_bytes = 0;
    Work& operator+=(const Work& other) {
        operations += other.operations, reads += other.reads, read_bytes += other.read_bytes;
        return *this;
    }
    friend Work operator*(const Work& a, uint64_t times) {
        return {a.operations * times, a.reads * times, a.read_bytes * times};
    }
};

/// What a fragment program declares of one invocation. tests/check_costs.py counts its SPIR-V and
/// says how. Bytes are those of 32-bit floats and of images with 8 bits a channel; what is written is as many texels as
/// there are targets, of the framebuffer's formats.
struct PassCost {
    const char* shader;   ///< fragment stage, under shaders/
    const char* variant;  ///< the definitions that matter to it, sorted: pass_variant()
    int targets;
    Work fragment;
    Work entry;  ///< of one turn of its loop, if how often it turns is known to the pass alone
};

/// The definitions that a cost depends on: "NAME=value NAME …" in order; sizes of maps and layouts don't count.
std::string pass_variant(const Defines& defines);
/// The program's fragment stage and its variant, such as "gather/look_up.frag STORAGE=0 TERMS=1".
std::string pass_label(const Program& program);
/// What a fragment of it costs; null where none is declared: terms beyond the first, most passes in 16 bits, other
/// batches.
const PassCost* find_pass_cost(const Program& program);

}  // namespace radiafit
