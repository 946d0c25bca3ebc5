"""A run as a table for other programs: CSV, Parquet, MAT or Excel."""

from __future__ import annotations

import itertools
import math
import re
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from frbcli.errors import InputError, input_error
from frbcli.results.records import Signal, pieces
from frbcli.results.store import Run
from frbcli.results.write import MARK, ROSS, TABLES, harmless_text, mark_table, write, written

if TYPE_CHECKING:
    import pandas as pd

LINES = 50_000  # of CSV that are made at a time
MOST_COMPRESSED = 4_000_000  # samples of a column of MAT
SHEET_ROWS = 1_048_576
MAT_BEGINS, MAT_TEXT = b"MATLAB 5.0 MAT-file", 116  # bytes of its text

COLUMNS = {f"{letter}{axes}": f"{name}_{axes}_{unit}"
           for letter, name, unit in (("k", "stiffness", "N_m"), ("c", "damping", "N_s_m"))
           for axes in ("xx", "xy", "yx", "yy")}  # fmt: skip


def export_run(run: Run, path: str | Path, table_format: str, force: bool = False) -> Path:
    """Write the signals of a run, one column each, to `path` as one of FORMATS; force: also replace a file that frb did
    not write.

    Raises InputError for an unknown format, a file that cannot be written, a run in its place, a format without its
    library, or a run with more samples than a sheet of Excel has rows.
    """
    path = Path(path)
    if table_format not in FORMATS:
        raise _refuse("format", f'there is no format "{table_format}".', f"Use one of {', '.join(FORMATS)}.")
    try:
        with written(path, TABLES[table_format], force=force) as part:
            FORMATS[table_format](run, part)
    except ValueError as error:  # of the libraries, for names or lengths that a format does not have
        raise _refuse("output", f"{path} cannot be written: {error}.", "Choose another format.") from error
    return path


def write_csv(run: Run, target: IO[str]) -> None:
    """Comma-separated, one line of names, all digits of each number; a piece of the run at a time. Raises OSError."""
    import pandas as pd

    target.write(",".join(map(harmless_text, run.signals)) + "\n")
    for first, last in pieces(0, len(run), LINES):
        table = pd.DataFrame({name: signal[first:last] for name, signal in run.signals.items()})
        table.to_csv(target, index=False, header=False, lineterminator="\n")


def _write_csv(run: Run, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as target:
        write_csv(run, target)
    mark_table(path)


def _write_parquet(run: Run, path: Path) -> None:
    if find_spec("pyarrow") is None:
        raise _refuse("format", "Parquet needs the library pyarrow.", "Install it: pip install frbcli[parquet]")
    import pyarrow as pa
    from pyarrow import parquet

    schema = pa.schema([(name, pa.float64()) for name in run.signals], metadata={"writer": MARK})
    with parquet.ParquetWriter(path, schema) as writer:
        for first, last in pieces(0, len(run)):
            columns = {name: signal[first:last] for name, signal in run.signals.items()}
            writer.write_table(pa.table(columns, schema=schema))


def _write_mat(run: Run, path: Path) -> None:
    """One column after the other: the format has each in one piece. Long ones are not compressed, which would take
    several times their memory."""
    from scipy.io import savemat

    columns = _MatColumns(run, {"title": run.title, "status": run.status, "case_text": run.case_text})
    savemat(path, columns, appendmat=False, long_field_names=True, do_compression=len(run) <= MOST_COMPRESSED,
            oned_as="column")  # fmt: skip
    with path.open("r+b") as file:  # the text at the beginning of the format
        file.seek(len(MAT_BEGINS))
        file.write(f", {MARK}".ljust(MAT_TEXT - len(MAT_BEGINS)).encode())


def _write_xlsx(run: Run, path: Path) -> None:
    if find_spec("openpyxl") is None:
        raise _refuse("format", "Excel needs the library openpyxl.", "Install it: pip install frbcli[excel]")
    if len(run) >= SHEET_ROWS:
        problem = f"a sheet of Excel has {SHEET_ROWS} rows, the run {len(run)} samples."
        raise _refuse("format", problem, "Choose another format, or a longer output.step for the run.")
    import pandas as pd

    with pd.ExcelWriter(path, engine="openpyxl") as writer:
        pd.DataFrame({name: signal[:] for name, signal in run.signals.items()}).to_excel(writer, index=False)
    with zipfile.ZipFile(path, "a") as archive:  # a comment, which Excel passes over
        archive.comment = MARK.encode()


class _MatColumns(Mapping[str, Any]):
    """The signals of a run, each read when its turn has come, and some texts, by names that MATLAB takes: letters,
    digits and underscores. The name of a bearing may have others; names that become the same are numbered."""

    def __init__(self, run: Run, texts: Mapping[str, str]) -> None:
        self._texts, self._signals = texts, dict[str, Signal]()
        for name, signal in run.signals.items():
            plain = re.sub(r"\W", "_", name)
            numbered = (f"{plain}_{number}" for number in itertools.count(2))
            while plain in self._signals:
                plain = next(numbered)
            self._signals[plain] = signal

    def __getitem__(self, name: str) -> Any:
        return self._signals[name].values if name in self._signals else self._texts[name]

    def __iter__(self) -> Iterator[str]:
        return itertools.chain(self._signals, self._texts)

    def __len__(self) -> int:
        return len(self._signals) + len(self._texts)


FORMATS: dict[str, Callable[[Run, Path], None]] = {
    "csv": _write_csv, "parquet": _write_parquet, "mat": _write_mat, "xlsx": _write_xlsx
}  # fmt: skip


def _refuse(key: str, problem: str, remedy: str) -> InputError:
    return input_error("export", key, "", problem, remedy)


def ross_files(path: Path, films: Sequence[str]) -> dict[str, Path]:
    """The file of each film: `path` for one alone; for several its name with the film's name added, since ROSS loads
    one bearing from a file and passes over any other."""
    if len(films) == 1:
        return {films[0]: path}
    return {film: path.with_name(f"{path.stem}-{film}{path.suffix}") for film in films}


def write_ross(table: pd.DataFrame, path: Path, force: bool = False) -> None:
    """A TOML table of one film: node n (to be set there), kxx to cyy in N/m and N s/m over the frequency in rad/s.

    table: the rows of the film in BearingSheet.to_pandas over speed; states that were not found are left out. Raises
    InputError if the file cannot be written.
    """
    resting = table[table["status"] == "resting"].sort_values("speed_Hz")
    name = table["film"].iloc[0] or "bearing"
    lines = [f"# {MARK}", f'["BearingElement_{name}"]', "n = 0", f'tag = "{name}"']
    lines += [f"{name} = {_numbers(resting[column])}" for name, column in COLUMNS.items()]
    lines.append(f"frequency = {_numbers(2.0 * math.pi * resting['speed_Hz'])}")
    write(path, ROSS, "\n".join(lines) + "\n", force)


def _numbers(values: pd.Series) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
