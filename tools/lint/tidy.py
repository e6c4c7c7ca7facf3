#!/usr/bin/env python3
"""Runs clang-tidy on files that have changed since they last passed. Exit 1 if one has findings.

A file that passes leaves a stamp under ${XDG_CACHE_HOME:-~/.cache}/flexarm-tidy. The stamp's name
is the hash of all that the answer depends on: the file and every header of this tree that it
includes, as they are written (a comment may be a NOLINT), its compile command with the clone's
folder taken out, the .clang-tidy files above it, and the versions of clang-tidy and of the
installed -dev packages, which stand for the system's headers. A file with findings leaves none.
"""

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STAMPS = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "flexarm-tidy"
MAX_STAMP_AGE_S = 60 * 24 * 3600  # counted from its last use
INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
INCLUDE_FOLDER = re.compile(r"-I\s*(\S+)")
TIDY = ["clang-tidy-14", "-quiet"]


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


def check(entry, build, versions):
    """'unchanged', 'passed' or 'failed'; prints what clang-tidy says of a file that fails."""
    stamp = stamp_of(entry, versions)
    if stamp.exists():
        os.utime(stamp)
        return "unchanged"
    run = subprocess.run([*TIDY, "-p", str(build), entry["file"]], check=False,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if run.returncode != 0:
        print(run.stdout, end="", flush=True)
        return "failed"
    stamp.touch()
    return "passed"


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
    parser.add_argument("--build", type=Path, default=ROOT / "build/release",
                        help="where compile_commands.json is (default: build/release)")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="files at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    STAMPS.mkdir(parents=True, exist_ok=True)
    drop_old_stamps()
    entries = list(compile_commands(options.build, options.places))
    if not entries:
        sys.exit(f"tidy: nothing to check: {options.build} compiles none of these files")
    versions = tool_versions()
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda entry: check(entry, options.build, versions), entries))
    summary = (f"{len(results)} files, {results.count('unchanged')} unchanged since they passed, "
               f"{results.count('failed')} failed")
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if "failed" in results else 0


if __name__ == "__main__":
    sys.exit(main())
