#!/usr/bin/env python3
"""Names the files that changed recently, the most recent first: those that differ from the last
commit, then those of the last 30 commits, or of the day before the last commit where that is more.
No clock is read: the answer for a commit is always the same. A shallow clone has no answer.
"""

import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMMITS = 30
SECONDS = 24 * 3600


def git(root, *command):
    return subprocess.run(["git", "-C", str(root), *command], check=True, capture_output=True,
                          text=True).stdout


def history(root):
    """Yields (time of the commit, the files that it changed), the newest first."""
    # A merge names what it changed of its first parent. Names with quotes come as they are.
    log = git(root, "-c", "core.quotePath=off", "log", "--root", "-m", "--first-parent",
              "--name-only", "--format=%x00%ct")
    for commit in log.split("\0")[1:]:
        time, *names = commit.split("\n")
        yield int(time), [name for name in names if name]


def is_complete(root):
    """Does the clone know the changes of all commits it is asked for?"""
    try:
        return git(root, "rev-parse", "--is-shallow-repository").strip() == "false"
    except (OSError, subprocess.CalledProcessError):
        return False


def changed_files(root=ROOT, commits=COMMITS, seconds=SECONDS):
    """Paths from the root, of files that are there; None if there is no history to ask."""
    if not is_complete(root):
        return None
    names = git(root, "diff", "--name-only", "HEAD").splitlines()
    names += git(root, "ls-files", "--others", "--exclude-standard").splitlines()
    newest = None
    for number, (time, changed) in enumerate(history(root)):
        newest = newest or time
        if number >= commits and newest - time > seconds:
            break
        names += changed
    return [name for name in dict.fromkeys(names) if (Path(root) / name).is_file()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split(":", maxsplit=1)[0])
    parser.parse_args()
    names = changed_files()
    if names is None:
        sys.exit("changed_files: no complete git history here")
    print(*names, sep="\n")


if __name__ == "__main__":
    main()
