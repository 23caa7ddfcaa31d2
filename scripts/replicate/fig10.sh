#!/bin/sh
# The paper's Figure 10, use of the device's peaks, by one command without parameters.
. "$(dirname "$0")/common.sh"
replicate fig10_utilization
