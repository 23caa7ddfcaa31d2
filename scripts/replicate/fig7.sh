#!/bin/sh
# The paper's Figure 7, convergence of conjugate gradients and of steepest descent, by one command without parameters.
. "$(dirname "$0")/common.sh"
replicate fig7_convergence
