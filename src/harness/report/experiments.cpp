#include "report/experiments.h"

#include <algorithm>

namespace radiafit::harness {

std::vector<const ExperimentEntry*> reported_experiments() {
    std::vector<const ExperimentEntry*> reported;
    std::ranges::copy_if(all_experiments(), std::back_inserter(reported),
                         [](const ExperimentEntry* entry) { return *entry->title != '\0'; });
    return reported;
}

const RowFile* find_row_file(std::string_view experiment, std::string_view file) {
    for (const ExperimentEntry* entry : all_experiments())
        if (entry->name == experiment)
            for (const RowFile* one : entry->files)
                if (one->covers(file)) return one;
    return nullptr;
}

}  // namespace radiafit::harness
