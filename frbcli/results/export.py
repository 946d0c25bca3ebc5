"""A run as a table for other programs: CSV, Parquet or MAT."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import IO

from frbcli.errors import Fault, InputError
from frbcli.results.container import is_run
from frbcli.results.place import remove_part, wrong_place
from frbcli.results.store import Run


def export_run(run: Run, path: str | Path, table_format: str) -> Path:
    """Write the signals of a run, one column each, to `path` as "csv", "parquet" or "mat".

    Raises InputError for an unknown format, a file that cannot be written, a run in its place, or if Parquet is asked
    for without its library.
    """
    path = Path(path)
    if table_format not in FORMATS:
        raise _refuse("format", f'there is no format "{table_format}".', f"Use one of {', '.join(FORMATS)}.")
    if wrong := wrong_place(path):
        raise _refuse("output", f"{path} {wrong[0]}", wrong[1])
    try:
        if path.is_file() and is_run(path):
            raise _refuse("output", f"{path} is a run of frb; it is left alone.", "Choose another name with -o.")
    except OSError as error:
        raise _refuse("output", f"{path} cannot be used: {error}.", "Choose another place with -o.") from error
    try:
        FORMATS[table_format](run, path)
    except (OSError, ValueError) as error:
        remove_part(path)
        raise _refuse("output", f"{path} cannot be written: {error}.", "Choose another place with -o.") from error
    return path


def write_csv(run: Run, target: Path | IO[str]) -> None:
    """Comma-separated, one line of names, all digits of each number. Raises OSError."""
    run.to_pandas().to_csv(target, index=False, lineterminator="\n")


def _write_parquet(run: Run, path: Path) -> None:
    if find_spec("pyarrow") is None:
        raise _refuse("format", "Parquet needs the library pyarrow.", "Install it: pip install frbcli[parquet]")
    run.to_pandas().to_parquet(path, index=False)


def _write_mat(run: Run, path: Path) -> None:
    from scipy.io import savemat

    # MATLAB takes letters, digits and underscores only; the name of a bearing may have others
    columns = {re.sub(r"\W", "_", name): signal.values for name, signal in run.signals.items()}
    texts = {"title": run.title, "status": run.status, "case_text": run.case_text}
    savemat(path, columns | texts, appendmat=False, long_field_names=True, do_compression=True, oned_as="column")


FORMATS: dict[str, Callable[[Run, Path], None]] = {"csv": write_csv, "parquet": _write_parquet, "mat": _write_mat}


def _refuse(key: str, problem: str, remedy: str) -> InputError:
    return InputError("export", (Fault(key=key, value="", line=None, problem=problem, remedy=remedy),))
