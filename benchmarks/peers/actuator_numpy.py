#!/usr/bin/env python3
"""Duty cycles and a whole selection: gear3k beside NumPy, on one core, in one run.

  benchmarks/peers/actuator_numpy.py build/release/benchmarks/actuator_cycles

NumPy takes the torque of the motor at the rows of the cycle and the trapezoidal rule, without events: what most would
write.  Its energies differ by what the changes of the flow between two rows are worth.  The selection takes every
pair of both catalogues, a gearbox at a time, motors and rows as one array, and looks for the least energy alone;
gear3k's has the front of energy and mass.
"""

import csv
import os
import subprocess
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def rows_of(path):
    with open(os.path.join(ROOT, path)) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


CYCLE = rows_of("examples/actuators/knee_walking.csv")
T = numpy.array([float(row["time_s"]) for row in CYCLE])
LOAD = numpy.array([float(row["torque_nm"]) for row in CYCLE])
W = numpy.array([float(row["speed_rad_s"]) for row in CYCLE])


def energy(ratio, forward, backward, coulomb, rotor, viscous, resistance, constant):
    """Energy from the bus less what goes back; the last four may be columns of motors."""
    sense = numpy.sign(W)
    mesh = coulomb * sense - LOAD
    fast = numpy.where(mesh * W > 0.0, mesh / forward, mesh * backward)
    acceleration = numpy.gradient(W, T)
    torque = fast / ratio + rotor * ratio * acceleration + viscous * ratio * W
    current = torque / constant
    power = resistance * current**2 + torque * ratio * W
    return numpy.trapz(power, T)


def best_time(call, tries):
    best = float("inf")
    for _ in range(tries):
        begin = time.process_time()
        result = call()
        best = min(best, time.process_time() - begin)
    return best, result


def number(row, column):
    return float(row[column]) if row.get(column) else 0.0


def selection():
    motors = rows_of("data/motor_catalogue.csv")
    column = lambda name: numpy.array([[number(row, name)] for row in motors])
    rotor, resistance = column("rotor_inertia_kgm2"), column("resistance_ohm")
    constant = column("torque_constant_nm_per_a")
    best = float("inf")
    for row in rows_of("data/planetary_gearbox_catalogue.csv"):
        eta = float(row["efficiency"])
        inertia = rotor + number(row, "input_inertia_kgm2")
        values = energy(float(row["ratio"]), eta, eta, 0.0, inertia, 0.0, resistance, constant)
        best = min(best, values.min())
    return best


def main():
    told = {}
    for line in subprocess.run(sys.argv[1], check=True, capture_output=True, text=True).stdout.splitlines():
        name, rate, value = line.split()
        told[name] = (float(rate), float(value))
    knee = lambda: energy(100.0, 0.85, 0.82, 0.5, 1.81e-5, 1.3e-5, 0.608, 0.0369)
    cycles = 2000
    taken, joules = best_time(lambda: [knee() for _ in range(cycles)][-1], 3)
    rate, own = told["catalogue_cycles"]
    print(f"catalogue cycles a second   gear3k {rate:9.0f}   NumPy {cycles / taken:9.0f}   ratio {rate * taken / cycles:6.1f}")
    print(f"  energy of a stride [J]    gear3k {own:9.4f}   NumPy {joules:9.4f}")
    print(f"design cycles a second      gear3k {told['design_cycles'][0]:9.0f}")
    print(f"pairs screened a second     gear3k {told['screened_pairs'][0]:9.0f}")
    taken, joules = best_time(selection, 1)
    seconds = told["selection_s"][0]
    print(f"whole selection [s]         gear3k {seconds:9.3f}   NumPy {taken:9.2f}   ratio {taken / seconds:6.1f}")


if __name__ == "__main__":
    main()
