#include "report/experiments.h"

#include <algorithm>

namespace radiafit {

const RowFile* find_row_file(std::string_view experiment, std::string_view file) {
    for (const ExperimentEntry* entry : all_experiments())
        if (entry->name == experiment)
            for (const RowFile* one : entry->files)
                if (one->covers(file)) return one;
    return nullptr;
}

}  // namespace radiafit
