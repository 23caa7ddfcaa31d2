#pragma once
#include "base/compiled_library.h"
#include "batch/kernel/chunk.h"
#include "batch/model_text.h"

namespace radiafit::batch {

enum class Precision { single_precision, double_precision };

/// A model as machine code, made by this machine's C++ compiler for its widest vectors (base/compiled_library.h).
class CompiledModel {
public:
    /// Throws UserError: there is no compiler; or what it says of the text, "NAME:LINE: ...".
    CompiledModel(const ModelText& text, Precision precision);

    const ModelText& text() const { return text_; }
    Precision precision() const { return precision_; }
    /// Bytes of a worker's storage, where problems have so many samples at most.
    long long storage_bytes(long long samples) const { return storage_bytes_(samples); }
    /// Solves a chunk's problems. storage: storage_bytes(), aligned to 64 bytes. Thread-safe.
    void solve(const Chunk& chunk, void* storage) const { solve_(&chunk, storage); }
    /// One problem's values [samples][values] at parameters and terms [samples][terms], and their derivatives by the
    /// parameters, [samples][values][parameters]; null: not wanted. real: as the model was compiled. Thread-safe.
    void evaluate(const void* parameters, const void* terms, long long samples, void* values, void* derivatives) const {
        evaluate_(parameters, terms, samples, values, derivatives);
    }
    double seconds() const { return library_.seconds(); }  ///< that compiling took; 0: it was there

private:
    ModelText text_;
    Precision precision_;
    CompiledLibrary library_;
    long long (*storage_bytes_)(long long) = nullptr;  ///< the library's functions
    void (*solve_)(const Chunk*, void*) = nullptr;
    void (*evaluate_)(const void*, const void*, long long, void*, void*) = nullptr;
};

}  // namespace radiafit::batch
