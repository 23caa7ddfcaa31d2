#!/bin/sh
# The paper's Figure 8, where the time of a fit goes, by one command without parameters.
. "$(dirname "$0")/common.sh"
replicate fig8_time
