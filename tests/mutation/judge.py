"""Runs a program on an input and says what is wrong with how it took it."""

import hashlib
import os
import re
import resource
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

HANG_S = 10.0         # of processor time, or of standing still
MEMORY_BYTES = 1 << 30
OUTPUT_BYTES = 64 << 20

# What a person should never read: texts of libraries, and of the language.
RAW = re.compile(
    rb"\[json\.exception|\bstd::|what\(\)|terminate called|basic_string|vector::|\bbad_alloc|"
    rb"\btoml::|\bsto[idlf]\b|Sanitizer|runtime error:|Assertion|filesystem error|nlohmann|"
    rb"bad_function_call|bad optional|bad_variant")
CRASH_OF_SANITIZER = (b"AddressSanitizer", b"UndefinedBehaviorSanitizer", b"runtime error:")


@dataclass
class Ended:
    """How a program ended."""

    code: int            # below 0: by this signal
    out: bytes
    err: bytes
    hung: bool
    most_bytes: int      # of its memory

    @property
    def told(self):
        return self.err.decode(errors="backslashreplace").strip()


def limit():
    if "ASAN_OPTIONS" not in os.environ:  # whose shadow is larger
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    seconds = int(HANG_S)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    resource.setrlimit(resource.RLIMIT_FSIZE, (OUTPUT_BYTES, OUTPUT_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def processor_ticks(pid):
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return None
    return int(fields[11]) + int(fields[12])


def wait(process):
    """Until it ends, or uses no processor time for HANG_S: on a busy machine a program that only
    waits for the processor still gets some. True: it stood still."""
    seen, since = None, time.monotonic()
    while True:
        try:
            process.wait(timeout=0.5)
            return False
        except subprocess.TimeoutExpired:
            used = processor_ticks(process.pid)
        if used != seen:
            seen, since = used, time.monotonic()
        elif time.monotonic() - since > HANG_S:
            process.kill()
            process.wait()
            return True


def run(command, folder, environment=None):
    """The command, in `folder`, with nothing on stdin."""
    with open(folder / ".out", "w+b") as out, open(folder / ".err", "w+b") as err:
        process = subprocess.Popen(
            [os.fsencode(part) for part in command], cwd=folder, stdin=subprocess.DEVNULL, stdout=out,
            stderr=err, preexec_fn=limit, env={**os.environ, **(environment or {})})
        hung = wait(process)
        out.seek(0)
        err.seek(0)
        code = process.returncode
        return Ended(code, out.read(), err.read(), hung or code == -signal.SIGXCPU,
                     resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)


def unprintable(text):
    """The first byte that may not go to a terminal; None: all may."""
    try:
        decoded = text.decode()
    except UnicodeDecodeError as error:
        return f"byte 0x{text[error.start]:02x} at {error.start} is not UTF-8"
    for at, char in enumerate(decoded):
        if (ord(char) < 0x20 and char not in "\n\t\r") or 0x7f <= ord(char) < 0xa0:
            return f"control character 0x{ord(char):02x} at {at}"
    return None


def digest(file):
    """Of what must not change. Only regular files and links have contents that can be read."""
    if file.is_symlink():
        return "link to " + os.readlink(file)
    if not file.exists():
        return "gone"
    if not file.is_file():
        return "special"
    return hashlib.sha256(file.read_bytes()).hexdigest()


def problems(ended, codes=(0, 1, 2), names=()):
    """What is wrong, in words.

    @param codes  exit codes of the contract
    @param names  a message with exit code 2 must contain one of them; (): any message will do
    """
    if ended.hung:
        return [f"hung for {HANG_S:g} s"]
    if ended.code == -signal.SIGXFSZ:
        return [f"wrote more than {OUTPUT_BYTES >> 20} MB"]
    found = []
    if ended.code < 0:
        found.append(f"killed by {signal.Signals(-ended.code).name}")
    elif any(sign in ended.err for sign in CRASH_OF_SANITIZER):
        found.append("report of a sanitizer")
    elif ended.code not in codes:
        found.append(f"exit code {ended.code}")
    for name, text in (("stdout", ended.out), ("stderr", ended.err)):
        if raw := RAW.search(text):
            found.append(f"{name} has the raw text '{raw.group().decode()}'")
        if said := unprintable(text):
            found.append(f"{name}: {said}")
    if ended.code == 2 and not ended.err.strip():
        found.append("exit code 2 without a message")
    elif ended.code == 2 and names and not any(name.encode() in ended.err for name in names):
        found.append(f"the message names none of {', '.join(names)}")
    return found
