"""Rules of experiments/claims/scale.cpp."""
from claims.fixture import GPU, LLVMPIPE, ClaimsTest
