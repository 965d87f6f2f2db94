#!/usr/bin/env python3
"""Compares Storm's probabilities for chains of `stochc compile --emit jani` with integrals and runs.

Usage: storm.py STOCHC [RUNS] (needs stormpy and numpy). Prints two tables. Exits with status 1 if a
difference from an integral exceeds 1e-6, or a difference from RUNS runs (400,000) four standard
errors.

The integrals do not use the counters of docking blocks. A face that has been open for s ticks
captures at the rate k G(s/d), where k and d are read from the chain. Captures one after the other:
the density of a sum of waiting times is computed by convolution on two grids, and extrapolated to
the limit of a fine grid. Faces that open together: all have the same age. The probabilities of the
states are integrated over this age (Runge-Kutta method of order 4).

Runs capture at the end of a tick. Therefore, Storm's time is (n - 1) / 2 ticks shorter, where n is
the number of captures on the critical path.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy
import stormpy

BOUND = 1e-6
SEED = "seed plate 3 x 3 { M at (1, 1) }"
SERIAL = {
    "one": "phase p { M.up -> A }",
    "two": "phase p { M.up ->> A[1..2] }",
    "three": "phase p { M.up ->> A[1..3] }",
    "four": "phase p { M.up ->> A[1..4] }",
    "six": "phase p { M.up ->> A[1..6] }",
    "ten": "phase p { M.up ->> A[1..10] }",
    "arm": "phase p { M.up ->> A[1..3] } phase q { A[3].east ->> B[1..2] }",
    "hook": "phase p { M.up ->> A[1..3] } phase q { A[3].east -> B  B.east -> C  C.down -> D }",
    "stairs": "phase p { M.up -> A  A.up -> B  B.east -> C  C.up -> D  D.east -> E }",
    "cross": "phase p { M.up ->> A[1..2] } phase q { A[2].east -> B } phase r { A[2].west -> C }",
}
PLATE = "seed plate 9 x 9 { M at (1, 1)  N at (%d, %d) }"
MAST = "seed plate 3 x 3 { M at (1, 1)  M.up ->> A[1..2]  A[2].up -> T }"
# Faces per block, body, captures on the critical path, and an approximate mean completion time.
PARALLEL = {
    "apart": (1, PLATE % (7, 7) + "phase p { M.up -> A  N.up -> B }", 1, 1000),
    "adjacent": (1, PLATE % (2, 1) + "phase p { M.up -> A  N.up -> B }", 1, 1000),
    "corner": (2, MAST + "phase p { T.up -> B  T.east -> C }", 1, 1000),
    "star": (3, MAST + "phase p { T.north -> B  T.east -> C  T.up -> D }", 1, 1000),
    "turns": (2, MAST + "phase p { T.up -> B  T.east -> C  T.west -> D  C.north -> E }", 2, 1200),
    "towers": (
        1,
        PLATE % (4, 1)
        + "phase p { M.up ->> A[1..2]  N.up ->> B[1..2] } phase q { A[2].east -> C }",
        3,
        2000,
    ),
    "order": (
        1,
        PLATE % (7, 7) + "phase p { M.up -> A  N.up -> B  A.up -> C  B.up -> D after A }",
        2,
        1400,
    ),
    "corners": (1, PLATE % (2, 2) + "phase p { M.up -> A  N.up -> B  A.up -> C }", 2, 1400),
}


def exported(stochc, folder, name, body, faces=1):
    """Returns the chain of a program, and stormpy's model of it."""
    source = pathlib.Path(folder, f"{name}.sa")
    scene = f"scene many from hemisphere {{ block cube {{ side 20cm  mass 1kg  faces {faces} }} }}"
    source.write_text(f"{scene} assembly {name} in many {{ {body} }}")
    target = source.with_suffix(".jani")
    command = [stochc, "compile", str(source), "--emit", "jani", "--out", str(target)]
    subprocess.run(command, check=True)
    return json.loads(target.read_text()), stormpy.parse_jani_model(str(target))[0]


def completion(model, captures, times):
    """Returns the number of states and the probabilities of completion within times."""
    built, probabilities = None, {}
    for time in set(times):
        text = f"P=? [F<={time} captures={captures}]"
        formula = stormpy.parse_property(text, model)
        built = built or stormpy.build_model(model, formula)
        environment = stormpy.environments.sound()
        values = stormpy.model_checking(built, formula, environment=environment)
        probabilities[time] = values.get_value(built.initial_states[0])
    return built.nr_states, [probabilities[time] for time in times]


def hazard(rate, docking, age):
    x = 2 * age / docking
    return rate * -numpy.expm1(-x + numpy.log1p(x))


def waits(chain):
    """Returns the rate of arrivals and the mean docking time of captures one after the other."""
    edges = chain["automata"][0]["edges"]
    for arrival, stage in zip(edges[0::3], edges[1::3]):
        yield arrival["rate"]["exp"], 2 / stage["rate"]["exp"]["right"]


def integral(waits, time, steps):
    """Returns P(sum <= time) by the trapezoidal rule."""
    s = numpy.linspace(0, time, steps + 1)
    step = time / steps
    total = None
    for rate, docking in waits:
        x = 2 * s / docking
        survival = numpy.exp(-rate * docking / 2 * (x - 2 + numpy.exp(-x) * (x + 2)))
        if total is None:
            total = 1 - survival
            continue
        density = hazard(rate, docking, s) * survival
        length = 2 * len(s)
        product = numpy.fft.irfft(
            numpy.fft.rfft(total, length) * numpy.fft.rfft(density, length), length
        )[: len(s)]
        # The first and the last term of each sum count half. The first value of both is 0.
        total = step * product
    return total[-1]


def extrapolated(waits, time):
    coarse, fine = (integral(waits, time, steps) for steps in (1 << 15, 1 << 16))
    return fine + (fine - coarse) / 3


def captures_of(chain):
    """Returns the rate, the mean docking time and both states of each capture."""
    arrivals = {}
    for edge in chain["automata"][0]["edges"]:
        before, after = int(edge["location"]), int(edge["destinations"][0]["location"])
        rate = edge["rate"]["exp"]
        if isinstance(rate, float):
            last = rate
        elif rate["left"].startswith("first"):
            arrivals[rate["left"].replace("first", "second")] = last, rate["right"]
        elif before != after:
            total, stage = arrivals[rate["left"]]
            yield total * rate["right"] / stage, 2 / stage, before, after


def integral_of_ages(captures, time, steps=4000):
    """Returns the probability of completion if all faces are open since tick 0."""
    rate, docking, before, after = map(numpy.array, zip(*captures))
    count = after.max() + 1

    def slope(age, probability):
        flow = hazard(rate, docking, age) * probability[before]
        return numpy.bincount(after, flow, count) - numpy.bincount(before, flow, count)

    probability = numpy.zeros(count)
    probability[0] = 1
    step = time / steps
    for number in range(steps):
        age = number * step
        one = slope(age, probability)
        two = slope(age + step / 2, probability + step / 2 * one)
        three = slope(age + step / 2, probability + step / 2 * two)
        four = slope(age + step, probability + step * three)
        probability = probability + step / 6 * (one + 2 * two + 2 * three + four)
    return probability[-1]


def simulated(stochc, folder, name, runs):
    """Returns the completion times of runs of the rate model."""
    source, out = pathlib.Path(folder, f"{name}.sa"), pathlib.Path(folder, name)
    command = [stochc, "simulate", str(source), "--model", "rate", "--runs", str(runs)]
    subprocess.run(
        [*command, "--seed", "64", "--out", str(out)], check=True, capture_output=True
    )
    with open(out / "journal.jsonl") as lines:
        next(lines)
        return numpy.array([json.loads(line)["record"]["ticks"] for line in lines])


def compare_serial(stochc, folder):
    """Returns the largest difference for captures one after the other."""
    print("| program | captures | states | time | Storm | integral | difference |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    largest = 0
    for name, phases in SERIAL.items():
        chain, model = exported(stochc, folder, name, f"{SEED} {phases}")
        pairs = list(waits(chain))
        times = [round(factor * 600 * len(pairs)) for factor in (0.5, 1, 2)]
        states, probabilities = completion(model, len(pairs), times)
        for time, storm in zip(times, probabilities):
            known = extrapolated(pairs, time)
            largest = max(largest, abs(storm - known))
            print(
                f"| {name} | {len(pairs)} | {states} | {time} | {storm:.8f} "
                f"| {known:.8f} | {storm - known:+.1e} |"
            )
    return largest


def compare_parallel(stochc, folder, runs):
    """Returns the largest difference from integrals, and the largest one from runs in standard
    errors.
    """
    print("\n| program | captures | states | time | Storm | difference from integral | Storm, shorter time | runs |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    largest, worst = 0, 0
    for name, (faces, body, path, mean) in PARALLEL.items():
        chain, model = exported(stochc, folder, name, body, faces)
        captures = chain["variables"][0]["type"]["upper-bound"]
        known = list(captures_of(chain))
        is_together = sum(before == 0 for *_, before, _ in known) == captures
        ticks = simulated(stochc, folder, name, runs)
        times = [round(factor * mean) for factor in (0.5, 1, 2)]
        shorter = [time - (path - 1) / 2 for time in times]
        states, probabilities = completion(model, captures, times + shorter)
        for time, storm, short in zip(times, probabilities[:3], probabilities[3:]):
            difference = ""
            if is_together:
                difference = storm - integral_of_ages(known, time)
                largest = max(largest, abs(difference))
                difference = f"{difference:+.1e}"
            frequency = (ticks <= time).mean()
            error = math.sqrt(short * (1 - short) / runs)
            worst = max(worst, abs(frequency - short) / error)
            print(
                f"| {name} | {captures} | {states} | {time} | {storm:.8f} | {difference} "
                f"| {short:.5f} | {frequency:.5f} ± {1.96 * error:.5f} |",
                flush=True,
            )
    return largest, worst


def main():
    stochc = sys.argv[1]
    runs = int(sys.argv[2]) if len(sys.argv) > 2 else 400_000
    with tempfile.TemporaryDirectory() as folder:
        serial = compare_serial(stochc, folder)
        parallel, worst = compare_parallel(stochc, folder, runs)
    print(f"\nlargest difference from an integral: {max(serial, parallel):.1e}")
    print(f"largest difference from runs: {worst:.1f} standard errors")
    return int(max(serial, parallel) > BOUND or worst > 4)


if __name__ == "__main__":
    sys.exit(main())
