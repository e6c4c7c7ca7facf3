"""The samples of a run as NumPy arrays: the columns of `flexarm export --decoded`."""

from __future__ import annotations

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import ExportFailed

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

EXPORT_S = 120.0  # of the longest log: an hour at 50 Hz takes seconds
STATE_LETTERS = 32


@dataclass(frozen=True)
class RunData:
    """A row a sample. docs/run-logs.md, section "Decoded columns", explains each column."""

    file: Path
    units: dict[str, str]  #: of each column
    columns: dict[str, NDArray[numpy.float64]]  #: all but `state`; NaN: not known
    state: NDArray[numpy.str_]  #: of the safety machine

    def __getitem__(self, column: str) -> NDArray[numpy.float64]:
        """A column, such as data["hub_1_deg"]. @raises KeyError"""
        return self.columns[column]

    def __len__(self) -> int:
        return len(self.state)


def read_run(file: str | Path, *, with_raw: bool = False, program: str | Path = "flexarm",
             within_s: float = EXPORT_S) -> RunData:
    """Reads a log of any kind, also one that is being written: then up to its last commit.

    @param with_raw: the counts as read, too
    @param program: flexarm, of the version that wrote the log or a later one
    @raises ExportFailed: there is no such program or log, or no NumPy
    """
    with tempfile.TemporaryDirectory(prefix="flexarm-") as folder:
        table = Path(folder, "run.csv")
        command = [str(program), "export", str(file), "--decoded", "-o", str(table)]
        _run(command + (["--with-raw"] if with_raw else []), within_s)
        return _read_table(table, Path(file))


def _run(command: list[str], within_s: float) -> None:
    try:
        result = subprocess.run(command, capture_output=True, text=True, errors="replace",
                                timeout=within_s, check=False)
    except OSError as error:
        raise ExportFailed(f"{command[0]} cannot be started ({error.strerror})",
                           "put the folder of flexarm on PATH, or name it as `program`") from error
    except subprocess.TimeoutExpired:
        raise ExportFailed(f"the export took longer than {within_s} s") from None
    if result.returncode != 0:
        raise ExportFailed(result.stderr.strip() or f"{command[0]} ended with {result.returncode}")


def _read_table(table: Path, file: Path) -> RunData:
    try:
        import numpy
    except ImportError:
        raise ExportFailed("run data needs NumPy", "apt install python3-numpy") from None
    with open(table, encoding="utf-8") as lines:
        names = next(lines).rstrip("\n").split(",")
        units = next(lines).rstrip("\n").split(",")
        kinds = [(name, f"U{STATE_LETTERS}" if name == "state" else "f8") for name in names]
        rows = numpy.loadtxt(lines, delimiter=",", dtype=kinds, ndmin=1)
    columns = {name: numpy.ascontiguousarray(rows[name]) for name in names if name != "state"}
    return RunData(file, dict(zip(names, units)), columns, numpy.ascontiguousarray(rows["state"]))
