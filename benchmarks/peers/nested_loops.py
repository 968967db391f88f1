"""Nested loops over standard modules and tooth counts at zero profile shift, for rp96:
nested_loops.py OUT [--assembly divisible|exact] [--reduced]

As open tools search a Wolfrom gearbox: the reference centre distances must agree exactly, so d, the
ring R1 = S + 2 P1 and the backlash (none) follow, and nothing is left to refine.

Assembly: `divisible` asks that zS, zR1 and zR2 are each divisible by the number of planets, the rule
of the COMPAct framework, which is sufficient but not necessary; `exact` is rp96's own rule.
Loops: over both modules and zS, zP1, zP2 with every test innermost, as such tools have them; with
--reduced each module ratio is visited once and what does not depend on zP2 is tested before it.
"""

import argparse
import time
from fractions import Fraction

import rp96

# The user's input: modules of ISO 54 (series I and II) from 1 to 4 mm, below it the usual ones.
MODULES_MM = ("0.5 0.6 0.7 0.8 0.9 1 1.125 1.25 1.375 1.5 1.75 2 2.25 2.5 2.75 3 3.5 4").split()


def divisible(teeth):
    zS, _, zR1, _, zR2 = teeth
    return zS % rp96.PLANETS == zR1 % rp96.PLANETS == zR2 % rp96.PLANETS == 0


def coaxial_designs():
    """(teeth, m2/m1) within rp96's ranges and ratio, with one reference centre distance."""
    modules = [float(text) for text in MODULES_MM]
    for m1 in modules:
        for m2 in modules:
            for zS in range(10, 21):
                for zP1 in range(20, 61):
                    for zP2 in range(20, 61):
                        zR1 = zS + 2 * zP1
                        difference = m1 * (zS + zP1) / m2  # zR2 - zP2
                        zR2 = zP2 + round(difference)
                        if abs(difference - round(difference)) > 1e-9 or zR1 > 120 or zR2 > 120:
                            continue
                        teeth = (zS, zP1, zR1, zP2, zR2)
                        if rp96.within_ranges(teeth):
                            yield teeth, m2 / m1


def coaxial_designs_reduced():
    """The same designs, each once."""
    modules = [Fraction(text) for text in MODULES_MM]
    for m2 in sorted({m2 / m1 for m1 in modules for m2 in modules}):
        for zS in range(10, 21):
            for zP1 in range(20, 61):
                zR1 = zS + 2 * zP1
                difference = (zS + zP1) / m2
                if zR1 > 120 or difference.denominator != 1:
                    continue
                for zP2 in range(20, min(60, 120 - difference.numerator) + 1):
                    teeth = (zS, zP1, zR1, zP2, zP2 + difference.numerator)
                    if rp96.within_ranges(teeth):
                        yield teeth, float(m2)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("--assembly", choices=("divisible", "exact"), default="divisible")
    parser.add_argument("--reduced", action="store_true")
    arguments = parser.parse_args()
    rule = divisible if arguments.assembly == "divisible" else rp96.assembles
    begin = time.perf_counter()
    coaxial = list((coaxial_designs_reduced if arguments.reduced else coaxial_designs)())
    ends = {}
    for teeth, m2 in coaxial:
        if rule(teeth):
            v = [0.0] * 5 + [m2, 0.5 * (teeth[0] + teeth[1])]
            ends.setdefault(teeth, []).append(v)
    designs = [(teeth, rp96.best_end(teeth, ends[teeth])) for teeth in sorted(ends)]
    wall_time_s = time.perf_counter() - begin
    valid = {teeth for teeth, _ in coaxial if rp96.assembles(teeth)}
    rp96.write_results(
        arguments.out,
        designs,
        {
            "wall_time_s": wall_time_s,
            "starts": 0,
            "complete": True,
            "coaxial": len({teeth for teeth, _ in coaxial}),
            "coaxial_that_assemble": len(valid),
            "dropped_that_assemble": len(valid - set(ends)),
        },
    )


if __name__ == "__main__":
    main()
