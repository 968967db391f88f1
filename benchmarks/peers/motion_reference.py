#!/usr/bin/env python3
"""Events of a simulated motion by SciPy's DOP853 at 1e-13, each placed to rounding: a witness for gear3k simulate.

  benchmarks/peers/motion_reference.py ACTUATOR.toml SCENARIO.toml > EVENTS.csv

Written from the equations of the two sides of a drive (docs/theory section 58, 66, 67) alone; it shares no code with
gear3k.  Reads catalogue gearboxes with stated frictions, a gap, and scenarios without phases.  tests/golden/motion
has what it printed.
"""

import csv
import math
import os
import sys
import tomllib

import numpy
from scipy.integrate import DOP853
from scipy.optimize import brentq

RELATIVE, ABSOLUTE, LONGEST_STEP, POINTS = 1e-13, 1e-15, 0.01, 16
LONGEST_AT_REST = 5e-4  # the output may be let go and held again by the gap's other side within a millisecond
STOPPED = 1e-15  # a speed that has ended lies this far beyond zero


class Signal:
    """Constant, sine and a table of straight lines; one-sided at the table's jumps."""

    def __init__(self, keys, constant, amplitude, column, folder):
        self.constant, self.amplitude = keys.get(constant, 0.0), keys.get(amplitude, 0.0)
        self.omega = 2.0 * math.pi * keys.get("frequency_hz", 0.0)
        self.rows = []
        if "table" in keys:
            with open(os.path.join(folder, keys["table"])) as file:
                self.rows = [(float(r["time_s"]), float(r[column])) for r in csv.DictReader(file)]

    def piece(self, t, side):
        """Rows before and after, as seen from one side."""
        before = [r for r in self.rows if (r[0] <= t if side > 0 else r[0] < t)]
        after = self.rows[len(before):]
        return (before or after)[-1 if before else 0], (after or before)[0 if after else -1]

    def value(self, t, side):
        v = self.constant + self.amplitude * math.sin(self.omega * t)
        if self.rows:
            (t0, v0), (t1, v1) = self.piece(t, side)
            v += v0 if t1 == t0 else v0 + (v1 - v0) * (t - t0) / (t1 - t0)
        return v

    def slope(self, t, side):
        v = self.amplitude * self.omega * math.cos(self.omega * t)
        if self.rows:
            (t0, v0), (t1, v1) = self.piece(t, side)
            v += 0.0 if t1 == t0 else (v1 - v0) / (t1 - t0)
        return v


class Drive:
    """Two sides and a mesh; all at the output."""

    def __init__(self, actuator, scenario, folder):
        motor, gearbox = actuator["motor"], actuator["gearbox"]
        self.ratio = i = gearbox["ratio"]
        self.forward, self.backward = gearbox["efficiency_forward"], gearbox["efficiency_backward"]
        self.constant, self.resistance = motor["torque_constant_nm_per_a"], motor["resistance_ohm"]
        self.c1 = abs(i) * motor["coulomb_torque_nm"]
        self.c1_rest = abs(i) * motor["static_torque_nm"]
        self.d1 = i * i * (motor["no_load_current_a"] * self.constant - motor["coulomb_torque_nm"]) / motor["no_load_speed_rad_s"]
        self.c2, self.c2_rest = gearbox["coulomb_torque_nm"], gearbox["backdriving_torque_nm"]
        self.d2 = gearbox["viscous_nms_per_rad"]
        control, load = scenario["control"], scenario["load"]
        self.mode = control["mode"]
        names = {"torque": ("torque_nm", "torque_amplitude_nm", "motor_torque_nm"),
                 "voltage": ("voltage_v", "voltage_amplitude_v", "voltage_v"),
                 "position": ("angle_rad", "angle_amplitude_rad", "angle_rad")}
        self.command = Signal(control, *names.get(self.mode, names["torque"]), folder)
        self.gain, self.damping = control.get("stiffness_nm_per_rad", 0.0), control.get("damping_nms_per_rad", 0.0)
        self.torque = Signal(load, "torque_nm", "torque_amplitude_nm", "torque_nm", folder)
        self.spring, self.rest = load.get("stiffness_nm_per_rad", 0.0), load.get("rest_angle_rad", 0.0)
        mass, length = load.get("pendulum_mass_kg", 0.0), load.get("pendulum_length_m", 0.0)
        self.weight, self.hanging = mass * 9.80665 * length, load.get("pendulum_angle_rad", 0.0)
        self.j1 = i * i * motor["rotor_inertia_kgm2"]
        self.j2 = actuator["load"]["inertia_kgm2"] + mass * length * length
        self.half_gap = math.radians(actuator.get("backlash", {}).get("output_arcmin", 0.0) / 60.0) / 2.0

    def motor(self, t, side, y):
        if self.mode == "position":
            return self.gain * (self.command.value(t, side) - y[2]) + self.damping * (self.command.slope(t, side) - y[3])
        if self.mode == "torque":
            return self.ratio * self.command.value(t, side)
        if self.mode == "open":
            return 0.0
        voltage = self.command.value(t, side) if self.mode == "voltage" else 0.0
        return self.ratio * self.constant * (voltage - self.constant * self.ratio * y[1]) / self.resistance

    def load(self, t, side, y):
        return (self.torque.value(t, side) - self.spring * (y[2] - self.rest)
                - self.weight * math.sin(y[2] - self.hanging))

    def sides(self, t, side, y, sense, resting=False):
        """What is left for inertia and mesh on either side."""
        c1, c2 = (self.c1_rest, self.c2_rest) if resting else (self.c1, self.c2)
        return (self.motor(t, side, y) - self.d1 * y[1] - c1 * sense,
                self.load(t, side, y) - self.d2 * y[3] - c2 * sense)

    def lead(self, fast, output):
        return self.j2 * fast - self.j1 * output

    def starts(self, t, side, y, sense):
        """Above zero where the output leaves rest in a sense."""
        excess = []
        for resting in (True, False):
            fast, output = self.sides(t, side, y, sense, resting)
            mesh = -output
            needed = mesh / self.forward if sense * mesh > 0 else self.backward * mesh
            excess.append(sense * (fast - needed))
        return min(excess)

    def alone(self, t, side, y):
        """Senses in which both sides would leave rest by themselves, and their accelerations."""
        motor, load = self.motor(t, side, y), self.load(t, side, y)
        s1 = int(motor > self.c1_rest) - int(motor < -self.c1_rest)
        s2 = int(load > self.c2_rest) - int(load < -self.c2_rest)
        return s1, s2, (motor - s1 * self.c1) / self.j1 if s1 else 0.0, (load - s2 * self.c2) / self.j2 if s2 else 0.0

    def parts(self, t, side, y, contact):
        """Above zero where sides at rest in contact come apart."""
        s1, s2, a1, a2 = self.alone(t, side, y)
        if not (s1 or s2) or (s1 == s2 and s1 * contact < 0 and self.starts(t, side, y, s1) < 0):
            return -1.0
        return contact * (a2 - a1)

    def slopes(self, t, side, y, mode):
        d = numpy.zeros(4)
        d[0], d[2] = y[1], y[3]
        if mode[0] == "slide":
            fast, output = self.sides(t, side, y, mode[1])
            d[1] = d[3] = ((self.forward * fast + output) / (self.forward * self.j1 + self.j2) if mode[2] > 0
                           else (fast + self.backward * output) / (self.j1 + self.backward * self.j2))
        elif mode[0] == "gap":
            if mode[1]:
                d[1] = self.sides(t, side, y, mode[1])[0] / self.j1
            if mode[2]:
                d[3] = self.sides(t, side, y, mode[2])[1] / self.j2
        else:
            d[:] = 0.0
        return d


class Run:
    """Modes ("rest", contact), ("slide", sense, flow, contact), ("gap", sense, sense)."""

    def __init__(self, drive, scenario):
        start = scenario.get("start", {})
        self.drive, self.duration, self.events = drive, scenario["duration_s"], []
        speed, angle = start.get("output_speed_rad_s", 0.0), start.get("output_angle_rad", 0.0)
        self.t, self.y = 0.0, numpy.array([angle + drive.half_gap * start.get("gap_position", 0.0), speed, angle, speed])
        s = int(numpy.sign(speed))
        self.mode = ("gap", s, s) if drive.half_gap else ("slide", s, 0, 0) if s else ("rest", 0)

    def tell(self, what):
        self.events.append((self.t, what))

    def settle(self):
        for _ in range(20):
            before = self.mode
            getattr(self, "settle_" + self.mode[0])()
            if self.mode == before:
                return
        raise RuntimeError(f"no mode at {self.t}")

    def settle_rest(self):
        drive, contact = self.drive, self.mode[1]
        for sense in (1, -1):
            if drive.starts(self.t, 1, self.y, sense) > 0:
                if contact and contact * drive.lead(*drive.sides(self.t, 1, self.y, sense, True)) < 0:
                    continue
                self.tell("starts")
                self.mode = ("slide", sense, sense * contact, contact)
                return
        if contact and drive.parts(self.t, 1, self.y, contact) > 0:
            self.tell("separates")
            self.mode = ("gap", *drive.alone(self.t, 1, self.y)[:2])

    def settle_slide(self):
        drive, (_, sense, flow, contact) = self.drive, self.mode
        fast, output = drive.sides(self.t, 1, self.y, sense)
        lead, hidden = sense * drive.lead(fast, output), 1e-11 * (drive.j2 * abs(fast) + drive.j1 * abs(output))
        if contact and sense * contact * lead < -hidden:
            self.tell("separates")
            self.mode = ("gap", sense, sense)
        elif flow == 0:
            self.mode = ("slide", sense, 1 if lead >= 0 else -1, 0)
        elif not contact and flow * lead < -hidden:
            self.tell("flow_backward" if flow > 0 else "flow_forward")
            self.mode = ("slide", sense, -flow, 0)

    def settle_gap(self):
        drive, y = self.drive, self.y
        s1, s2, _, _ = drive.alone(self.t, 1, y)
        senses = [int(numpy.sign(w)) or kept or new for w, kept, new in ((y[1], self.mode[1], s1), (y[3], self.mode[2], s2))]
        self.mode = ("gap", *senses)
        if abs(y[0] - y[2]) < drive.half_gap * (1 - 1e-12) - 1e-15:
            return
        contact = 1 if y[0] > y[2] else -1
        closing = contact * (y[1] - y[3])
        if closing < 0:
            return
        if closing == 0:
            d = drive.slopes(self.t, 1, y, self.mode)
            if not contact * (d[1] - d[3]) > 1e-9 * (abs(d[1]) + abs(d[3])):
                return
            together = senses[0] and senses[0] == senses[1]
            self.mode = ("slide", senses[0], senses[0] * contact, contact) if together else ("rest", contact)
        else:
            ahead = 1 if y[1] > y[3] else -1
            given = (drive.forward * drive.j1 * y[1] + drive.j2 * y[3]) / (drive.forward * drive.j1 + drive.j2)
            taken = (drive.j1 * y[1] + drive.backward * drive.j2 * y[3]) / (drive.j1 + drive.backward * drive.j2)
            w = given if given * ahead > 0 else taken if taken * ahead < 0 else 0.0
            y[1] = y[3] = w
            sense = int(numpy.sign(w))
            self.mode = ("slide", sense, sense * contact, contact) if sense else ("rest", contact)
        self.tell("contact")

    def watched(self, side):
        """(name, function) of everything that ends the mode where it is no longer above zero."""
        drive, mode = self.drive, self.mode
        if mode[0] == "rest":
            def held(sense):
                def value(t, y):
                    v = drive.starts(t, side(t), y, sense)
                    if mode[1] and v > 0 and mode[1] * drive.lead(*drive.sides(t, side(t), y, sense, True)) < 0:
                        return v
                    return -v
                return value
            parts = [("parts", lambda t, y: -drive.parts(t, side(t), y, mode[1]))] if mode[1] else []
            return [("starts 1", held(1)), ("starts -1", held(-1)), *parts]
        if mode[0] == "slide":
            def flows(t, y):
                fast, output = drive.sides(t, side(t), y, mode[1])
                return mode[2] * mode[1] * drive.lead(fast, output) + 1e-13 * (drive.j2 * abs(fast) + drive.j1 * abs(output))
            return [("stops", lambda t, y: mode[1] * y[3] + STOPPED), ("flow", flows)]
        room = drive.half_gap * (1 + 1e-13)
        found = [("ahead", lambda t, y: room - (y[0] - y[2])), ("behind", lambda t, y: room + (y[0] - y[2]))]
        for k, place in ((1, 1), (2, 3)):
            if mode[k]:
                found.append((f"ends {k}", lambda t, y, k=k, place=place: mode[k] * y[place] + STOPPED))
            else:
                rest = drive.c1_rest if k == 1 else drive.c2_rest
                force = drive.motor if k == 1 else drive.load
                found.append((f"begins {k}", lambda t, y, rest=rest, force=force: rest - abs(force(t, side(t), y))))
        return found

    def happen(self, name, side):
        """What has ended; the next mode follows."""
        drive, y, mode, told = self.drive, self.y, self.mode, len(self.events)
        if name == "stops":
            y[1] = y[3] = 0.0
            self.mode = ("rest", mode[3])
            self.settle()
            if self.events[told:] == [(self.t, "starts")]:
                self.events[told:] = [(self.t, "reverses")]
            elif self.events[told:told + 1] != [(self.t, "separates")]:
                self.events.insert(told, (self.t, "stops"))
        elif name == "flow":
            if mode[3]:
                self.tell("separates")
                self.mode = ("gap", mode[1], mode[1])
            else:
                self.tell("flow_backward" if mode[2] > 0 else "flow_forward")
                self.mode = ("slide", mode[1], -mode[2], 0)
            self.settle()
        elif name.startswith("starts"):
            sense = int(name.split()[1])
            self.tell("starts")
            self.mode = ("slide", sense, sense * mode[1], mode[1])
            self.settle()
        elif name == "parts":
            self.tell("separates")
            self.mode = ("gap", *drive.alone(self.t + 1e-13, side, y)[:2])
            self.settle()
        elif name in ("ahead", "behind"):
            y[0] = y[2] + drive.half_gap * (1 if name == "ahead" else -1)
            self.settle()
        else:
            what, k = name.split()[0], int(name.split()[1])
            names = {1: "motor_side", 2: "output"}
            if what == "ends":
                y[1 if k == 1 else 3] = 0.0
                self.mode = ("gap", 0, mode[2]) if k == 1 else ("gap", mode[1], 0)
                self.settle()
                if self.mode[0] == "gap":
                    self.events.insert(told, (self.t, names[k] + ("_reverses" if self.mode[k] else "_stops")))
            else:
                sense = int(numpy.sign((drive.motor if k == 1 else drive.load)(self.t, side, y)))
                self.tell(names[k] + "_starts")
                self.mode = ("gap", sense, mode[2]) if k == 1 else ("gap", mode[1], sense)
                self.settle()

    def until(self, limit):
        """Up to the next event or row of a table."""
        begin, mode = self.t, self.mode

        def side(t):
            return 1 if t < 0.5 * (begin + limit) else -1

        def slopes(t, y):
            return self.drive.slopes(t, side(t), y, mode)
        watched = self.watched(side)
        longest = LONGEST_AT_REST if mode[0] == "rest" else LONGEST_STEP
        solver = DOP853(slopes, self.t, self.y.copy(), limit, max_step=longest, rtol=RELATIVE, atol=ABSOLUTE)
        while solver.status == "running":
            first = solver.y.copy()
            solver.step()
            between, low, high = solver.dense_output(), solver.t_old, solver.t
            before = low
            for k in range(1, POINTS + 1):
                at = high if k == POINTS else low + (high - low) * k / POINTS
                y = solver.y if k == POINTS else between(at)
                ends = []
                for name, value in watched:
                    if value(at, y) > 0:
                        continue

                    def signed(t, value=value):
                        v = value(t, between(t))
                        return v if v > 0 else min(v, -1e-300)
                    place = before if not signed(before) > 0 else brentq(signed, before, at, xtol=1e-16, rtol=9e-16)
                    ends.append((place, name))
                if ends:
                    place, name = min(ends)
                    self.y = first if place == low else between(place)
                    if place > low:  # a step of its own to that place
                        last = DOP853(slopes, low, first, place, rtol=RELATIVE, atol=ABSOLUTE)
                        while last.status == "running":
                            last.step()
                        self.y = last.y.copy()
                    self.t = place
                    self.happen(name, side(place))
                    return
                before = at
        self.t, self.y = limit, solver.y.copy()

    def run(self):
        rows = {t for s in (self.drive.command, self.drive.torque) for t, _ in s.rows if 0 < t < self.duration}
        self.enter()
        for limit in sorted(rows | {self.duration}):
            while self.t < limit:
                self.until(limit)
            if limit < self.duration:
                self.enter()

    def enter(self):
        """What begins with the run, or at a row of a table."""
        before = self.mode
        self.settle()
        if before[0] == self.mode[0] == "gap":
            for k, name in ((1, "motor_side"), (2, "output")):
                if not before[k] and self.mode[k]:
                    self.tell(name + "_starts")


def main():
    with open(sys.argv[1], "rb") as file:
        actuator = tomllib.load(file)
    with open(sys.argv[2], "rb") as file:
        scenario = tomllib.load(file)
    run = Run(Drive(actuator, scenario, os.path.dirname(sys.argv[2])), scenario)
    run.run()
    print("time_s,event")
    for t, what in run.events:
        print(f"{t:.14g},{what}")
    print(f"{run.t:.14g},end")
    print(f"# output_angle_rad: {run.y[2]:.14g}\n# output_speed_rad_s: {run.y[3]:.14g}")


if __name__ == "__main__":
    main()
