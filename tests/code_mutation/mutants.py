#!/usr/bin/env python3
"""Changes the safety code, a little at a time, and asks whether its tests notice.

Not to be confused with tests/mutation, which changes the input of programs. Here each mutant is
one change of one source (generate.py): a condition negated, a statement dropped, a limit off by
one, operands or branches swapped, a value replaced. It is built in a copy of this tree, and the
test programs that map.json names for the source must fail. argued.json has the mutants that no
test can kill or need not, each with its reason; one that survives and is not there fails the run.

  killed        a test failed, did not end, or a static_assert of a test did not hold
  not compiled  counts neither way
  survived      every test passed
  argued        in argued.json; not built

Results stay in results.json of the folder, so a run that was stopped goes on. A mutant that was
killed is not built again until its source changes; one that survived is, for tests may have come.
"""

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import generate

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT / "tools" / "lint"))

from changed_files import changed_files  # noqa: E402

BUILD_LIMIT_S = 600
KINDS = ("killed", "not compiled", "survived", "argued", "left")
# Quick to compile; assertions on, also of the library: an index beyond an array ends the test. The
# tests are found when they run: a mutant may crash at once.
CONFIGURE = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
             "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -D_GLIBCXX_ASSERTIONS", "-DFLEXARM_BATCHES=OFF",
             "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache",
             "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST"]


def read_json(path, otherwise):
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else otherwise


def run(command, folder, limit_s, **more):
    """(exit code, output); the exit code is None where the time was over."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, errors="replace", start_new_session=True, **more) as process:
        try:
            output, _ = process.communicate(timeout=limit_s)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return None, process.communicate()[0]


class Workshop:
    """A copy of the tree, and its build."""

    def __init__(self, folder, jobs):
        self.tree, self.build, self.jobs = folder / "tree", folder / "build", jobs
        self.reference_s, self.links = {}, {}

    def prepare(self):
        listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others",
                                 "--exclude-standard"], cwd=ROOT, check=True, capture_output=True,
                                text=True).stdout
        names = {name for name in listed.split("\0") if (ROOT / name).is_file()}
        for name in names:  # a file that is the same keeps its time, so nothing is built again
            self.write(name, (ROOT / name).read_bytes())
            shutil.copymode(ROOT / name, self.tree / name)
        for path in self.tree.rglob("*"):
            if path.is_file() and path.relative_to(self.tree).as_posix() not in names:
                path.unlink()
        self.build.mkdir(parents=True, exist_ok=True)
        self.must(["cmake", "-S", str(self.tree), "-B", str(self.build), *CONFIGURE])

    def write(self, name, data):
        path = self.tree / name
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def environment(self, cached):
        own = {"CCACHE_BASEDIR": str(self.tree), "CCACHE_NOHASHDIR": "1"}
        return {**os.environ, **own, **({} if cached else {"CCACHE_DISABLE": "1"})}

    def must(self, command):
        status, output = run(command, self.build, None, env=self.environment(True))
        if status != 0:
            sys.exit(f"mutants: {' '.join(command)} failed without a mutant:\n{output[-4000:]}")
        return output

    def make(self, *targets):
        return run(["ninja", f"-j{self.jobs}", *targets], self.build, BUILD_LIMIT_S,
                   env=self.environment(False))

    def make_original(self, *targets):
        self.must(["ninja", f"-j{self.jobs}", *targets])

    def program(self, name):
        return next(path for path in (self.build / "tests").rglob(name) if path.is_file())

    def link_of(self, program, source):
        """(object, archive, link command) of a program of the one test source `source`."""
        commands = self.must(["ninja", "-t", "commands", program]).splitlines()
        link = commands[-1].removeprefix(": && ").removesuffix(" && :").split()
        objects = [word for word in link if word.endswith(".cpp.o")]
        own = next(word for word in objects if word.endswith("/" + Path(source).name + ".o"))
        words = [word for word in link if word not in objects or word == own]
        out = words.index("-o") + 1
        words[out] = f"{Path(source).stem}_alone"
        return own, words, words[out]

    def passes(self, command, name, chosen="*"):
        """Whether the tests of a program pass; the first run, without a mutant, sets the limit."""
        key = (name, chosen)
        limit = 20 + 10 * self.reference_s[key] if key in self.reference_s else 1200
        begin = time.monotonic()
        status, output = run([command, "--gtest_brief=1", "--gtest_fail_fast",
                              f"--gtest_filter={chosen}"], self.build, limit)
        self.reference_s.setdefault(key, time.monotonic() - begin)
        return status == 0, output


def first_stage(shop, source, entry):
    """Builds and runs the one test source that is likeliest to notice; much quicker than all."""
    own, words, out = shop.link_of(entry["programs"][0], entry["first"])
    targets = [own]
    if source.endswith(".cpp"):
        archive = next(word for word in words
                       if word.endswith(".a") and word.startswith(str(Path(source).parent) + "/"))
        targets.append(archive)

    def stage():
        status, output = shop.make(*targets)
        if status != 0:
            return None, output
        status, output = run(words, shop.build, BUILD_LIMIT_S)
        if status != 0:
            return None, output
        return shop.passes(str(shop.build / out), entry["first"], entry.get("filter", "*"))
    return stage


def program_stage(shop, program, chosen):
    def stage():
        status, output = shop.make(program)
        if status != 0:
            return None, output
        return shop.passes(str(shop.program(program)), program, chosen)
    return stage


def judge(stages):
    """What becomes of the mutant that is in the copy, and how many stages were needed."""
    for number, stage in enumerate(stages, 1):
        passed, output = stage()
        if passed is None:
            asserted = "static assertion failed" in output or "static_assert" in output
            return ("killed" if asserted else "not compiled"), number
        if not passed:
            return "killed", number
    return "survived", len(stages)


def is_argued(mutant, source, argued):
    return any(entry["file"] == source and entry["line"] == mutant.line and
               entry["mutation"] == mutant.mutation and entry.get("nth", mutant.nth) == mutant.nth
               for entry in argued)


def stale(argued):
    """The entries of the list that are about no mutant of the sources as they are."""
    found = {source: generate.mutants_of((ROOT / source).read_text(encoding="utf-8"))
             for source in {entry["file"] for entry in argued} if (ROOT / source).is_file()}
    return [entry for entry in argued
            if not any(is_argued(mutant, entry["file"], [entry])
                       for mutant in found.get(entry["file"], []))]


def key_of(text, source, mutant):
    change = f"{mutant.begin} {mutant.end} {mutant.new}"
    return hashlib.sha256("\0".join([source, text, change]).encode()).hexdigest()[:20]


class Session:
    def __init__(self, options):
        self.folder = options.folder
        self.options = options
        self.map = read_json(HERE / "map.json", {})
        self.argued = read_json(HERE / "argued.json", [])
        self.results_path = self.folder / "results.json"
        self.results = read_json(self.results_path, {})
        self.end = time.monotonic() + options.within

    def sources(self):
        if self.options.file:
            unknown = [name for name in self.options.file if name not in self.map]
            if unknown:
                sys.exit(f"mutants: not in map.json: {' '.join(unknown)}")
            return self.options.file
        if not self.options.changed:
            return list(self.map)
        changed = changed_files()
        return list(self.map) if changed is None else [name for name in self.map if name in changed]

    def keep(self, key, result):
        self.results[key] = result
        partial = self.results_path.with_suffix(".new")
        partial.write_text(json.dumps(self.results, indent=0), encoding="utf-8")
        partial.replace(self.results_path)

    def of_source(self, shop, source):
        """The results of the mutants of a source, in their order: (mutant, result)."""
        text = (ROOT / source).read_text(encoding="utf-8")
        index, count = self.options.shard
        mutants = generate.mutants_of(text)[index - 1::count]
        pairs, stages = [], None
        try:
            for mutant in mutants:
                key = key_of(text, source, mutant)
                result = self.results.get(key)
                if is_argued(mutant, source, self.argued):
                    result = "argued"
                elif result in {None, "survived"}:
                    result = "left"
                    if time.monotonic() < self.end:
                        stages = stages or self.stages(shop, source)
                        shop.write(source, mutant.apply(text).encode())
                        result, needed = judge(stages)
                        self.keep(key, result)
                        if needed > 1 and source.endswith(".h"):
                            # The first stage links the archives of the original.
                            shop.write(source, text.encode())
                            shop.make_original(*self.map[source]["programs"])
                if result == "survived":
                    print(f"survived: {source}:{mutant.line_number}: {mutant.line}\n"
                          f"    {mutant.operator}: {mutant.mutation}"
                          f"{f' (number {mutant.nth})' if mutant.nth > 1 else ''}", flush=True)
                pairs.append((mutant, result))
        finally:
            shop.write(source, text.encode())
        return pairs

    def stages(self, shop, source):
        entry = self.map[source]
        shop.make_original(*entry["programs"])
        stages = [first_stage(shop, source, entry)] if entry["first"] else []
        stages += [program_stage(shop, program, entry.get("filter", "*"))
                   for program in entry["programs"]]
        if "last" in entry:  # tests of many seconds, for the few that pass the others
            stages.append(program_stage(shop, entry["programs"][0], entry["last"]))
        if judge(stages)[0] != "survived":
            sys.exit(f"mutants: the tests of {source} fail without a mutant")
        return stages


def shard(text):
    index, count = (int(part) for part in text.split("/"))
    if not 1 <= index <= count:
        raise ValueError(text)
    return index, count


def report(counts):
    width = max(len(source) for source in counts)
    print(f"{'source':{width}} {'mutants':>8}" + "".join(f" {kind:>12}" for kind in KINDS))
    for source, count in counts.items():
        print(f"{source:{width}} {sum(count.values()):8}" +
              "".join(f" {count[kind]:12}" for kind in KINDS))
    total = sum(counts.values(), Counter())
    return total, (f"{sum(total.values())} mutants of {len(counts)} files: " +
                   ", ".join(f"{total[kind]} {kind}" for kind in KINDS))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--file", action="append", help="only this source; may be repeated")
    parser.add_argument("--changed", action="store_true", help="only sources that changed recently")
    parser.add_argument("--shard", type=shard, default=(1, 1), metavar="I/N",
                        help="only each Nth mutant, from the Ith")
    parser.add_argument("--list", action="store_true", help="print the mutants, build nothing")
    parser.add_argument("--within", type=float, default=float("inf"), metavar="SECONDS",
                        help="begin with no mutant after this time")
    parser.add_argument("--folder", type=Path, default=ROOT / "build/mutants",
                        help="of the copy, its build and the results (default: build/mutants)")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="compilers at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    options.folder = options.folder.resolve()
    session = Session(options)
    sources = session.sources()
    if options.list:
        for source in sources:
            for mutant in generate.mutants_of((ROOT / source).read_text(encoding="utf-8")):
                print(f"{source}:{mutant.line_number}: {mutant.operator}: {mutant.mutation}")
        return 0
    old = stale(session.argued)
    for entry in old:
        print(f"argued.json: no such mutant: {entry['file']}: {entry['line']}: {entry['mutation']}")
    total, summary = Counter(), "no source of map.json changed"
    if sources:
        shop = Workshop(options.folder, options.jobs)
        shop.prepare()
        total, summary = report({source: Counter(result for _, result in
                                                 session.of_source(shop, source))
                                 for source in sources})
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if old or total["survived"] or total["left"] else 0


if __name__ == "__main__":
    sys.exit(main())
