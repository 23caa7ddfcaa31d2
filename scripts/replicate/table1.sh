#!/bin/sh
# The paper's Table 1, its datasets, by one command without parameters.
. "$(dirname "$0")/common.sh"
replicate table1_datasets md
