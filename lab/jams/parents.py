#!/usr/bin/env python3
"""Measures what a capture by one of two possible parents would gain.

`parents.py STOCHC FOLDER [RUNS]` makes RUNS runs (200) of each case with the model `rigid` in the default scene. A program
captures X from one parent, Y from another parent, or both. In the executable, the script turns the face of Y towards the cell
of X. A row lists the time until the first of the open faces has captured a block. Runs are stopped after 2,000 ticks and count
with that time. Existing runs of the folder are not repeated.

The second table lists examples. A capture counts if a second block stands next to its cell in every order, and not opposite
the parent. `share` is the part of the completion time spent waiting for these captures. If their waiting times were half as
long, the program would complete earlier by at most half of this share.
"""
import json
import math
import pathlib
import subprocess
import sys

# Description, second tower, its capture in the source, and the face that this capture has in the executable.
PLACES = {
    "opposite": ("opposite faces of two towers", "B.up ->> U[1..3]", "U[3].east -> Y", "west"),
    "corner": ("faces of two towers at a right angle", "S.up ->> U[1..3]", "U[3].south -> Y", "north"),
    "step": ("a face of a tower, and the top of a lower tower", "M.up ->> U[1..2]", "U[2].east -> Y", "up"),
}
FIRST, CELL = "T[3].east -> X", [1, 1, 3]
SEEDS = {"A": (0, 1), "B": (2, 1), "M": (1, 1), "S": (1, 0)}
SEED, MAX_TICKS = 6301, 2000
EXAMPLES = (
    "gate bridge windmill closed_platform open_platform five_tower planned/chair planned/five_towers planned/serpentine".split()
)
FACES = {"east": (1, 0, 0), "west": (-1, 0, 0), "north": (0, 1, 0), "south": (0, -1, 0), "up": (0, 0, 1), "down": (0, 0, -1)}


def command(*words):
    """Returns the output of a command. A stopped run is no error."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    return done.stdout


def first_captures(stochc, folder, place, case, runs):
    """Makes the runs of one case. Returns their times to the first capture in the cell."""
    _, tower, second, face = PLACES[place]
    name = f"{place}_{case}"
    out, source, program = folder / name, folder / f"{name}.sa", folder / f"{name}.json"
    if not out.exists():
        captures = {"first": FIRST, "second": second, "either": f"{FIRST}   {second}"}[case]
        seeds = "   ".join(f"{seed} at {at}" for seed, at in SEEDS.items() if seed == "A" or f"{seed}.up" in tower)
        source.write_text(
            f"assembly {name} {{\n    seed plate 3 x 3 {{ {seeds} }}\n    phase before {{ A.up ->> T[1..3]   {tower} }}\n"
            f"    phase into timeout {MAX_TICKS} ticks {{ {captures} }}\n}}\n"
        )
        program.unlink(missing_ok=True)
        command(stochc, "compile", source, "--emit", "executable", "--out", program)
        executable = json.loads(program.read_text())
        tables = executable["programs"][0]["tables"]
        for action in (rule["then"] for duty in tables["duties"] for rule in duty["rules"]):
            if "magnetize" in action and tables["roles"][action["magnetize"]["child"]]["name"] == "Y":
                action["magnetize"].update(face=face, cell=CELL)
        program.write_text(json.dumps(executable))
        command(stochc, "simulate", program, "--runs", runs, "--seed", SEED, "--model", "rigid", "--out", out, "--quiet")
    times = []
    for line in (out / "journal.jsonl").read_text().splitlines():
        record = json.loads(line).get("record")
        if record:
            bonds = (bond for bond in record["bonds"] if bond["phase"] == 1)
            waits = [bond["docked"] - bond["magnetized"] for bond in bonds]
            times.append(min(waits, default=MAX_TICKS))
    return times


def earlier(number, events, before):
    """Returns the events of a phase that come before an event in every order."""
    if number not in before:
        before[number] = set()
        for it in events[number]["after"]:
            before[number] |= {it["event"]} | earlier(it["event"], events, before)
    return before[number]


def second_parents(stochc, path):
    """Returns the number of captures, those with a second possible parent, and their share of the time."""
    estimate = json.loads(command(stochc, "estimate", path, "--json"))["estimates"][0]
    shares = {(it["phase"], it["event"]): it["share"] for it in estimate["shares"]}
    graph = json.loads(command(stochc, "compile", path, "--emit", "graph", "--json"))["programs"][0]
    table = json.loads(command(stochc, "compile", path, "--emit", "table", "--json"))["programs"][0]
    cells = {block["name"]: tuple(block["seed"]) for block in table["blocks"] if block.get("seed")}
    standing = set(cells)
    actions = (rule["then"] for block in table["blocks"] for duty in block["duties"] for rule in duty["rules"])
    cells.update((action["child"], tuple(action["cell"])) for action in actions if "cell" in action)
    captures, second, share = 0, 0, 0.0
    for phase in graph["phases"]:
        events = {event["id"]: event for event in phase["events"]}
        before = {}
        for number, event in events.items():
            if event["kind"] != "capture":
                continue
            captures += 1
            ahead = (events[it] for it in earlier(number, events, before))
            there = standing | {it["block"] for it in ahead if it["kind"] == "capture"}
            cell, face = cells[event["block"]], FACES[event["face"]]
            steps = (tuple(a - b for a, b in zip(cells[block], cell)) for block in there if block != event["parent"])
            if any(step in FACES.values() and step != face for step in steps):
                second += 1
                share += shares.get((phase["name"], event["event"]), 0)
        standing |= {event["block"] for event in phase["events"] if event["kind"] == "capture"}
        standing -= {event["block"] for event in phase["events"] if event["kind"] != "capture"}
    return captures, second, share


def main():
    stochc, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    folder.mkdir(parents=True, exist_ok=True)
    print("| place | open faces | runs | mean | stopped |\n|---|---|--:|--:|--:|")
    for place, (what, *_) in PLACES.items():
        for case in ("first", "second", "either"):
            times = first_captures(stochc, folder, place, case, runs)
            mean = sum(times) / len(times)
            half = 1.96 * math.sqrt(sum((time - mean) ** 2 for time in times) / (len(times) - 1) / len(times))
            stopped = sum(time >= MAX_TICKS for time in times)
            print(f"| {what} | {case} | {len(times)} | {mean:.0f} ± {half:.0f} | {stopped} |", flush=True)
    print("\n| example | captures | with a second parent | share |\n|---|--:|--:|--:|")
    examples = pathlib.Path(__file__).resolve().parents[2] / "examples"
    for name in EXAMPLES:
        captures, second, share = second_parents(stochc, examples / f"{name}.sa")
        print(f"| {name} | {captures} | {second} | {100 * share:.0f} % |", flush=True)


main()
