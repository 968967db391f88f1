"""The reference problem RP-96, typed from docs/rp96.md; shares no code with gear3k.

Every program of this folder writes designs; `judge` decides for all of them, gear3k included, what a
design is worth and whether it is feasible.  The Python peers solve `Problem`, the same text.

Lengths in modules of stage 1 (m1 = 1), angles in radians.  A design is
v = (xS, xP1, xR1, xP2, xR2, m2, d).
"""

import collections
import csv
import json
import math
import os

PLANETS = 3
RATIO, RATIO_TOLERANCE = 96.2, 0.005
ALPHA = math.radians(20.0)
MU = 0.1
LOST_MOTION = math.radians(8.0 / 60.0)
FEASIBLE = 1e-6  # every constraint, scaled to order 1, holds within this

TEETH = ("zS", "zP1", "zR1", "zP2", "zR2")
DESIGN = ("xS", "xP1", "xR1", "xP2", "xR2", "m2", "d")
WINNER = (12, 54, 120, 47, 118)  # the best set that docs/rp96.md names: part of every sample

# Fractions of the shift range for (xS, xP1, xP2, xR2): the starts of every gradient method here.
START_FRACTIONS = (
    (0.50, 0.25, 0.30, 0.95),
    (0.35, 0.05, 0.10, 0.50),
    (0.80, 0.60, 0.50, 0.95),
    (0.30, 0.40, 0.70, 0.80),
)

# The functions that `Problem` computes with: floats here, arrays of designs with numpy's.
Functions = collections.namedtuple("Functions", "sqrt tan acos maximum minimum")
SCALAR = Functions(math.sqrt, math.tan, math.acos, max, min)


def ratio(teeth):
    zS, zP1, zR1, zP2, zR2 = teeth
    return (1.0 + zR1 / zS) / (1.0 - zP2 * zR1 / (zP1 * zR2))


def assembles(teeth):
    """Whether PLANETS identical planets fit at equal spacing."""
    zS, zP1, zR1, zP2, zR2 = teeth
    return (zS + zR1) % PLANETS == 0 and (
        (zR2 * zP1 - zR1 * zP2) % (PLANETS * math.gcd(zP1, zP2)) == 0
    )


def within_ranges(teeth):
    """The ranges of the tooth counts and the ratio, without assembly."""
    zS, zP1, zR1, zP2, zR2 = teeth
    return (
        10 <= zS <= 20
        and 20 <= zP1 <= 60
        and 20 <= zP2 <= 60
        and abs(zR1 - (zS + 2 * zP1)) <= 4
        and zR1 <= 120
        and zR2 <= 120
        and zR1 - zP1 >= 8
        and zR2 - zP2 >= 8
        and zP2 * zR1 < zP1 * zR2
        and abs(ratio(teeth) / RATIO - 1.0) <= RATIO_TOLERANCE
    )


def tooth_sets():
    """All 654 sets, in the order of their tooth counts."""
    sets = []
    for zS in range(10, 21):
        for zP1 in range(20, 61):
            for zR1 in range(zS + 2 * zP1 - 4, min(zS + 2 * zP1 + 4, 120) + 1):
                if (zS + zR1) % PLANETS:
                    continue
                for zP2 in range(20, 61):
                    # G2 = zP2 zR1/(zP1 zR2) lies close to 1 - (1 + G1)/ratio; a tooth of slack.
                    near = zP2 * zR1 / zP1 / (1.0 - (1.0 + zR1 / zS) / RATIO)
                    for zR2 in range(int(0.99 * near) - 1, int(1.01 * near) + 3):
                        teeth = (zS, zP1, zR1, zP2, zR2)
                        if within_ranges(teeth) and assembles(teeth):
                            sets.append(teeth)
    return sets


def sample(sets, every):
    """Every `every`-th set, and the winner of docs/rp96.md."""
    return sorted(set(sets[::every]) | {WINNER})


def involute(angle, f=SCALAR):
    return f.tan(angle) - angle


class Problem:
    """One tooth set: eta_b and the margins, each >= 0 where its constraint holds."""

    def __init__(self, teeth, functions=SCALAR):
        self.teeth = teeth
        self.f = functions
        self.inv_alpha = involute(ALPHA)
        self.tan_alpha = math.tan(ALPHA)
        self.cos_alpha = math.cos(ALPHA)
        zS, zP1, zR1, zP2, zR2 = teeth
        self.G1 = zR1 / zS
        self.G2 = zP2 * zR1 / (zP1 * zR2)
        self.ratio = ratio(teeth)
        self.base_sum = 0.5 * self.cos_alpha * max(zS + zP1, zR1 - zP1)  # d is larger
        self.m2_ratio = (zS + zP1) / (zR2 - zP2)  # m2 of equal reference centre distances

    def mesh(self, ring, m, z1, z2, x1, x2, d):
        """(j_bn, ea, er, efficiency, cos(alpha_w), margins of interference) of a pair.

        Undefined where cos(alpha_w) > 1; continued there by alpha_w near 0, so that solvers find
        their way back: the caller has 1 - cos(alpha_w) as a margin of its own.
        """
        f = self.f
        rb1 = 0.5 * m * z1 * self.cos_alpha
        rb2 = 0.5 * m * z2 * self.cos_alpha
        cos_w = ((rb2 - rb1) if ring else (rb1 + rb2)) / d
        aw = f.acos(f.minimum(cos_w, 1.0 - 1e-12))
        tan_w = f.tan(aw)
        inv_w = tan_w - aw
        ra1 = m * (0.5 * z1 + 1.0 + x1)
        reach1 = f.sqrt(ra1 * ra1 - rb1 * rb1)
        pb = math.pi * m * self.cos_alpha
        # d sin(alpha_w): the distance of the base circles' tangent points.
        line = d * f.sqrt(f.maximum(1.0 - cos_w * cos_w, 0.0))
        if ring:
            ra2 = m * (0.5 * z2 - 1.0 + x2)
            reach2 = f.sqrt(f.maximum(ra2 * ra2 - rb2 * rb2, 0.0))
            e2 = (rb2 * tan_w - reach2) / pb
            # Working pitch less both thicknesses, on the base circle.
            j = m * self.cos_alpha * (
                2.0 * (x2 - x1) * self.tan_alpha - (z2 - z1) * (inv_w - self.inv_alpha)
            )
            interference = (reach2 - line, ra2 - rb2)
        else:
            ra2 = m * (0.5 * z2 + 1.0 + x2)
            reach2 = f.sqrt(ra2 * ra2 - rb2 * rb2)
            e2 = (reach2 - rb2 * tan_w) / pb
            j = m * self.cos_alpha * (
                (z1 + z2) * (inv_w - self.inv_alpha) - 2.0 * (x1 + x2) * self.tan_alpha
            )
            interference = (line - reach1, line - reach2)
        e1 = (reach1 - rb1 * tan_w) / pb
        b = 1.0 - (e1 + e2) + e1 * e1 + e2 * e2
        eta = 1.0 - MU * math.pi * (1.0 / z1 + (-1.0 if ring else 1.0) / z2) * b
        return j, e1 + e2, eta, cos_w, interference

    def tip_thickness(self, z, x):
        """In the gear's own module."""
        tip = z + 2.0 + 2.0 * x
        at_tip = self.f.acos(z * self.cos_alpha / tip)
        return tip * (
            (0.5 * math.pi + 2.0 * x * self.tan_alpha) / z
            + self.inv_alpha
            - involute(at_tip, self.f)
        )

    def evaluate(self, v):
        """(eta_b, eta_f, margins); the bounds on x are not among the margins."""
        zS, zP1, zR1, zP2, zR2 = self.teeth
        xS, xP1, xR1, xP2, xR2, m2, d = v
        meshes = (
            self.mesh(False, 1.0, zS, zP1, xS, xP1, d),
            self.mesh(True, 1.0, zP1, zR1, xP1, xR1, d),
            self.mesh(True, m2, zP2, zR2, xP2, xR2, d),
        )
        g = []
        for j, eps, _, cos_w, interference in meshes:
            g += (j, eps - 1.2, 2.0 - eps, 1.0 - cos_w, *interference)
        j1, j2, j3 = (mesh[0] for mesh in meshes)
        phi1 = j1 / self.cos_alpha / (0.5 * self.ratio * zS)
        phi2 = j2 / self.cos_alpha / (0.5 * zR1)
        phi3 = j3 / self.cos_alpha / (0.5 * m2 * zR2)
        # phi1 + max(phi2, phi3) as two smooth constraints.
        g += (1.0 - (phi1 + phi2) / LOST_MOTION, 1.0 - (phi1 + phi3) / LOST_MOTION)
        sin2 = math.sin(ALPHA) ** 2
        for z, x in ((zS, xS), (zP1, xP1), (zP2, xP2)):
            g += (self.tip_thickness(z, x) - 0.25, x - (1.0 - 0.5 * z * sin2))
        spacing = 2.0 * d * math.sin(math.pi / PLANETS)
        g += (
            spacing - (zP1 + 2.0 + 2.0 * xP1) - 0.5,
            spacing - m2 * (zP2 + 2.0 + 2.0 * xP2) - 0.5,
        )
        eta1, eta2, eta3 = (mesh[2] for mesh in meshes)
        G1, G2 = self.G1, self.G2
        eta_f = (1.0 + eta1 * eta2 * G1) * (1.0 - G2) / ((1.0 + G1) * (1.0 - eta2 * eta3 * G2))
        eta_b = eta1 * (1.0 + G1) * (eta2 * eta3 - G2) / (eta3 * (G1 + eta1 * eta2) * (1.0 - G2))
        return eta_b, eta_f, g

    def bounds(self):
        """Boxes for solvers that want them, wide enough never to bind at an optimum of rp96."""
        return [(0.0, 1.0)] * 5 + [
            (0.7 * self.m2_ratio, 1.4 * self.m2_ratio),
            (self.base_sum, 1.2 * self.base_sum),
        ]

    def start(self, fractions):
        """A design that closes the meshes, as far as the box allows: S-P1 without backlash gives d,
        P1-R1 without backlash at that d gives xR1, P2-R2 without backlash gives m2."""
        zS, zP1, zR1, zP2, zR2 = self.teeth
        xS, xP1, xP2, xR2 = fractions
        aw1 = inverse_involute(self.inv_alpha + 2.0 * self.tan_alpha * (xS + xP1) / (zS + zP1))
        d = 0.5 * (zS + zP1) * self.cos_alpha / math.cos(aw1)
        cos2 = 0.5 * (zR1 - zP1) * self.cos_alpha / d
        aw2 = math.acos(cos2) if cos2 < 1.0 else 0.0
        xR1 = xP1 + (involute(aw2) - self.inv_alpha) * (zR1 - zP1) / (2.0 * self.tan_alpha)
        aw3 = inverse_involute(self.inv_alpha + 2.0 * self.tan_alpha * (xR2 - xP2) / (zR2 - zP2))
        m2 = 2.0 * d * math.cos(aw3) / ((zR2 - zP2) * self.cos_alpha)
        v = (xS, xP1, xR1, xP2, xR2, m2, d)
        return [min(max(x, low), high) for x, (low, high) in zip(v, self.bounds())]

    def starts(self):
        return [self.start(fractions) for fractions in START_FRACTIONS]


def inverse_involute(value):
    angle = max((3.0 * max(value, 1e-12)) ** (1.0 / 3.0), 1e-3)
    for _ in range(50):
        step = (involute(angle) - value) / math.tan(angle) ** 2
        angle = min(max(angle - step, 1e-3), 1.5)
        if abs(step) < 1e-15:
            break
    return angle


Verdict = collections.namedtuple("Verdict", "feasible eta_b violation")


def judge(teeth, v):
    """The one verdict on a design: feasible, eta_b, largest violation (scaled to order 1)."""
    undefined = Verdict(False, float("nan"), float("inf"))
    if not within_ranges(teeth) or not assembles(teeth):
        return undefined
    if not all(math.isfinite(x) for x in v) or v[5] <= 0.0 or v[6] <= 0.0:
        return undefined
    eta_b, _, g = Problem(teeth).evaluate(v)
    g += [min(x, 1.0 - x) for x in v[:5]]
    violation = max(0.0, -min(g))
    return Verdict(violation <= FEASIBLE, eta_b, violation)


def best_end(teeth, ends):
    """Of the ends of several starts the best feasible one, or the one that violates least."""

    def rank(v):
        verdict = judge(teeth, v)
        return (1, verdict.eta_b) if verdict.feasible else (0, -verdict.violation)

    return max(ends, key=rank)


def write_results(folder, designs, facts):
    """results.csv, a row for every tooth set tried, and facts.json (wall_time_s, starts, ...)."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "results.csv"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(TEETH + DESIGN)
        for teeth, v in designs:
            rows.writerow([*teeth, *(repr(float(x)) for x in v)])
    with open(os.path.join(folder, "facts.json"), "w") as file:
        json.dump(facts, file, indent=1)
