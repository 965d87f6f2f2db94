#!/usr/bin/env python3
"""Searches for scenes whose times have the means and spreads of the paper's Table II, for docs/validation/paper.md.

`scan.py STOCHC FOLDER` runs all stages and prints a table. It takes about 40 minutes on one core.
`scan.py STOCHC FOLDER RUNS` only compares the candidates below with `hemisphere`.
FOLDER stores every measurement in `rows.jsonl`. The same command resumes an interrupted scan.

1. `line`: scenes of four families, spread evenly over the ranges below (Latin hypercube), on the program `line`.
2. `clock`: the best of each family, slowed down or sped up to the paper's mean, on the three programs of Table II.
3. `near`: random changes of the best of each family, on the three programs.
4. `again`: the best two of each family, with other seeds.
5. `fresh`: the best of all and the best sampled one on all five programs, with seeds of their own, next to `hemisphere`.
Table I (`five_tower`, `five_tower_reconfigured`) takes no part in the choice.
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
PAPER = {
    "line": (8097, 1158), "open_platform": (7340, 1126), "closed_platform": (6218, 1046),
    "five_tower": (6611, 2879), "five_tower_reconfigured": (5158, 1061),
}
PAPER_RUNS = 50
TABLE_II = ["line", "open_platform", "closed_platform"]
# Ranges of the scan. `grip` is the work of the pull over its reach against the energy of motion: below about 1.2 nothing
# is captured. `aligning` is the force on a corner over the pull. The speed of the blocks is that of `hemisphere`, 0.187
# block lengths a tick, because the clock is changed later.
RANGES = {
    "grip": (1.2, 2.4), "drag": (0.3, 1.3), "stiffness": (250, 1000), "damping": (8, 40), "friction": (0.1, 1.0),
    "aligning": (0.02, 0.3), "window": (0.1, 1.0),
}
SPEED = 0.187
# Power of time in the unit of each parameter: a scene that is `s` times slower has it times `s ** power`. Kicks fall once
# a tick, whatever the clock; v ~ 1 / s and v ~ j / sqrt(drag) give their power.
POWER = {"speed": -1.5, "drag": -1, "stiffness": -2, "damping": -1, "pull": -2, "align": -2}
FAMILIES = {
    "centres": "anchor centres {window:.4g}mm tilt 26 deg", "centres sampled": "anchor centres 1mm tilt 26 deg sampled",
    "corners": "anchor corners 1mm tilt 26 deg", "corners sampled": "anchor corners 1mm tilt 26 deg sampled",
}
SCENES = {"centres": 24, "centres sampled": 30, "corners": 30, "corners sampled": 16}
FRESH_RUNS = 100
SEED = 71
# The scenes of the table in docs/validation/paper.md: the best of each family.
CANDIDATES = {
    "centres": {"speed": 0.881, "drag": 0.9162, "stiffness": 1011, "damping": 31.92, "friction": 0.7, "pull": 25.99, "align": 1.041, "window": 0.146},
    "centres sampled": {"speed": 0.3284, "drag": 0.4745, "stiffness": 271.2, "damping": 16.53, "friction": 0.7, "pull": 6.97, "align": 0.2793},
    "corners": {"speed": 0.362, "drag": 0.3103, "stiffness": 955.1, "damping": 8.409, "friction": 0.1706, "pull": 20.01, "align": 1.536},
}
SCENE = """scene spreads from hemisphere {{
    agitation kicks {{ speed 0 .. {speed:.4g} m/s }}
    drag {{ rate {drag:.4g} Hz }}
    contact {{ stiffness {stiffness:.4g} N/m  damping {damping:.4g} N s/m  friction {friction:.4g} }}
    bond attract {{
        pull {pull:.4g} N within 20cm
        align {align:.4g} N within 10cm
        {anchor}
    }}
}}
"""


def scene_text(family, numbers):
    return SCENE.format(anchor=FAMILIES[family].format(**numbers), **numbers)


def simulate(stochc, scene, programs, runs, seed, max_ticks):
    """Returns the records of each program in a scene. The scene `None` is `hemisphere`."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name in programs:
            text = (EXAMPLES / f"{name}.sa").read_text()
            if scene:
                text = text.replace(f"assembly {name} {{", f"assembly {name} in spreads {{") + "\n" + scene
            (folder / f"{name}.sa").write_text(text)
        out = folder / "out"
        # The exit status is not 0 if runs time out.
        subprocess.run(
            [stochc, "simulate", *(folder / f"{name}.sa" for name in programs), "--runs", str(runs), "--seed", str(seed),
             "--threads", "1", "--max-ticks", str(max_ticks), "--out", out, "-q"],
            capture_output=True)
        records = [[] for _ in programs]
        for line in (out / "journal.jsonl").read_text().splitlines()[1:]:
            line = json.loads(line)
            records[line["program"]].append(line["record"])
        return records


def variance(values):
    mean = sum(values) / len(values)
    return sum((x - mean) ** 2 for x in values) / (len(values) - 1)


def summary(records):
    """Returns mean and spread of completed runs, and the spread of a sum of independent waiting times."""
    done = [r for r in records if r["outcome"]["kind"] == "completed"]
    row = {"runs": len(records), "completed": len(done)}
    if len(done) > 1:
        ticks = [r["ticks"] for r in done]
        waits = zip(*([b["docked"] - b["magnetized"] for b in r["bonds"]] for r in done))
        row |= {"mean": sum(ticks) / len(ticks), "sd": variance(ticks) ** 0.5, "min": min(ticks), "max": max(ticks),
                "chain_sd": sum(variance(w) for w in waits) ** 0.5}
    return row


class Scan:
    def __init__(self, stochc, folder):
        self.stochc, self.file = stochc, folder / "rows.jsonl"
        folder.mkdir(parents=True, exist_ok=True)
        lines = self.file.read_text().splitlines() if self.file.exists() else []
        self.rows = {row["key"]: row for row in map(json.loads, lines)}

    def measure(self, key, family, numbers, programs, runs, seed, max_ticks=24_000, probe=True):
        """Measures a scene once. Abandons a scene whose first line does not complete."""
        if key in self.rows:
            return self.rows[key]
        scene = scene_text(family, numbers) if family != "hemisphere" else None
        times = None
        if probe:
            times = {"line": summary(simulate(self.stochc, scene, ["line"], 1, seed, max_ticks)[0])}
        if not probe or times["line"]["completed"]:
            records = simulate(self.stochc, scene, programs, runs, seed, max_ticks)
            times = {name: summary(r) for name, r in zip(programs, records)}
        row = {"key": key, "family": family, "numbers": numbers, "times": times}
        self.rows[key] = row
        with self.file.open("a") as file:
            file.write(json.dumps(row) + "\n")
        return row

    def of(self, stage, family):
        """Returns the rows of a stage whose runs all completed."""
        rows = [r for k, r in self.rows.items() if k.startswith(f"{stage}/{family}/")]
        return [r for r in rows if all(t["completed"] == t["runs"] > 1 for t in r["times"].values())]


def relative_spread(row):
    line = row["times"]["line"]
    return line["chain_sd"] / line["mean"]


def misfit(row):
    """Returns the squared deviations of means and spreads from Table II, in standard errors of both."""
    total = 0
    for name in TABLE_II:
        ours, (mean, sd) = row["times"][name], PAPER[name]
        n = ours["runs"]
        error = sd * sd / mean**2 / PAPER_RUNS + ours["chain_sd"] ** 2 / ours["mean"] ** 2 / n
        total += math.log(ours["mean"] / mean) ** 2 / error
        freedom = 13 * (n - 1)
        total += math.log(ours["chain_sd"] / sd) ** 2 / (0.5 / (PAPER_RUNS - 1) + 0.5 / freedom)
    return total


def slower(numbers, factor):
    return {name: value * factor ** POWER.get(name, 0) for name, value in numbers.items()}


def hypercube(family, count):
    """Returns scenes of a Latin hypercube, in logarithms."""
    chance = random.Random(f"line {family}")
    columns = {}
    for name, (low, high) in RANGES.items():
        places = [(i + chance.random()) / count for i in range(count)]
        chance.shuffle(places)
        columns[name] = [low * (high / low) ** p for p in places]
    scenes = []
    for i in range(count):
        numbers = {name: column[i] for name, column in columns.items()}
        # 20 ms, 20 cm and 1 kg are the units of a tick, a block length and a mass.
        numbers["pull"] = numbers.pop("grip") * SPEED**2 / 2 * 0.2 / 0.02**2
        numbers["align"] = numbers.pop("aligning") * numbers["pull"]
        numbers["speed"] = SPEED * (3 * (math.exp(2 * numbers["drag"] * 0.02) - 1)) ** 0.5 * 0.2 / 0.02
        scenes.append(numbers)
    return scenes


def stage_line(scan):
    points = {family: hypercube(family, count) for family, count in SCENES.items()}
    for i in range(max(SCENES.values())):
        for family in FAMILIES:
            if i < SCENES[family]:
                scan.measure(f"line/{family}/{i}", family, points[family][i], ["line"], 4, 1000 + i)


def stage_clock(scan, family):
    """Changes the clock of the best scenes of stage `line` until their mean equals the paper's."""
    starts = [CANDIDATES[family]] if family in CANDIDATES else []
    for row in sorted(scan.of("line", family), key=relative_spread)[:3]:
        starts.append(slower(row["numbers"], PAPER["line"][0] / row["times"]["line"]["mean"]))
    for i, numbers in enumerate(starts):
        for attempt in range(2):
            row = scan.measure(f"clock/{family}/{i}/{attempt}", family, numbers, TABLE_II, 8, 2000 + i)
            line = row["times"]["line"]
            if line["completed"] < line["runs"] or line["runs"] == 1:
                break
            numbers = slower(numbers, PAPER["line"][0] / line["mean"])


def stage_near(scan, family):
    """Makes two rounds of random changes of the best four scenes, by a fifth and by a tenth."""
    for generation, width in enumerate((0.2, 0.1)):
        found = scan.of("clock", family) + [r for g in range(generation) for r in scan.of(f"near{g}", family)]
        parents = sorted(found, key=misfit)[:4]
        for i in range(8 if parents else 0):
            chance = random.Random(f"near {family} {generation} {i}")
            parent = parents[i % len(parents)]
            numbers = slower(parent["numbers"], PAPER["line"][0] / parent["times"]["line"]["mean"])
            numbers = {name: value * math.exp(chance.gauss(0, width)) for name, value in numbers.items()}
            scan.measure(f"near{generation}/{family}/{i}", family, numbers, TABLE_II, 8, 3000 + 100 * generation + i)


def stage_again(scan, family):
    """Measures the best two scenes again, with new seeds."""
    found = scan.of("clock", family) + scan.of("near0", family) + scan.of("near1", family)
    for i, row in enumerate(sorted(found, key=misfit)[:2]):
        scan.measure(f"again/{family}/{i}", family, row["numbers"], TABLE_II, 24, 4000 + i, probe=False)


def stage_fresh(scan):
    """Measures the best scene, the best sampled scene and `hemisphere` on all programs, with the same new seeds."""
    best = {family: min(rows, key=misfit) for family in FAMILIES if (rows := scan.of("again", family))}
    first = min(best.values(), key=misfit)
    sampled = min((row for family, row in best.items() if "sampled" in family), key=misfit)
    for row in (first, {"family": "hemisphere", "numbers": {}}, sampled):
        scan.measure(f"fresh/{row['family']}/0", row["family"], row["numbers"], list(PAPER), FRESH_RUNS, SEED, probe=False)


def print_table(rows):
    """Prints means and spreads next to the values of the paper, and the probability of a larger chi-square."""
    for row in rows:
        print(f"\n{row['family']}")
        if row["numbers"]:
            print(scene_text(row["family"], row["numbers"]))
        print(f"{'program':<24}{'runs':>5}{'mean':>8}{'+-':>6}{'paper':>7}{'SD':>7}{'paper':>7}{'F':>7}{'z mean':>8}{'z SD':>7}")
        sums = {}
        for name, (mean, sd) in PAPER.items():
            t = row["times"][name]
            n = t["completed"]
            z_mean = (t["mean"] - mean) / math.hypot(t["sd"] / n**0.5, sd / PAPER_RUNS**0.5)
            z_sd = math.log(t["sd"] / sd) / math.sqrt(0.5 / (n - 1) + 0.5 / (PAPER_RUNS - 1))
            half = "Table II" if name in TABLE_II else "Table I"
            sums.setdefault((half, "means"), []).append(z_mean**2)
            sums.setdefault((half, "spreads"), []).append(z_sd**2)
            print(f"{name:<24}{n:>5}{t['mean']:>8.0f}{1.96 * t['sd'] / n**0.5:>6.0f}{mean:>7}{t['sd']:>7.0f}{sd:>7}"
                  f"{t['sd'] ** 2 / sd**2:>7.2f}{z_mean:>8.2f}{z_sd:>7.2f}")
        for (half, kind), squares in sums.items():
            total = sum(squares)
            print(f"{half}, {kind}: chi-square {total:.1f} of {len(squares)}, p = {chi_square_p(total, len(squares)):.2g}")


def chi_square_p(value, freedom):
    """Returns the probability of a larger chi-square with 2 or 3 degrees of freedom."""
    if freedom == 2:
        return math.exp(-value / 2)
    return math.erfc(math.sqrt(value / 2)) + math.sqrt(2 * value / math.pi) * math.exp(-value / 2)


def main():
    stochc, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    scan = Scan(stochc, folder)
    if len(sys.argv) > 3:
        compare(scan, int(sys.argv[3]))
        return
    stage_line(scan)
    for stage in (stage_clock, stage_near, stage_again):
        for family in FAMILIES:
            stage(scan, family)
    stage_fresh(scan)
    print_table([row for key, row in scan.rows.items() if key.startswith("fresh/")])


def compare(scan, runs):
    """Measures the candidates and `hemisphere` on all programs, with the same seeds."""
    scenes = CANDIDATES | {"hemisphere": {}}
    print_table([scan.measure(f"compare {runs}/{family}", family, numbers, list(PAPER), runs, SEED, 60_000, probe=False)
                 for family, numbers in scenes.items()])


main()
