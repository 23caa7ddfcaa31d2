"""PyTorch's optimizers on all problems of a light field map at once, and the clock that a descent is timed by."""
import contextlib
import ctypes
import time

import torch


def keep_memory():
    """glibc gives large blocks back at once, and the kernel clears them when they are asked for again: five times the time of an
    evaluation here. mallopt() makes it keep them."""
    trim_threshold, mmap_threshold = -1, -3
    libc = ctypes.CDLL(None)
    for option, most in ((trim_threshold, 2**31 - 1), (mmap_threshold, 2**30)):
        libc.mallopt(option, most)


class Clock:
    """Seconds, but for those in which it is stopped."""

    def __init__(self):
        self.before, self.since = 0.0, time.perf_counter()

    def seconds(self):
        return self.before if self.since is None else self.before + time.perf_counter() - self.since

    @contextlib.contextmanager
    def stopped(self):
        self.before, self.since = self.seconds(), None
        yield
        self.since = time.perf_counter()


def adam(problem, clock, rate):
    """Yields the maps after every step."""
    parameters = [p.clone().requires_grad_() for p in problem.start]
    optimizer = torch.optim.Adam(parameters, lr=rate)
    while True:
        optimizer.zero_grad()
        problem.error(*parameters).backward()
        optimizer.step()
        yield [p.detach() for p in parameters]


def lbfgs(problem, clock, history):
    """Yields the maps after every iteration: a line search, one step length for all problems, and an update of the history."""
    parameters = [p.clone().requires_grad_() for p in problem.start]
    optimizer = torch.optim.LBFGS(parameters, max_iter=1, max_eval=10**6, tolerance_grad=0, tolerance_change=0, history_size=history,
                                  line_search_fn="strong_wolfe")  # fmt: skip
    again = False  # each step() begins by evaluating where the one before ended: what it need not do is not timed

    def evaluate():
        nonlocal again
        optimizer.zero_grad()
        with clock.stopped() if again else contextlib.nullcontext():
            value = problem.error(*parameters)
            value.backward()
        again = False
        return value

    while True:
        optimizer.step(evaluate)
        again = True
        yield [p.detach() for p in parameters]


def descend(problem, method, steps, target=None, most_seconds=float("inf")):
    """Points of a descent from the start: after every step until the target is reached or time is up, or without a target after the
    last alone."""
    points, clock = [], Clock()
    for step, maps in enumerate(method(problem, clock), 1):
        if target is not None or step == steps:
            with clock.stopped():
                points.append(point(problem, maps, step, clock.seconds()))
        if step == steps or (target is not None and (points[-1]["psnr_db"] >= target or points[-1]["seconds"] > most_seconds)):
            return points


@torch.no_grad()
def point(problem, maps, iterations, seconds):
    error = float(problem.error(*maps))
    return {"iterations": iterations, "seconds": seconds, "psnr_db": problem.psnr(*maps), "error": error}
