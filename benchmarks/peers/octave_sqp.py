"""GNU Octave's sqp on a sample of rp96: octave_sqp.py OUT --every K"""

import argparse
import csv
import os
import shutil
import subprocess
import sys
import tempfile

import rp96

HERE = os.path.dirname(os.path.abspath(__file__))
NOT_INSTALLED = 77


def run_octave(octave, sets, processes):
    """(ends of each set's starts, wall time without the interpreter's own start)."""
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    with tempfile.TemporaryDirectory() as folder:
        running = []
        for p in range(processes):
            names = [os.path.join(folder, f"{name}_{p}") for name in ("starts", "ends", "seconds")]
            with open(names[0], "w", newline="") as file:
                rows = csv.writer(file)
                for teeth in sets[p::processes]:
                    problem = rp96.Problem(teeth)
                    lower, upper = zip(*problem.bounds())
                    for start in problem.starts():
                        rows.writerow([*teeth, *map(repr, (*lower, *upper, *start))])
            command = [octave, "--norc", "--quiet", os.path.join(HERE, "octave_sqp.m"), *names]
            # Octave 7 writes a line about its own exit to stderr: shown only when it fails.
            process = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
            running.append((process, names))
        ends, seconds = {}, 0.0
        for p, (process, names) in enumerate(running):
            complaints = process.communicate()[1]
            if process.returncode != 0:
                sys.exit(f"octave_sqp: octave-cli ended with {process.returncode}\n{complaints}")
            with open(names[1]) as file:
                rows = [[float(x) for x in row] for row in csv.reader(file)]
            each = len(rp96.START_FRACTIONS)
            for k, teeth in enumerate(sets[p::processes]):
                ends[teeth] = rows[k * each : (k + 1) * each]
            with open(names[2]) as file:
                seconds = max(seconds, float(file.read()))
        return ends, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("--every", type=int, required=True, help="every k-th tooth set")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    octave = shutil.which("octave-cli")
    if octave is None:
        print("octave: not installed, skipped: apt-get install octave", file=sys.stderr)
        sys.exit(NOT_INSTALLED)
    sets = rp96.sample(rp96.tooth_sets(), arguments.every)
    ends, wall_time_s = run_octave(octave, sets, arguments.processes)
    designs = [(teeth, rp96.best_end(teeth, ends[teeth])) for teeth in sets]
    rp96.write_results(
        arguments.out,
        designs,
        {"wall_time_s": wall_time_s, "starts": len(rp96.START_FRACTIONS)},
    )


if __name__ == "__main__":
    main()
