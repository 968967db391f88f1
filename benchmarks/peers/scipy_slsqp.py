"""SciPy's SLSQP with its own numerical gradients on rp96: scipy_slsqp.py OUT [--every K] [--shared]

Plain: an objective and a function of the constraints, as one types them.  --shared: the two share
their evaluations, which SciPy by itself does not arrange.
"""

import argparse
import functools
import multiprocessing
import os
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: the processes share the cores

import numpy
from scipy.optimize import minimize

import rp96


class Separate:
    def __init__(self, problem):
        self.problem = problem

    def objective(self, v):
        return -self.problem.evaluate(v.tolist())[0]

    def constraints(self, v):
        return numpy.array(self.problem.evaluate(v.tolist())[2])


class Shared:
    """Keeps the points of the last gradient, so that each is evaluated once for both functions."""

    def __init__(self, problem):
        self.problem = problem
        self.known = {}

    def at(self, v):
        key = v.tobytes()
        if key not in self.known:
            if len(self.known) > 64:
                self.known.clear()
            eta_b, _, g = self.problem.evaluate(v.tolist())
            self.known[key] = (-eta_b, numpy.array(g))
        return self.known[key]

    def objective(self, v):
        return self.at(v)[0]

    def constraints(self, v):
        return self.at(v)[1]


def refine(teeth, shared):
    problem = rp96.Problem(teeth)
    ends = []
    for start in problem.starts():
        functions = (Shared if shared else Separate)(problem)
        try:
            end = minimize(
                functions.objective,
                start,
                method="SLSQP",
                bounds=problem.bounds(),
                constraints={"type": "ineq", "fun": functions.constraints},
            )
            ends.append(end.x.tolist())
        except (ValueError, ZeroDivisionError):  # a domain error on the way: that start is lost
            ends.append(start)
    return teeth, rp96.best_end(teeth, ends)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("--every", type=int, default=1, help="every k-th tooth set")
    parser.add_argument("--shared", action="store_true")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    sets = rp96.tooth_sets()
    if arguments.every > 1:
        sets = rp96.sample(sets, arguments.every)
    with multiprocessing.Pool(arguments.processes) as pool:
        begin = time.perf_counter()
        designs = pool.map(functools.partial(refine, shared=arguments.shared), sets, chunksize=4)
        wall_time_s = time.perf_counter() - begin
    rp96.write_results(
        arguments.out,
        designs,
        {"wall_time_s": wall_time_s, "starts": len(rp96.START_FRACTIONS)},
    )


if __name__ == "__main__":
    main()
