#!/bin/sh
# The paper's Figure 9, error of factorization and of nonlinear optimization, by one command without parameters.
. "$(dirname "$0")/common.sh"
replicate fig9_error
