#!/usr/bin/env python3
"""4 s of a swinging pendulum behind a lossy gearbox: gear3k's motion beside SciPy's DOP853 with events.

  benchmarks/peers/motion_dop853.py build/release/benchmarks/pendulum_motion

SciPy follows the angle and the speed alone, then the energy of every cause besides, as gear3k does.  The equations
are written here once more, by the accelerations of both sides; errors are those of angle and speed at
the end against a run of DOP853 at 1e-13.  SciPy looks for changes at the ends of steps alone: with
longer steps than 20 ms it passes over some of them here.
"""

import math
import subprocess
import sys
import time

import numpy
import scipy
from scipy.integrate import solve_ivp

# The same numbers stand in pendulum_motion.cpp.
RATIO, ROTOR, LOAD = 50.0, 2e-5, 0.01 + 1.5 * 0.3**2
FORWARD, BACKWARD = 0.8, 0.7
FAST, SLOW = RATIO**2 * ROTOR, LOAD
FAST_COULOMB, FAST_STATIC, FAST_VISCOUS = RATIO * 0.004, RATIO * 0.008, RATIO**2 * 1e-6
SLOW_COULOMB, SLOW_STATIC, SLOW_VISCOUS = 0.3, 0.6, 0.02
DURATION = 4.0


def motor(t):
    return RATIO * 0.12 * math.sin(2.0 * math.pi * 0.6 * t)


def load(angle):
    return -1.5 * 9.80665 * 0.3 * math.sin(angle)


def sides(t, x, sense):
    fast = (motor(t) - FAST_VISCOUS * x[1] - FAST_COULOMB * sense) / FAST
    slow = (load(x[0]) - SLOW_VISCOUS * x[1] - SLOW_COULOMB * sense) / SLOW
    return fast, slow


def acceleration(fast, slow, flow):
    if flow > 0:
        return (FORWARD * FAST * fast + SLOW * slow) / (FORWARD * FAST + SLOW)
    return (FAST * fast + BACKWARD * SLOW * slow) / (FAST + BACKWARD * SLOW)


def resting_pull(t, angle, sense):
    """Acceleration from rest in a sense, less than zero where it does not start."""
    fast = (motor(t) - FAST_STATIC * sense) / FAST
    slow = (load(angle) - SLOW_STATIC * sense) / SLOW
    return sense * acceleration(fast, slow, 1 if sense * (fast - slow) > 0 else -1)


def powers(at, y, sense, a):
    """Electrical power and losses by cause, for the ledger."""
    w = y[1]
    torque = motor(at) / RATIO
    copper = 0.6 * (torque / 0.04) ** 2
    inner = motor(at) - FAST_VISCOUS * w - FAST_COULOMB * sense - FAST * a
    mesh = SLOW * a - load(y[0]) + SLOW_VISCOUS * w + SLOW_COULOMB * sense
    return [copper + motor(at) * w, copper, FAST_COULOMB * abs(w), FAST_VISCOUS * w * w,
            SLOW_COULOMB * abs(w), SLOW_VISCOUS * w * w, (inner - mesh) * w]


def slide(t, x, sense, tolerance):
    """One mode of sliding: until the speed or the lead of a side passes zero."""
    fast, slow = sides(t, x, sense)
    flow = 1 if sense * (fast - slow) >= 0 else -1

    def slopes(at, y):
        a = acceleration(*sides(at, y, sense), flow)
        return [y[1], a] if len(y) == 2 else [y[1], a, *powers(at, y, sense, a)]

    def stops(_, y):
        return sense * y[1]

    def leads(at, y):
        a, b = sides(at, y, sense)
        return flow * sense * (a - b)

    for event in (stops, leads):
        event.terminal, event.direction = True, -1
    run = solve_ivp(slopes, (t, DURATION), x, method="DOP853", rtol=tolerance,
                    atol=0.1 * tolerance, events=(stops, leads), max_step=DURATION / 200.0)
    end = run.y[:, -1].copy()
    if len(run.t_events[0]):
        end[1] = 0.0
    if run.t[-1] == t:  # a change at the very beginning
        return t + 1e-14, end, flow
    return run.t[-1], end, flow


def first_start(t, angle):
    """When and in which sense the resting output starts; by steps and bisection."""
    step = 1e-3
    while t < DURATION:
        for sense in (1, -1):
            if resting_pull(t + step, angle, sense) > 0.0:
                low, high = t, t + step
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    if resting_pull(middle, angle, sense) > 0.0:
                        high = middle
                    else:
                        low = middle
                return high, sense
        t += step
    return DURATION, 0


def motion(tolerance, energies=0):
    t, x, modes = 0.0, numpy.array([0.2, 0.0] + [0.0] * energies), 0
    while t < DURATION:
        if x[1] == 0.0:
            sense = next((s for s in (1, -1) if resting_pull(t, x[0], s) > 0.0), 0)
            if sense == 0:
                t, sense = first_start(t, x[0])
                if sense == 0:
                    break
        else:
            sense = 1 if x[1] > 0 else -1
        t, x, _ = slide(t, x, sense, tolerance)
        modes += 1
    return x, modes


def main():
    truth, _ = motion(1e-13)

    def error(x):
        return math.hypot(x[0] - truth[0], x[1] - truth[1])

    taken = {}
    for energies, what in ((0, "motion alone"), (7, "with its energies")):
        times = []
        for _ in range(5):
            begin = time.perf_counter()
            end, modes = motion(1e-8, energies)
            times.append(time.perf_counter() - begin)
        taken[what] = (min(times), error(end))
        print(f"DOP853, SciPy {scipy.__version__}, rel 1e-8, {what}: {1e3 * min(times):.2f} ms, "
              f"error {error(end):.1e}, {modes} modes of sliding")
    tolerances = [f"1e-{k}" for k in range(6, 13)]
    lines = subprocess.run([sys.argv[1], *tolerances], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    runs = []
    for line in lines:
        tolerance, seconds, angle, speed, events = line.split()
        runs.append((float(seconds), error((float(angle), float(speed)))))
        print(f"gear3k, rel {tolerance}: {1e3 * float(seconds):.3f} ms, error {runs[-1][1]:.1e}, "
              f"{events} events")
    for what, (seconds, theirs) in taken.items():
        matched = [ours for ours, off in runs if off <= theirs]
        print(f"{what}: " + (f"{seconds / min(matched):.0f} times as fast at an error not above DOP853's"
                             if matched else "no tolerance has DOP853's error"))


if __name__ == "__main__":
    main()
