"""SciPy's differential evolution on a sample of rp96: scipy_differential_evolution.py OUT --every K

Whole populations are evaluated at once with numpy, which is many times as fast as one by one.
"""

import argparse
import multiprocessing
import os
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: the processes share the cores

import numpy
from scipy.optimize import NonlinearConstraint, differential_evolution

import rp96

ARRAYS = rp96.Functions(numpy.sqrt, numpy.tan, numpy.arccos, numpy.maximum, numpy.minimum)
SEED = 1
MAX_GENERATIONS = 1000  # SciPy's own


def refine(teeth):
    problem = rp96.Problem(teeth, ARRAYS)
    constraints = NonlinearConstraint(
        lambda v: numpy.array(problem.evaluate(v)[2]), 0.0, numpy.inf
    )
    end = differential_evolution(
        lambda v: -problem.evaluate(v)[0],
        problem.bounds(),
        constraints=constraints,
        maxiter=MAX_GENERATIONS,
        tol=1e-6,
        polish=False,
        seed=SEED,
        updating="deferred",
        vectorized=True,
    )
    return teeth, end.x.tolist()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("--every", type=int, required=True, help="every k-th tooth set")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    sets = rp96.sample(rp96.tooth_sets(), arguments.every)
    with multiprocessing.Pool(arguments.processes) as pool:
        begin = time.perf_counter()
        designs = pool.map(refine, sets, chunksize=1)
        wall_time_s = time.perf_counter() - begin
    rp96.write_results(arguments.out, designs, {"wall_time_s": wall_time_s, "starts": 1})


if __name__ == "__main__":
    main()
