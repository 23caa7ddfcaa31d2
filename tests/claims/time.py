"""Rules of experiments/claims/time.cpp."""
from claims.fixture import GPU, LLVMPIPE, ClaimsTest
