"""Runs in HDF5, written as they go. Knows no physics.

At each checkpoint the whole file is written anew next to the old one and replaces it in one step, so that a run
that is killed at any moment leaves a file that opens and holds everything up to its last checkpoint.

The films that a run keeps at some moments of its way (`output.films`), in the arrays of its checkpoint.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.columns import html_table, table_of
from frbcli.errors import did_you_mean
from frbcli.results import parts
from frbcli.results.columns import EVENTS
from frbcli.results.container import USER_BLOCK, check_output, open_whole, refuse, replaced
from frbcli.results.records import (
    LARGEST,
    MOST_EVENTS,
    MOST_SAMPLES,
    TIME,
    GrowingSignal,
    RunPlace,
    Signal,
    Stored,
    StoredArrays,
    keep_small,
    pieces,
    wrong_event,
    wrong_record,
    wrong_text,
    wrong_unit,
    wrong_values,
)

if TYPE_CHECKING:
    import pandas as pd


__all__ = ["Header", "Run", "RunWriter", "Signal", "check_output", "read_run"]

INTERRUPTED = "interrupted"
CLEARANCE_STEP, LOSS = "clearance_step", "loss"  # begin the names of the references that are times of one
CRITICAL_SPEEDS, CRITICAL_SPEED = "critical_speeds", "critical_speed"  # how many there are; begins the name of each
TEXTS = ("title", "command", "case_name", "case_text", "status")
RECORDS = ("versions", "references", "cost", "error", "events")  # kept as JSON text
LARGEST_STATE = 128 * 1024**2  # bytes of a checkpoint; cells have some hundred thousand numbers
LARGEST_REST = 8 * 1024**2  # bytes of a file that are not numbers of signals and checkpoint
UNREADABLE = (OSError, KeyError, ValueError, TypeError, AttributeError, RuntimeError, OverflowError, MemoryError)
MOST_NAMED = 6  # events of a run, in a line of text


@dataclass(frozen=True)
class Header:
    """The head of a run file, which is known before the run starts.

    units: name of each signal -> its unit; references: what pictures and events refer to, in SI, e.g.
    {"clearance_m": 35e-6, "clearance_step_1_s": 3.0}; versions: program -> version.
    """

    title: str
    command: str
    case_name: str
    case_text: str
    units: Mapping[str, str]
    versions: Mapping[str, str] = field(default_factory=dict)
    references: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class Run:
    """A run from its file. `run["eccentricity"]` gives the values (n,) of a signal, in the unit of its name.

    Of a run that was read from a file they are read when they are asked for, and a long run is better read in pieces:
    `run.read("eccentricity", 0, 1000)`. checkpoint: the state from which the run can go on, or None;
    checkpoint_samples: how many samples there were then; remarks: what a reader has to know of it;
    per_minute: whether the speeds of a measurement were given in revolutions per minute.
    """

    path: Path
    title: str
    command: str
    case_name: str
    case_text: str
    versions: dict[str, str]
    signals: dict[str, Signal]
    status: str
    t_end_s: float
    events: list[dict[str, Any]]
    cost: dict[str, Any]
    error: dict[str, Any]
    references: dict[str, float]
    checkpoint: Mapping[str, NDArray[Any]] | None
    checkpoint_samples: int = 0
    remarks: tuple[str, ...] = ()
    per_minute: bool = False

    def __getitem__(self, name: str) -> Array:
        """All values (n,) of a signal. Raises RunFileError if there is no such signal, or its file has changed."""
        return self.signal(name).values

    def read(self, name: str, start: int = 0, stop: int | None = None) -> Array:
        """The values (m,) of a signal from the sample `start` to before `stop`; raises as run[name] does."""
        return self.signal(name)[start:stop]

    def signal(self, name: str) -> Signal:
        """A signal, not yet read. Raises RunFileError if there is no such signal."""
        if name not in self.signals:
            listed = "`frb export RUN.h5` writes all of its signals."
            raise refuse(self.path, f'has no signal "{name}".', did_you_mean(name, self.signals, listed))
        return self.signals[name]

    def __contains__(self, name: str) -> bool:
        return name in self.signals

    def __len__(self) -> int:
        """The number of samples."""
        return min((len(signal) for signal in self.signals.values()), default=0)

    def __repr__(self) -> str:
        """File, end and events: a few lines, however long it is."""
        named = [f"{event['kind']} at {event['speed_Hz']:.4g} Hz" for event in self.events[:MOST_NAMED]]
        more = [f"{len(self.events) - MOST_NAMED} more"] if len(self.events) > MOST_NAMED else []
        return (
            f"Run {self.path}: {self.title}\n{self.command}, {self.status} at {self.t_end_s:.4g} s; "
            f"{len(self.signals)} signals of {len(self)} samples\nevents: {', '.join([*named, *more]) or 'none'}"
            + "".join(f"\n{remark}" for remark in self.remarks)
        )

    def _repr_html_(self) -> str:
        """In a notebook: how it ended, its events."""
        table = table_of(EVENTS, self.events)
        ended = f"{self.status} at {self.t_end_s:.4g} s"
        title = f"{self.title}: {ended}, {len(self)} samples of {len(self.signals)} signals"
        return html_table(title, table.heads(), table.cells(), len(table.rows))

    def to_pandas(self) -> pd.DataFrame:
        """The signals as a table with one column each, named as the signals are."""
        import pandas as pd

        return pd.DataFrame({name: signal.values for name, signal in self.signals.items()})


class RunWriter:
    """Collects a run; writes it whole at each checkpoint. The caller decides when.

    The file exists as soon as the writer does, and says "interrupted" until `finish`.
    """

    def __init__(self, path: str | Path, header: Header) -> None:
        """Raises RunFileError if `path` cannot be written or is a file that frb did not write."""
        self.path = Path(path)
        check_output(self.path)
        self._header = header
        self._signals = {name: GrowingSignal() for name in header.units}
        self._state: dict[str, NDArray[Any]] | None = None
        self._state_samples = 0
        self._cost: dict[str, Any] = {}
        self._error: dict[str, Any] = {}
        self._t_end_s = 0.0
        self._write(INTERRUPTED, [])

    @classmethod
    def resume(cls, path: str | Path) -> RunWriter:
        """A writer that goes on from the last checkpoint of an interrupted run.

        Samples after the checkpoint are dropped: the run computes them again. Raises RunFileError if the file is no
        run, or its run has ended.
        """
        run = read_run(path)
        if run.status != INTERRUPTED:
            raise refuse(run.path, f'cannot be resumed: its status is "{run.status}".', "Start a new run.")
        return cls.of(run)

    @classmethod
    def of(cls, run: Run) -> RunWriter:
        """A writer that holds a run up to its checkpoint, which a run that has ended has at its end."""
        units = {name: signal.unit for name, signal in run.signals.items()}
        header = Header(run.title, run.command, run.case_name, run.case_text, units, run.versions, run.references)
        writer = cls.__new__(cls)
        writer.path, writer._header = run.path, header
        writer._state = None if run.checkpoint is None else dict(run.checkpoint)
        writer._state_samples = run.checkpoint_samples
        writer._signals = {name: GrowingSignal() for name in run.signals}
        for first, last in pieces(0, run.checkpoint_samples):
            writer.append({name: run.read(name, first, last) for name in run.signals})
        writer._cost, writer._error, writer._t_end_s = run.cost, run.error, run.t_end_s
        return writer

    @property
    def samples(self) -> int:
        """The number of samples taken so far."""
        return min(map(len, self._signals.values()), default=0)

    def append(self, chunk: Mapping[str, Array]) -> None:
        """Take the next samples, one array (m,) for each signal of the header. Raises ValueError if they do not fit."""
        if set(chunk) != set(self._signals):
            raise ValueError(f"signals {sorted(chunk)} given, {sorted(self._signals)} announced")
        values = {name: np.array(column, dtype=np.float64) for name, column in chunk.items()}
        if len({column.shape for column in values.values()}) > 1 or any(c.ndim != 1 for c in values.values()):
            raise ValueError("all signals of a chunk need the same shape (m,)")
        for name, column in values.items():
            self._signals[name].append(column)
        keep_small(self._signals.values(), self.path.absolute().parent)

    def checkpoint(
        self,
        state: Mapping[str, NDArray[Any]],
        cost: Mapping[str, Any],
        error: Mapping[str, Any],
        t: float,
        events: Sequence[dict[str, Any]] = (),
    ) -> None:
        """Write the file with all samples so far, the events in them where they are known, and the state at time t (s)
        from which the run can go on."""
        self._state = {name: np.array(values) for name, values in state.items()}
        self._state_samples = self.samples
        self._cost, self._error, self._t_end_s = dict(cost), dict(error), float(t)
        self._write(INTERRUPTED, list(events))

    def finish(
        self,
        status: str,
        cost: Mapping[str, Any],
        error: Mapping[str, Any],
        events: Sequence[dict[str, Any]],
        t: float | None = None,
    ) -> Run:
        """Write the file for the last time; t (s) is where the run ended, by default its last sample."""
        self._cost, self._error = dict(cost), dict(error)
        if t is not None:
            self._t_end_s = float(t)
        elif self.samples and TIME in self._signals:
            self._t_end_s = float(self._signals[TIME][self.samples - 1 : self.samples][0])
        self._write(status, list(events[:MOST_EVENTS]))
        return self.so_far(status, events[:MOST_EVENTS])

    def so_far(self, status: str = INTERRUPTED, events: Sequence[dict[str, Any]] = ()) -> Run:
        """The run with the samples taken so far, without a look at the disk: to find its events, say."""
        header = self._header
        return Run(
            path=self.path,
            title=header.title,
            command=header.command,
            case_name=header.case_name,
            case_text=header.case_text,
            versions=dict(header.versions),
            signals={name: Signal(each.until(len(each)), header.units[name]) for name, each in self._signals.items()},
            status=status,
            t_end_s=self._t_end_s,
            events=list(events),
            cost=self._cost,
            error=self._error,
            references=dict(header.references),
            checkpoint=self._state,
            checkpoint_samples=self._state_samples,
        )

    def _write(self, status: str, events: list[dict[str, Any]]) -> None:
        header = self._header
        texts = {name: getattr(header, name) for name in TEXTS if name != "status"} | {"status": status}
        records: dict[str, Any] = {"versions": dict(header.versions), "references": dict(header.references)}
        records |= {"cost": self._cost, "error": self._error, "events": events}
        texts |= {name: json.dumps(record, default=_plain) for name, record in records.items()}
        with replaced(self.path) as content, h5py.File(content, "w", userblock_size=USER_BLOCK) as file:
            for name, text in texts.items():
                file.create_dataset(name, data=text)
            file.attrs["t_end_s"] = self._t_end_s
            group = file.create_group("signals", track_order=True)
            for name, signal in self._signals.items():
                column = group.create_dataset(name, shape=(len(signal),), dtype=np.float64)
                column.attrs["unit"] = header.units[name]
                for first, last in pieces(0, len(signal)):
                    column[first:last] = signal[first:last]
            if self._state is not None:
                group = file.create_group("checkpoint")
                group.attrs["samples"] = self._state_samples
                for name, state in self._state.items():
                    group.create_dataset(name, data=state)


def _plain(value: Any) -> Any:
    """A numpy number as one of Python's own; JSON knows no other."""
    return value.item() if isinstance(value, np.generic) else str(value)


def read_run(path: str | Path) -> Run:
    """Read a run file; its signals and its checkpoint stay in the file until they are asked for.

    Parameters
    ----------
    path : str or Path
        A file of `runup`, `rundown` or their commands.

    Returns
    -------
    Run
        The run; `run["eccentricity"]` is a signal (n,), in the unit of its name.

    Raises
    ------
    RunFileError
        For anything that is not a complete run.

    Examples
    --------
    >>> import frbcli
    >>> run = frbcli.read_run("run.h5")  # doctest: +SKIP
    >>> run["journal_x_m"]  # doctest: +SKIP
    """
    path = Path(path)
    with open_whole(path) as content:
        try:
            with h5py.File(content, "r") as file:
                return _read(path, file, RunPlace.of(path, content))
        except parts.WrongPart as error:
            raise refuse(path, f"is not a complete run: {error}.", "Run the case again.") from None
        except UNREADABLE as error:
            raise refuse(path, f"is not a complete run: {error}.", "Run the case again.") from error


def _read(path: Path, file: h5py.File, place: RunPlace) -> Run:
    """The run in a file with a valid checksum."""
    group = parts.group(file, "signals")
    columns = {name: parts.array(group, name, place, dimensions=1) for name in parts.names(group, "signals")}
    units = {name: parts.text_attribute(group[name], "unit") for name in columns}
    state, samples = _checkpoint(file, place)
    rest = parts.rest([*columns.values(), *({} if state is None else state).values()], place.size - USER_BLOCK)
    if not 0 <= rest <= LARGEST_REST:
        raise parts.WrongPart("the sizes of its parts do not add up to the size of the file")
    if sum(array.bytes for array in ({} if state is None else state).values()) > LARGEST_STATE:
        raise parts.WrongPart("its checkpoint is too large")
    texts: dict[str, Any] = {name: parts.text(file, name) for name in TEXTS}
    records = {name: parts.record(file, name) for name in RECORDS}
    t_end_s = float(parts.number_attribute(file, "t_end_s"))
    signals = {name: Signal(column, units[name]) for name, column in columns.items()}
    counts = {len(column) for column in columns.values()}
    if len(counts) != 1 or (count := counts.pop()) > MOST_SAMPLES or not 0 <= samples <= count:
        raise parts.WrongPart("its signals are missing, or differ in length")
    if any(column.dtype != np.float64 for column in columns.values()) or not 0.0 <= t_end_s <= LARGEST:
        raise parts.WrongPart("a number has a wrong form")
    wrong = wrong_text(texts) or wrong_record(records) or wrong_unit(units) or wrong_values(signals)
    if wrong or wrong_event(records["events"], signals[TIME]):
        raise parts.WrongPart(f"{wrong or 'events'} has a wrong form")
    return Run(
        path=path,
        signals=signals,
        t_end_s=t_end_s,
        checkpoint=None if state is None else StoredArrays(state),
        checkpoint_samples=samples,
        **texts,
        **records,
    )


def _checkpoint(file: h5py.File, place: RunPlace) -> tuple[dict[str, Stored] | None, int]:
    """Where the arrays of the checkpoint lie, None if there is none, and how many samples there were then."""
    if not parts.has(file, "checkpoint"):
        return None, 0
    group = parts.group(file, "checkpoint")
    state = {name: parts.array(group, name, place) for name in parts.names(group, "checkpoint")}
    return state, int(parts.number_attribute(group, "samples"))


# Arrays: (n, 1 + 3 films) times in s, then angle of the grid in rad and displacement over the clearance of each film;
# (n, films, m, k) oil fractions, and free gas over the oil, of no films where the oil of none carries any; (films, m +
# 1) boundaries of the cells around in rad.
MOMENTS, OIL, GAS, EDGES = "kept_moments", "kept_oil", "kept_gas", "kept_edges"
OF_A_FILM = 3
REMEDY = 'Run the case again with --set \'output.films={from="0.1 s", to="0.2 s"}\', and its own times.'


@dataclass(frozen=True)
class KeptFilm:
    """One film at n moments. times: (n,) s; angles: (n,) of its grid, rad; places: (n, 2) displacement of the journal
    over the clearance; edges: (m + 1,) boundaries of its cells in rad, in its grid; oil: (n, m, k) oil fractions; gas:
    (n, m, k) volume of the free gas at saturation pressure over the oil's volume, None of oil without gas."""

    name: str
    times: Array
    angles: Array
    places: Array
    edges: Array
    oil: Array
    gas: Array | None

    def around(self, frame: int, values: Array, count: int) -> Array:
        """(count, k) values of (m, k) cells at even angles of the lab, from 0 on, in the middles of equal parts."""
        angle = (np.arange(count) + 0.5) * 2.0 * np.pi / count - self.angles[frame] - self.edges[0]
        cells = np.searchsorted(self.edges - self.edges[0], np.mod(angle, 2.0 * np.pi), side="right") - 1
        return np.asarray(values[np.minimum(cells, len(values) - 1)])

    def narrowest(self, frame: int) -> float:
        """The angle phi in rad where H = 1 + d_x sin(phi) - d_y cos(phi) is smallest."""
        x, y = self.places[frame]
        return float(np.mod(np.arctan2(-x, y), 2.0 * np.pi))

    def between(self, from_time: float | None, to_time: float | None) -> tuple[int, int]:
        """The frames from from_time to to_time in s, as the first and that after the last."""
        first = 0 if from_time is None else int(np.searchsorted(self.times, from_time))
        last = len(self.times) if to_time is None else int(np.searchsorted(self.times, to_time, side="right"))
        return first, last


def kept_film(run: Run, films: Sequence[str], name: str | None = None) -> KeptFilm:
    """A film that a run has kept, by default the first one. films: the names of all films of the run, in their order.

    Raises RunFileError if the run has kept none, or none of that name.
    """
    arrays: Mapping[str, Any] = run.checkpoint or {}
    if MOMENTS not in arrays:
        raise refuse(run.path, "has not kept the oil of its films.", REMEDY)
    if name is not None and name not in films:
        choices = ", ".join(films) if any(films) else "Its only film has no name: leave --film out."
        raise refuse(run.path, f'has no film "{name}".', did_you_mean(name, [film for film in films if film], choices))
    film, count = 0 if name is None else films.index(name), len(films)
    moments, oil, gas, edges = (np.asarray(arrays.get(part, np.zeros(0))) for part in (MOMENTS, OIL, GAS, EDGES))
    n = len(moments)
    fits = (
        moments.shape == (n, 1 + OF_A_FILM * count)
        and oil.ndim == 4
        and oil.shape[:2] == (n, count)
        and edges.shape == (count, oil.shape[2] + 1)
        and gas.shape in (oil.shape, (n, 0, *oil.shape[2:]))
        and all(np.isfinite(part).all() for part in (moments, oil, gas, edges))
        and np.all(np.diff(moments[:, 0]) >= 0.0)
    )
    if not fits:
        raise refuse(run.path, "holds films of a wrong form.", "Run the case again.")
    if n == 0:
        raise refuse(run.path, "ended before the films that it was to keep.", REMEDY)
    own = moments[:, 1 + OF_A_FILM * film : 1 + OF_A_FILM * (film + 1)]
    free = gas[:, film] if gas.shape[1] else None
    return KeptFilm(films[film], moments[:, 0], own[:, 0], own[:, 1:], edges[film], oil[:, film], free)
