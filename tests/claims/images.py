"""Rules of experiments/claims/images.cpp."""
from claims.fixture import GPU, LLVMPIPE, ClaimsTest
