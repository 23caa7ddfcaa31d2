"""Rules of experiments/claims/convergence.cpp."""
from claims.fixture import GPU, LLVMPIPE, ClaimsTest
