#pragma once
#include <string_view>

namespace radiafit {

/// The function of that name in a module of the program (base/module.h), which stays loaded. Throws UserError with
/// `failure`, where {} stands for the reason.
void* find_in_module(const char* module, const char* function, std::string_view failure);

template <class Function>
Function* load_function(const char* module, const char* function, std::string_view failure) {
    return reinterpret_cast<Function*>(find_in_module(module, function, failure));
}

}  // namespace radiafit
