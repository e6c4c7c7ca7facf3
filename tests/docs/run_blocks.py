#!/usr/bin/env python3
"""Runs the command blocks of the pages (tools/lint/command_blocks.py has their tags) as a reader
does: all blocks of a page in order, in one shell, in one folder that is new for each page.

Where:
clone      a fresh `git clone` of the last commit, with what differs from it in this tree. Its
           build/release is a link to the build folder that is given: the blocks use what is built
           there, and `cmake --build` in a block builds there (`cmake --preset` does not work
           there). build/guest is a link, too: the image of the guest. Nothing else is linked.
installed  an empty folder, with what `cmake --install` wrote to a temporary place on PATH and
           `config` a link to the installed configs, as the README tells the reader to make it.
unbuilt    a fresh clone without a build folder, for blocks that say so: they build everything.

`all` also runs the `ci` blocks of the pages that have an `all` block: those come later on the page
and use what the others have made. `rig` blocks never run. `guest` writes the pages as scripts for
tests/guest/docs.sh, which runs them inside the guest; its clone is without what only git, a
compiler or the tests read. `newcomer` writes the pages for tests/guest/newcomer.sh, which runs them
after the guest has nothing but the package.

usage: run_blocks.py ci|all --build FOLDER [--page PAGE]... [--place PLACE]... [--note FILE]
       run_blocks.py ci|all --build FOLDER --list
       run_blocks.py guest|newcomer --build FOLDER --share FOLDER
"""

import argparse
import collections
import concurrent.futures
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import command_blocks  # noqa: E402

PAGE_SHELL = Path(__file__).with_name("page.sh")
# Of a block: much more than any takes, as a busy machine may be thirty times slower.
LIMIT_S = {"ci": 300, "all": 3000}
SHOWN_LINES = 40

SESSIONS = set()  # of the pages that run
STOPPED = threading.Event()

Outcome = collections.namedtuple("Outcome", "page place blocks failure output")


def selected(text, lane, place):
    """The blocks of a page that a lane runs in a place."""
    blocks = [block for block in command_blocks.commands(text) if runs_in(block, place)]
    if lane == "all" and any(block.lane == "all" for block in blocks):
        return [block for block in blocks if block.lane in ("ci", "all")]
    return [block for block in blocks if block.lane == lane]


def runs_in(block, place):
    return block.place == place or block.place is None and place != "unbuilt"


def script(text, blocks):
    """The page with nothing but these blocks, in the same lines."""
    lines = [""] * (len(text.splitlines()) + 1)
    for block in blocks:
        lines[block.line - 1] = f"block {block.line}"
        lines[block.line:block.line + len(block.body)] = block.body
    return "\n".join(lines) + "\n"


def run(command, **options):
    return subprocess.run(command, check=True, **options)


class Places:
    """Makes the folders in which pages run."""

    def __init__(self, build, work):
        self.build, self.work = build, work
        self.difference = run(["git", "diff", "--binary", "HEAD"], cwd=ROOT,
                              capture_output=True).stdout
        told = run(["git", "ls-files", "-z", "--others", "--exclude-standard"], cwd=ROOT,
                   capture_output=True, text=True).stdout
        self.new_files = [name for name in told.split("\0") if name]
        self.machine = self.programs = self.configs = None

    def clone(self, folder, linked=True):
        run(["git", "clone", "--quiet", str(ROOT), str(folder)])
        run(["git", "apply", "--allow-empty", "--whitespace=nowarn"], cwd=folder,
            input=self.difference)
        for name in self.new_files:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
        if linked:
            (folder / "build").mkdir()
            (folder / "build/release").symlink_to(self.build)
            guest = ROOT / "build/guest"
            guest.mkdir(parents=True, exist_ok=True)
            (folder / "build/guest").symlink_to(guest)

    def install(self):
        """What cmake --install writes, once."""
        if self.machine is not None:
            return
        machine = self.work / "machine"
        run(["cmake", "--install", str(self.build)], stdout=subprocess.DEVNULL,
            env={**os.environ, "DESTDIR": str(machine)})
        self.programs = next(path.parent for path in machine.rglob("flexarmd")
                             if path.parent.name == "bin")
        self.configs = next(machine.rglob("share/flexarm/config"))
        self.machine = machine

    def make(self, place, folder):
        """Makes the folder, and returns where the programs are."""
        if place == "installed":
            self.install()
            folder.mkdir(parents=True)
            (folder / "config").symlink_to(self.configs)
            return self.programs
        folder.parent.mkdir(parents=True, exist_ok=True)
        self.clone(folder, linked=place == "clone")
        return folder / "build/release/bin"


def environment(programs):
    """That of a user who has the programs on PATH."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("FLEXARM_")}
    return {**kept, "PATH": f"{programs}:{os.environ['PATH']}", "TERM": "dumb"}


def marks_of(reader, limit_s):
    """The lines of a pipe as they come, and None where none comes within the time."""
    text = b""
    while True:
        if not select.select([reader], [], [], limit_s)[0]:
            yield None
            continue
        more = os.read(reader, 1 << 16)
        if not more:
            os.close(reader)
            return
        *lines, text = (text + more).split(b"\n")
        yield from (line.decode("utf-8", "replace") for line in lines)


def run_script(file, folder, variables, limit_s):
    """Runs a page. Returns the seconds of each block, what failed as (line, status, command), and
    the output of the block that failed."""
    reader, writer = os.pipe()
    output = folder.parent / "output"
    seconds, failure, began, offset = {}, None, None, 0
    with open(output, "wb") as log:
        shell = subprocess.Popen(
            ["bash", "-c", f"exec 9>&{writer}; exec {writer}>&-; exec bash \"$@\"", "bash",
             str(PAGE_SHELL), str(file)],
            cwd=folder, env=variables, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
            pass_fds=[writer], start_new_session=True)
    SESSIONS.add(shell.pid)
    if STOPPED.is_set():
        end_session(shell.pid)
    os.close(writer)
    line = None
    for mark in marks_of(reader, limit_s):
        if mark is None:
            failure = failure or (line or 1, 124, f"the block is not done after {limit_s} s")
            end_session(shell.pid)
            continue
        kind, number, *more = mark.split(" ", 2)
        now = time.monotonic()
        if line is not None:
            seconds[line] = now - began
        if kind == "failed":
            status, command = more[0].split(" ", 1)
            failure = failure or (int(number) or line, int(status), command)
            continue
        line, began, offset = int(number), now, int(more[0])
    if line is not None:
        seconds.setdefault(line, time.monotonic() - began)
    try:
        status = shell.wait(timeout=60)
    except subprocess.TimeoutExpired:
        status = 124
    end_session(shell.pid)
    SESSIONS.discard(shell.pid)
    shell.wait()
    if failure is None and status != 0:
        failure = line or 1, status, "the shell of the page was ended"
    with open(output, "rb") as log:
        log.seek(offset)
        said = log.read().decode("utf-8", "replace")
    return seconds, failure, said


def members(session):
    """The processes of a session. A build puts its own into groups of their own."""
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            # After the name, which may have any character: state, parent, group, session.
            fields = stat.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue  # it has ended
        if int(fields[3]) == session and fields[0] != "Z":
            yield int(stat.parent.name)


def end_session(session):
    """Ends what a page has left: by SIGTERM, after 5 s by SIGKILL."""
    until = time.monotonic() + 5
    for attempt in range(200):
        left = list(members(session))
        if not left:
            return
        late = time.monotonic() > until
        for process in left:
            if late or attempt == 0:
                try:
                    os.kill(process, signal.SIGKILL if late else signal.SIGTERM)
                except ProcessLookupError:
                    pass
        time.sleep(0.1)


def end_all(*_):
    """At SIGTERM, as when the lane runs out of time: ends the pages, which are in sessions of their
    own, and then this program."""
    STOPPED.set()
    for session in list(SESSIONS):
        end_session(session)
    sys.exit("stopped by SIGTERM")


def run_page(places, page, lane, place):
    """Runs the blocks of a page in a place; None if it has none there."""
    text = page.read_text(encoding="utf-8")
    blocks = selected(text, lane, place)
    if not blocks:
        return None
    name = page.relative_to(ROOT).as_posix()
    home = places.work / place / name.replace("/", "-")
    # A clone's folder has the name that a reader's has.
    folder = home / "flexarm"
    programs = places.make(place, folder)
    file = home / page.name
    file.write_text(script(text, blocks), encoding="utf-8")
    seconds, failure, said = run_script(file, folder, environment(programs), LIMIT_S[lane])
    shutil.rmtree(home, ignore_errors=True)
    return Outcome(name, place, seconds, failure, said)


def run_place(places, pages, lane, place):
    """All pages in a place, one after the other: blocks that build share a build folder."""
    outcomes = []
    for page in pages:
        if STOPPED.is_set():
            break
        outcome = run_page(places, page, lane, place)
        if outcome is None:
            continue
        outcomes.append(outcome)
        for line, took_s in outcome.blocks.items():
            print(f"{took_s:7.1f} s  {place:9}  {outcome.page}:{line}", flush=True)
        if outcome.failure:
            line, status, command = outcome.failure
            shown = page.read_text(encoding="utf-8").splitlines()[line - 1].strip()
            if not shown.startswith("```"):
                command = shown
            end = "\n".join(outcome.output.splitlines()[-SHOWN_LINES:])
            print(f"error: {outcome.page}:{line}: ({place}) exit code {status}: {command}\n"
                  f"{end}", flush=True)
    return outcomes


def write_guest_pages(places, pages, share):
    """Writes what tests/guest/docs.sh needs: a clone with the built programs, and the pages."""
    share.mkdir(parents=True)
    shutil.copy2(PAGE_SHELL, share)
    clone = share / "clone"
    places.clone(clone, linked=False)
    # The guest has no git, compiler or Python, and copies each file slowly: what needs them stays.
    for name in (".git", "tests"):
        shutil.rmtree(clone / name)
    for source in (*clone.rglob("*.cpp"), *clone.rglob("*.h")):
        source.unlink()
    (clone / "build/release/bin").mkdir(parents=True)
    for program in ("flexarm", "flexarmd"):
        shutil.copy2(places.build / "bin" / program, clone / "build/release/bin")
    return sum(write_pages(pages, "guest", place, share / "pages" / place)
               for place in ("clone", "installed"))


def write_newcomer_pages(pages, share):
    """Writes what tests/guest/newcomer.sh needs."""
    share.mkdir(parents=True, exist_ok=True)
    shutil.copy2(PAGE_SHELL, share)
    return write_pages(pages, "newcomer", "installed", share / "pages")


def write_pages(pages, lane, place, folder):
    """Writes each page that has blocks there as a script; returns the number of blocks."""
    folder.mkdir(parents=True)
    count = 0
    for page in pages:
        text = page.read_text(encoding="utf-8")
        blocks = selected(text, lane, place)
        if blocks:
            name = page.relative_to(ROOT).as_posix().replace("/", "-")
            (folder / name).write_text(script(text, blocks), encoding="utf-8")
            count += len(blocks)
    return count


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lane", choices=("ci", "all", "guest", "newcomer"))
    parser.add_argument("--build", type=Path, required=True, help="the release build")
    parser.add_argument("--page", type=Path, action="append", help="only this page; repeatable")
    parser.add_argument("--place", choices=command_blocks.PLACES, action="append",
                        help="only there; repeatable")
    parser.add_argument("--list", action="store_true", help="print the pages that have such blocks")
    parser.add_argument("--note", type=Path, help="file for a line of summary")
    parser.add_argument("--share", type=Path, help="guest and newcomer: folder to write")
    return parser.parse_args()


def main():
    options = arguments()
    signal.signal(signal.SIGTERM, end_all)
    pages = command_blocks.pages(ROOT)
    if options.page:
        pages = [page.resolve() for page in options.page]
    if options.list:
        for page in pages:
            text = page.read_text(encoding="utf-8")
            if any(block.lane == options.lane for block in command_blocks.commands(text)):
                print(page.relative_to(ROOT).as_posix())
        return 0
    if options.lane == "newcomer":
        count = write_newcomer_pages(pages, options.share)
        print(f"{count} blocks for the newcomer")
        return 0 if count else 1
    with tempfile.TemporaryDirectory(prefix="flexarm-docs-") as work:
        places = Places(options.build.resolve(), Path(work))
        if options.lane == "guest":
            count = write_guest_pages(places, pages, options.share)
            print(f"{count} blocks for the guest")
            return 0 if count else 1
        names = options.place or command_blocks.PLACES
        if "installed" in names:
            places.install()
        since = time.monotonic()
        with concurrent.futures.ThreadPoolExecutor(len(names)) as pool:
            running = [pool.submit(run_place, places, pages, options.lane, place)
                       for place in names]
            outcomes = [outcome for future in running for outcome in future.result()]
    return conclude(options, outcomes, time.monotonic() - since)


def conclude(options, outcomes, took_s):
    count = sum(len(outcome.blocks) for outcome in outcomes)
    failures = [outcome for outcome in outcomes if outcome.failure]
    slowest = max(((seconds, f"{outcome.page}:{line}") for outcome in outcomes
                   for line, seconds in outcome.blocks.items()), default=(0.0, "none"))
    summary = (f"{count} blocks run, of {len({outcome.page for outcome in outcomes})} pages, "
               f"in {took_s:.0f} s; the slowest {slowest[1]}, {slowest[0]:.0f} s")
    print(summary)
    for outcome in failures:
        print(f"error: {outcome.page}:{outcome.failure[0]}: failed ({outcome.place})")
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    if not outcomes:
        print("error: no page has a block to run")
    return 1 if failures or not outcomes else 0


if __name__ == "__main__":
    sys.exit(main())
