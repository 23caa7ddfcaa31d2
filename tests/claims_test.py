#!/usr/bin/env python3
"""The claims program over made-up results: every rule can hold, fail and stay undecided; and the README's table is what the
program finds in results/reference.

Arguments: the program, the checkout.
"""
import json
import pathlib
import shutil
import sys
import unittest

from claims.convergence import *  # noqa: F403
from claims.fixture import ClaimsTest
from claims.images import *  # noqa: F403
from claims.scale import *  # noqa: F403
from claims.time import *  # noqa: F403
from cli_fixture import take_arguments


class Report(ClaimsTest):
    def test_nothing_run(self):
        rows, judged = self.judge()
        self.assertEqual({row["verdict"] for row in rows}, {"not run"})
        self.assertEqual(set(judged), {f"C{i}" for i in range(1, 24)})
        self.assertIn("make experiments PROFILE=paper ONLY=fig7_convergence", judged["C1"]["reason"])


if __name__ == "__main__":
    program, checkout = take_arguments(2)
    ClaimsTest.program, ClaimsTest.checkout = program, pathlib.Path(checkout)
    unittest.main()
