// Prints docs/results.md: what every experiment shows and leaves, column by column.
#include <cstdio>

#include "report/experiments.h"

int main() { return std::fputs(radiafit::harness::results_page().c_str(), stdout) < 0; }
