#!/usr/bin/env python3
"""Compares what the product costs the compiler with the figures in build_cost.json. Exit 1 if a
translation unit takes 30 % more than its figure, or the product 15 % more per thousand lines.

A figure is a ratio: processor time of a unit over that of a fixed reference file, which is compiled
again and again among the units, on the same machine under the same load. Units are compiled as the
build does (batches, and sources that stay apart), without the compiler cache. A shared machine adds
to a time and never takes away: a unit above its limit is measured up to twice more, and its smallest
ratio counts.

--update writes the figures, and keeps those that still hold within 10 %. A commit that raises one
has a line `Build cost: why` in its message.
"""

import argparse
import json
import os
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIGURES = "tools/lint/build_cost.json"
PRODUCT = ("model", "hal", "estimator", "controller", "config", "tools")
REFERENCE = ["-std=c++20", "-O2", "-isystem", "/usr/include/eigen3",
             "-c", str(ROOT / "tests/lint/build_cost_reference.cpp")]
UNIT_MARGIN = 1.30
TOTAL_MARGIN = 1.15
KEEP_WITHIN = 0.10
MEASUREMENTS_MORE = 2
UNITS_A_REFERENCE = 8  # one compilation of the reference among so many units, and at least
MIN_REFERENCES = 3
ADVICE = ("make it cheaper (an include or a template that it does not need?), or run"
          " tools/lint/build_cost.py --update and say why in the commit, in a line 'Build cost: ..'")


def product_units(build, root):
    """Compile commands of the product by the path of the source, from the build folder for what is
    generated there, else from the root; each with the folder to run it in."""
    units = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        if Path(words[0]).name == "ccache":
            words.pop(0)
        target = words[words.index("-o") + 1]
        if target.startswith("tests/") or "_verify_interface_header_sets" in target:
            continue
        source = Path(entry["file"])
        name = source.relative_to(build if source.is_relative_to(build) else root).as_posix()
        if name in units:
            raise SystemExit(f"build_cost: {name} is compiled twice: share a library")
        units[name] = (words, entry["directory"])
    return units


def product_lines(root):
    return sum(path.read_text(encoding="utf-8").count("\n") for folder in PRODUCT
               for path in (root / folder).rglob("*") if path.suffix in (".h", ".cpp"))


def cpu_seconds(words, directory, output):
    """User and system time of a compilation into the file `output`."""
    words = list(words)
    if "-o" in words:
        words[words.index("-o") + 1] = output
    else:
        words += ["-o", output]
    with subprocess.Popen(words, cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True) as compiler:
        text = compiler.stdout.read()
        _, status, usage = os.wait4(compiler.pid, 0)
        compiler.returncode = os.waitstatus_to_exitcode(status)
    if compiler.returncode != 0:
        raise SystemExit(f"{text}\nbuild_cost: this does not compile: {shlex.join(words)}")
    return usage.ru_utime + usage.ru_stime


def mixed(names, references):
    """The names with None, for the reference, at `references` places between them."""
    order = list(names)
    for number in range(references):
        order.insert(number * (len(names) + references) // references, None)
    return order


def measure(units, names, jobs):
    """Ratios of the units `names`, and the processor time of all."""
    compiler = next(iter(units.values()))[0][0]
    order = mixed(names, max(MIN_REFERENCES, -(-len(names) // UNITS_A_REFERENCE)))
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        def compile_one(numbered):
            number, name = numbered
            words, directory = units[name] if name else ([compiler, *REFERENCE], folder)
            return cpu_seconds(words, directory, f"{folder}/{number}.o")
        seconds = list(pool.map(compile_one, enumerate(order)))
    reference = statistics.median(s for s, name in zip(seconds, order) if name is None)
    print(f"build_cost: {len(names)} units and the reference, {sum(seconds):.0f} s of processor"
          f" time; the reference takes {reference:.2f} s", flush=True)
    return {name: s / reference for s, name in zip(seconds, order) if name}


def measured(names, measure_some, figures, thousand_lines):
    """The smallest ratios, measured again where they are above what the figures allow."""
    ratios = measure_some(names)
    for _ in range(MEASUREMENTS_MORE):
        of = figures["units"]
        again = [name for name in names if ratios[name] > UNIT_MARGIN * of[name]]
        if sum(ratios.values()) / thousand_lines > TOTAL_MARGIN * figures["per_thousand_lines"]:
            again = [name for name in names if ratios[name] > of[name]]
        if not again:
            break
        for name, ratio in measure_some(again).items():
            ratios[name] = min(ratio, ratios[name])
    return ratios


def strangers(names, figures):
    """What is wrong with the list of units, before any is measured."""
    for name in sorted(set(names) - set(figures["units"])):
        yield f"{name} has no figure: {ADVICE}"
    for name in sorted(set(figures["units"]) - set(names)):
        yield f"{name} has a figure and is not compiled: {ADVICE}"


def excesses(ratios, figures, thousand_lines):
    """What costs more than its figure allows."""
    for name, ratio in sorted(ratios.items()):
        figure = figures["units"][name]
        if ratio > UNIT_MARGIN * figure:
            yield (f"{name} takes the compiler {ratio:.2f} times the reference,"
                   f" {ratio / figure - 1:.0%} more than its figure {figure:.2f}"
                   f" (30 % are allowed): {ADVICE}")
    total, figure = sum(ratios.values()) / thousand_lines, figures["per_thousand_lines"]
    if total > TOTAL_MARGIN * figure:
        yield (f"the product takes {total:.3f} references per thousand lines,"
               f" {total / figure - 1:.0%} more than its figure {figure:.3f}"
               f" (15 % are allowed): {ADVICE}")


def updated(ratios, old, thousand_lines):
    """New figures; those that hold within 10 % stay as they are."""
    def kept(new, before, digits):
        return before if before and abs(new / before - 1) <= KEEP_WITHIN else round(new, digits)
    before = old["units"] if old else {}
    total = sum(ratios.values()) / thousand_lines
    return {"per_thousand_lines": kept(total, old and old["per_thousand_lines"], 3),
            "units": {name: kept(ratios[name], before.get(name), 2) for name in sorted(ratios)}}


def raised(old, new):
    """Names of figures that are higher than they were."""
    if new["per_thousand_lines"] > old["per_thousand_lines"]:
        yield "the total per thousand lines"
    yield from (name for name, figure in new["units"].items()
                if figure > old["units"].get(name, figure))


def unexplained(root):
    """What the last commit of the figures raised without a reason; nothing where git is silent."""
    def git(*command):
        result = subprocess.run(["git", "-C", str(root), *command], check=False,
                                capture_output=True, text=True)
        return result.stdout if result.returncode == 0 else ""
    commit = git("log", "-1", "--format=%H", "--", FIGURES).strip()
    texts = [git("show", f"{version}:{FIGURES}") for version in (f"{commit}^", commit) if commit]
    if not all(texts) or not texts:
        return
    names = list(raised(*map(json.loads, texts)))
    if names and not re.search(r"^Build cost: \S", git("log", "-1", "--format=%B", commit), re.M):
        yield (f"{commit[:12]} raises the figure of {', '.join(names)}: its message, or that of the"
               " next commit of the figures, needs a line 'Build cost: why'")


def report(findings, summary, note):
    for finding in findings:
        print(f"error: build_cost: {finding}")
    print(summary)
    if note:
        note.write_text(summary + "\n", encoding="utf-8")
    return 1 if findings else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=ROOT,
                        help="the tree, with build/release configured (default: this one)")
    parser.add_argument("--update", action="store_true", help="write the figures")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="units at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    root = options.root.resolve()
    units = product_units(root / "build/release", root)
    if not units:
        sys.exit(f"build_cost: {root}/build/release compiles nothing of the product")
    thousand_lines = product_lines(root) / 1000
    path = root / FIGURES
    figures = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
    # The longest first, so that no core waits at the end.
    names = sorted(units, key=lambda name: -(figures["units"].get(name, 0) if figures else 0))

    def measure_some(some):
        return measure(units, some, options.jobs)

    if options.update:
        first, second = measure_some(names), measure_some(names)
        ratios = {name: min(first[name], second[name]) for name in names}
        new = updated(ratios, figures, thousand_lines)
        path.write_text(json.dumps(new, indent=2) + "\n", encoding="utf-8")
        for name in raised(figures, new) if figures else ():
            print(f"raised: {name}: say why in the commit, in a line 'Build cost: ..'")
        return 0
    if figures is None:
        return report([f"{FIGURES} is not there: {ADVICE}"], "no figures", options.note)
    findings = [*unexplained(root), *strangers(names, figures)]
    if findings:
        return report(findings, "nothing was measured", options.note)
    ratios = measured(names, measure_some, figures, thousand_lines)
    total = sum(ratios.values()) / thousand_lines
    return report(list(excesses(ratios, figures, thousand_lines)),
                  f"{len(units)} units, {total:.2f} references per thousand lines"
                  f" (figure {figures['per_thousand_lines']:.2f})", options.note)


if __name__ == "__main__":
    sys.exit(main())
