#!/usr/bin/env python3
"""Writes tests/fuzz/corpus again, the inputs where fuzzing begins: shipped configs and experiments, and
files that the programs make. Few and small, because libFuzzer changes them blindly."""

import argparse
import json
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "mutation"))
from inputs import CONFIGS, EXPERIMENTS, ROOT, Programs  # noqa: E402
from kinds_daemon import COMMANDS  # noqa: E402

CORPUS = Path(__file__).resolve().parent / "corpus"
RIGS = ("thesis-rig", "hil-wire", "daq-rig", "quanser-2dsfl")
RECORD_HEADER_BYTES = 32  # controller/runlog/record_format.h
MOST_BYTES = 4096         # of a record of the corpus


def put(target, name, content):
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def short_run(programs, rig, ticks=3):
    """The log of a run of some samples."""
    file = programs.folder / f"{rig}.flexarm"
    experiment = programs.folder / f"{rig}.toml"
    experiment.write_text(f'name = "short"\nduration_s = {ticks * 0.02}\n', encoding="utf-8")
    programs.make("simulate", "-c", CONFIGS / f"{rig}.toml", "--experiment", experiment, "-o", file, "--json")
    return file


def make_configs(programs):
    """As they stand in logs: whole and without comments."""
    for rig in RIGS:
        with sqlite3.connect(short_run(programs, rig)) as log:
            (text,) = log.execute("SELECT value FROM run WHERE key = 'config'").fetchone()
        put("config", f"{rig}.toml", text)


def make_experiments():
    for file in EXPERIMENTS.glob("*.toml"):
        if file.name != "trajectory.toml":
            put("experiment", file.name, file.read_bytes())
    text = (EXPERIMENTS / "trajectory.toml").read_text(encoding="utf-8")
    rows = (EXPERIMENTS / "trajectory.csv").read_text(encoding="utf-8")
    name = next(line.split('"')[1] for line in text.splitlines() if ".csv" in line)
    put("experiment", "trajectory.toml", f'{text}\n[[attached]]\nname = "{name}"\ntext = """\n{rows}"""\n')


def make_csv(programs):
    rows = programs.csv.read_text(encoding="utf-8").splitlines(keepends=True)
    put("csv", "own.csv", "".join(rows[:6]))
    put("csv", "trajectory.csv", (EXPERIMENTS / "trajectory.csv").read_bytes())
    times = range(0, 100, 10)  # ms, two rows a period
    put("csv", "foreign.csv", "t,a,b,m,n,g,h\nms,deg,deg,Nm,Nm,V,V\n" +
        "".join(f"{t},{t / 10},-{t / 20},0.1,0.2,0.001,-0.002\n" for t in times))
    put("csv", "foreign-semicolons.csv", "sep=;\nt;a;b;m;n;g;h\n" +
        "".join(f"{t + t % 3};{t}e-1;-0,5;0,1;0,2;;NaN\n" for t in times))


def make_gains(programs):
    """Patches of a good gains file (fuzz_gains.cpp): one for each of its members."""
    gains = json.loads(programs.gains.read_text(encoding="utf-8"))
    for name, value in gains.items():
        place = f"/{name}"
        while isinstance(value, (list, dict)) and value:
            key = 0 if isinstance(value, list) else next(iter(value))
            place, value = f"{place}/{key}", value[key]
        put("gains", f"{name}.json", json.dumps([{"op": "replace", "path": place, "value": 1.5}]))
    put("gains", "member-removed.json", '[{"op": "remove", "path": "/checks"}]')
    put("gains", "no-gains.json", '{"format": "flexarm-gains-1", "config_hash": "0"}')


def left_records(programs):
    """What a killed program leaves, with the small records only: the target computes the checksums."""
    file = programs.folder / "left.flexarm"
    experiment = programs.folder / "long.toml"
    experiment.write_text('name = "long"\nduration_s = 300.0\n', encoding="utf-8")
    with subprocess.Popen([programs.path("flexarm"), "simulate", "-c", CONFIGS / "hil.toml", "--experiment",
                           experiment, "-o", file, "--json"], stdout=subprocess.DEVNULL) as process:
        while not file.exists() or file.stat().st_size < 300_000:
            time.sleep(0.001)
        process.kill()
    whole = file.read_bytes()
    kept, counts, at = whole[:RECORD_HEADER_BYTES], {}, RECORD_HEADER_BYTES
    while at + 8 <= len(whole):
        kind, payload = struct.unpack_from("<4sI", whole, at)
        end = at + 16 + payload
        counts[kind] = counts.get(kind, 0) + 1
        if payload <= MOST_BYTES and (counts[kind] <= 3 or kind == b"INFO"):
            kept += whole[at:end]
        at = end
    end_record = struct.pack("<4sI", b"END.", 6) + struct.pack("<I", 2) + b"{}" + bytes(8)
    return kept, end_record


def make_logs(programs):
    kept, end = left_records(programs)
    put("log", "left", kept)
    put("log", "ended", kept + end)
    small = programs.folder / "small.flexarm"
    shutil.copy(short_run(programs, "hil", ticks=1), small)
    with sqlite3.connect(small) as log:
        (block,) = log.execute("SELECT records FROM block").fetchone()
        log.execute("UPDATE run SET value = '' WHERE length(value) > 300")
    log.close()
    with sqlite3.connect(small, isolation_level=None) as log:
        log.execute("PRAGMA page_size = 512")
        log.execute("VACUUM")
    log.close()
    put("log", "block", block)
    put("log", "closed", small.read_bytes())


def make_socket():
    """The first byte is the state, 1 is armed (fuzz_socket.cpp)."""
    for number, command in enumerate(COMMANDS):
        state = 1 if command["command"] in ("run", "pluck", "home", "stop", "disarm") else 0
        put("socket", f"{command['command']}-{number}", bytes([state]) + json.dumps(command).encode() + b"\n")
    move = (EXPERIMENTS / "moves.toml").read_text(encoding="utf-8")
    put("socket", "run-moves", b"\1" + json.dumps({"command": "run", "experiment": move}).encode() + b"\n")
    lines = b"".join(json.dumps(command).encode() + b"\n" for command in COMMANDS[:6])
    put("socket", "many-lines", b"\0" + lines)


def make_client():
    """Columns, rows, colours and UTF-8 of the screen, then the answers (fuzz_client.cpp)."""
    status = json.loads((ROOT / "tests/golden/watch/running.json").read_text(encoding="utf-8"))
    tripped = {**status, "state": "Tripped", "run": None, "present": [{"name": "emergency-stop"}],
               "trip": {"name": "bending-strain-1", "text": "link 1", "value": 0.0022, "limit": 0.0019}}
    refusal = {"ok": False, "refusal": "busy", "error": "the arm moves", "remedy": "stop it"}
    for name, answers in (("running", [status]), ("tripped", [tripped]), ("refusal", [refusal]),
                          ("many", [refusal, {}, {"ok": True, "rig": "Pr\u00fcfstand \u81c2"}]),
                          ("escape", [{**status, "rig": "\x1b[2J\n\x7f\x9b", "state": "\r"}])):
        lines = b"".join(json.dumps(answer, ensure_ascii=False).encode() + b"\n" for answer in answers)
        put("client", name, bytes([119, 39, 2]) + lines)


def make_telemetry():
    """Encoders and gauges left out, the rig's name, lost, time, state, then the sample (fuzz_telemetry.cpp)."""
    begin = b"\0\0\3rig" + struct.pack("<Qd", 3, 1764233100.125)
    for name, numbers in (("ones", [1.0]), ("unknown", [float("nan"), float("inf")]), ("large", [-1.7e308, 5e-324])):
        put("telemetry", name, begin + b"\3" + struct.pack(f"<{len(numbers)}d", *numbers) * (300 // len(numbers)))
    put("telemetry", "few-sensors", b"\x0c\x0f\2\xff\"" + bytes(16) + b"\0" + bytes(range(256)) * 8)


def reply(function, payload, how=0):
    """How the peer answers (fuzz_modbus.cpp): below 0x80 with a right header."""
    body = bytes([function, len(payload)]) + payload
    return bytes([how, len(body)]) + body


def make_modbus():
    """The proof of the identity, then three reads, twice: by Open and by an exchange."""
    proof = reply(3, bytes([0x41, 0x42, 0, 7]))
    reads = (reply(2, b"\1"), reply(4, bytes(range(20))), reply(4, struct.pack(">fi", 1.5, -70000)))
    put("modbus", "good", proof + b"".join(reads) * 4)
    put("modbus", "exception", proof + b"".join(reads) + bytes([0, 2, 0x84, 2]) + b"".join(reads))
    put("modbus", "silent-then-good", proof + b"".join(reads) + b"\xf0" + b"".join(reads) * 2)
    put("modbus", "closed", proof + b"".join(reads) + b"\xff" + (proof + b"".join(reads)) * 2)
    put("modbus", "changed-header", proof + b"".join(reads) + reply(2, b"\1", 0x85) + b"\1" + b"".join(reads))


def frame(function, node, data):
    """Of a stranger, by the tables of fuzz_can.cpp."""
    return bytes([function * 8 + node, len(data)]) + data


def make_can():
    good = b"\0" * 40  # frames of the nodes that stay as they are
    put("can", "good", b"\1" + (b"\0" + good) * 4)
    put("can", "from-the-beginning", b"\0" + b"\0" * 400)
    put("can", "emergency", b"\1\1" + frame(1, 1, bytes([0x10, 0x23, 1, 0, 0, 0, 0, 0])) + good + b"\0" + good)
    put("can", "feedback", b"\1\1" + frame(2, 1, bytes([0x37, 2, 1, 2, 3, 4, 5, 6])) + good + b"\0" + good)
    put("can", "booted", b"\1\1" + frame(5, 4, b"\0") + good + b"\x20" + good)
    put("can", "changed", b"\1" + bytes([0, 0xA0, 9, 0xB1, 0xC0, 0xD5, 0xE5, 0xF1]) + good + b"\x10" + good)
    put("can", "off-and-recover", b"\1\x08" + good + b"\x40" + good + b"\x20" + good)


def make_comedi():
    """Bytes of calls that go well, numbers of samples, and values of 12 bits (fuzz_comedi.cpp)."""
    well, nothing = b"\0", b"\0\0"
    proof = well * 4  # both outputs written and read
    scan = well + b"\x0a" + struct.pack("<10H", *range(2000, 2010)) + nothing
    reads = (struct.pack("<H", 258) + well) * 3  # counters, lines
    period = b"\x0c" + well * 2 + scan + reads  # 1 ms, drives on
    begin = proof + well + scan + well * 2 + nothing + reads
    put("comedi", "stream", b"\0\1" + begin + period * 5)
    put("comedi", "large-values", b"\0\1" + begin + b"\x0c" + well * 2 + well + b"\x0a" + b"\xff" * 40 +
        nothing + reads)
    put("comedi", "restart", b"\0\1" + begin + b"\x0c" + well * 2 + b"\xc2" + (b"\x0a" + scan) * 4)
    put("comedi", "gone", b"\0\1" + begin + b"\x0c\xc4" + period)
    single = well * 2 + (struct.pack("<H", 258) + well) * 13
    put("comedi", "single", b"\1\1" + proof + single + (b"\xa4" + single) * 4)
    put("comedi", "lies", b"\0\0" + b"\2\2" * 4 + well * 10 + begin)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="of the programs")
    binaries = arguments.parse_args().bin
    shutil.rmtree(CORPUS, ignore_errors=True)
    with tempfile.TemporaryDirectory() as folder:
        programs = Programs(binaries, Path(folder))
        make_configs(programs)
        make_experiments()
        make_csv(programs)
        make_gains(programs)
        put("calibration", "tare.json", programs.calibration.read_bytes())
        make_logs(programs)
    make_socket()
    make_client()
    make_telemetry()
    make_modbus()
    make_can()
    make_comedi()
    sizes = [file.stat().st_size for file in CORPUS.rglob("*") if file.is_file()]
    print(f"{len(sizes)} files, {sum(sizes)} bytes, the largest {max(sizes)}")
    return os.EX_OK


if __name__ == "__main__":
    sys.exit(main())
