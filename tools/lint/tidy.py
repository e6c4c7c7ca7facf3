#!/usr/bin/env python3
"""Runs clang-tidy on files that have changed since they last passed. Exit 1 if one has findings.

A file that passes leaves a stamp under ${XDG_CACHE_HOME:-~/.cache}/flexarm-tidy. The stamp's name
is the hash of all that the answer depends on: the file and every header of this tree that it
includes, as they are written (a comment may be a NOLINT), its compile command with the clone's
folder taken out, the .clang-tidy files above it, and the versions of clang-tidy and of the
installed -dev packages, which stand for the system's headers. A file with findings leaves none.

With --changed it is the files that changed recently (changed_files.py), the most recent first. A
header is checked with the source of its name, or with one that includes it; a .clang-tidy with
all files below it. Without history all files are checked, and --within does not hold.
"""

import argparse
import hashlib
import itertools
import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from changed_files import changed_files

ROOT = Path(__file__).resolve().parents[2]
STAMPS = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "flexarm-tidy"
MAX_STAMP_AGE_S = 60 * 24 * 3600  # counted from its last use
INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
INCLUDE_FOLDER = re.compile(r"-I\s*(\S+)")
TIDY = ["clang-tidy-19", "-quiet"]


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def tool_versions():
    return output(*TIDY, "--version") + output("dpkg-query", "-W", "*-dev")


def texts_of(source, include_folders):
    """The texts of `source` and of all headers it includes with quotes, whatever an #if says."""
    texts = {}
    waiting = [source]
    while waiting:
        path = waiting.pop()
        if path in texts:
            continue
        texts[path] = path.read_bytes()
        for name in INCLUDE.findall(texts[path]):
            candidates = (folder / name.decode() for folder in (path.parent, *include_folders))
            waiting += [header for header in candidates if header.is_file()][:1]
    return texts


def stamp_of(entry, versions):
    """Where the stamp of a compile command is, if the file has passed as it is now."""
    source = Path(entry["file"])
    texts = texts_of(source, [Path(folder) for folder in INCLUDE_FOLDER.findall(entry["command"])])
    for folder in source.relative_to(ROOT).parents:
        config = ROOT / folder / ".clang-tidy"
        if config.is_file():
            texts[config] = config.read_bytes()
    digest = hashlib.sha256()
    for part in (*TIDY, versions, entry["command"].replace(str(ROOT), ".")):
        digest.update(part.encode() + b"\0")
    for path in sorted(texts):
        name = str(path.relative_to(ROOT)).encode()
        digest.update(name + b"\0" + hashlib.sha256(texts[path]).digest())
    return STAMPS / digest.hexdigest()


def check(entry, build, versions, end):
    """'unchanged', 'passed', 'failed', or 'left' where the time `end` was over; prints what
    clang-tidy says of a file that fails, and the name of one that is left."""
    stamp = stamp_of(entry, versions)
    if stamp.exists():
        os.utime(stamp)
        return "unchanged"
    if time.monotonic() > end:
        print(f"left: {Path(entry['file']).relative_to(ROOT)}", flush=True)
        return "left"
    run = subprocess.run([*TIDY, "-p", str(build), entry["file"]], check=False,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if run.returncode != 0:
        print(run.stdout, end="", flush=True)
        return "failed"
    stamp.touch()
    return "passed"


def concerned(name, by_name):
    """Those of the files `by_name` that show what a change of the file `name` did."""
    if name in by_name:
        return [name]
    if name.endswith(".clang-tidy"):
        folder = name.removesuffix(".clang-tidy")
        return [other for other in by_name if other.startswith(folder)]
    if not name.endswith(".h"):
        return []
    source = name.removesuffix(".h") + ".cpp"
    if source in by_name:
        return [source]
    users = (other for other in by_name
             if name.encode() in INCLUDE.findall(Path(by_name[other]["file"]).read_bytes()))
    return list(itertools.islice(users, 1))


def only_changed(entries, changed):
    """The compile commands that show what became of the `changed` files, in their order."""
    by_name = {Path(e["file"]).relative_to(ROOT).as_posix(): e for e in entries}
    names = dict.fromkeys(other for name in changed for other in concerned(name, by_name))
    return [by_name[name] for name in names]


def drop_old_stamps():
    for stamp in STAMPS.iterdir():
        if time.time() - stamp.stat().st_mtime > MAX_STAMP_AGE_S:
            stamp.unlink(missing_ok=True)


def compile_commands(build, places):
    """The compile commands of the files that are, or are below, one of `places`."""
    wanted = [place.resolve() for place in places]
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        source = Path(entry["file"])
        if any(source == place or place in source.parents for place in wanted):
            yield entry


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("places", nargs="+", type=Path, help="source files, or folders of them")
    parser.add_argument("--build", type=Path, default=ROOT / "build/separate",
                        help="where compile_commands.json is (default: build/separate)")
    parser.add_argument("--changed", action="store_true", help="only what changed recently")
    parser.add_argument("--within", type=float, default=float("inf"), metavar="SECONDS",
                        help="with --changed: begin with no file after this time")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="files at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    STAMPS.mkdir(parents=True, exist_ok=True)
    drop_old_stamps()
    entries = list(compile_commands(options.build, options.places))
    if not entries:
        sys.exit(f"tidy: nothing to check: {options.build} compiles none of these files")
    end = float("inf")
    changed = changed_files() if options.changed else None
    if changed is not None:
        entries = only_changed(entries, changed)
        end = time.monotonic() + options.within
    versions = tool_versions()
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda entry: check(entry, options.build, versions, end), entries))
    summary = (f"{len(results)} files, {results.count('unchanged')} unchanged since they passed, "
               f"{results.count('failed')} failed")
    if "left" in results:
        summary += f", {results.count('left')} left for clang-tidy-all when the time was over"
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if "failed" in results else 0


if __name__ == "__main__":
    sys.exit(main())
