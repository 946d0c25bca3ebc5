"""Run files that nobody should trust: each is a run of frb, changed in one way, and sealed as frb seals its own.

`hostile(kind, seed, base)` makes one of them; `KINDS` names the ways. The same seed makes the same file.
"""

import io
import json
import random
from collections.abc import Callable
from typing import Any

import h5py
import numpy as np

from frbcli.results.container import MAGIC, USER_BLOCK, seal

Change = Callable[[h5py.File, random.Random], None]

SIGNALS = ("time_s", "speed_Hz", "eccentricity", "journal_x_m", "journal_y_m", "disk_x_m", "disk_y_m")
ESCAPES = ("\x1b[31mred", "\x1b]0;title\x07", "a\x00b", "\x9b2J", "a\rb", "\u202ereversed", "\x7f", "line\nline")
LONG = "W" * 200

CHANGES: dict[str, Change] = {}


def change(function: Change) -> Change:
    """Enter a change under its name."""
    CHANGES[function.__name__] = function
    return function


def hostile(kind: str, seed: int, base: bytes) -> bytes:
    """The content of a file of a kind, made of the run file `base`."""
    chance = random.Random(f"{kind} {seed}")
    if kind in BYTES:
        return BYTES[kind](base, chance)
    content = io.BytesIO(base)
    with h5py.File(content, "r+") as file:
        CHANGES[kind](file, chance)
    return sealed(content.getvalue())


def sealed(content: bytes) -> bytes:
    file = io.BytesIO(content)
    seal(file)
    return file.getvalue()


def put(file: h5py.File, name: str, data: Any, **how: Any) -> None:
    """A part in place of one, with the attributes of that."""
    told = dict(file[name].attrs) if name in file else {}
    if name in file:
        del file[name]
    if data is None:
        file.create_dataset(name, **how)
    else:
        file.create_dataset(name, data=data, **how)
    file[name].attrs.update(told)


def some(file: h5py.File, chance: random.Random) -> list[str]:
    """One signal, or all."""
    names = [f"signals/{name}" for name in file["signals"]]
    return chance.choice([[chance.choice(names)], names])


# --- the sizes and forms of data ---


@change
def rows_without_data(file: h5py.File, chance: random.Random) -> None:
    rows = chance.choice([10**9, 10**10, 10**12, 2**59])
    for name in some(file, chance):
        put(file, name, None, shape=(rows,), dtype="f8")


@change
def chunked(file: h5py.File, chance: random.Random) -> None:
    rows = chance.choice([501, 10**6, 10**9, 10**12])
    for name in some(file, chance):
        put(file, name, None, shape=(rows,), dtype="f8", chunks=(min(rows, 10**5),), maxshape=(None,))


@change
def compressed(file: h5py.File, chance: random.Random) -> None:
    how = chance.choice([{"compression": "gzip"}, {"compression": "lzf"}, {"shuffle": True}, {"fletcher32": True}])
    for name in some(file, chance):
        put(file, name, np.zeros(chance.choice([501, 300_000])), **how)


@change
def other_type(file: h5py.File, chance: random.Random) -> None:
    types: list[Any] = ["c16", "f4", "f2", ">f8", "i8", "u1", "?", "S8", [("a", "f8")], np.dtype(("f8", (3,)))]
    types += [h5py.special_dtype(enum=("i4", {"a": 1})), h5py.ref_dtype, h5py.vlen_dtype("f8"), h5py.string_dtype()]
    dtype = chance.choice(types)
    for name in some(file, chance):
        put(file, name, None, shape=(501,), dtype=dtype)


@change
def other_shape(file: h5py.File, chance: random.Random) -> None:
    shape = chance.choice([(), (0,), (1,), (2,), (500,), (501, 2), (1,) * 32, (0, 10**9), (501, 0)])
    for name in some(file, chance):
        put(file, name, np.zeros(shape))


@change
def empty_or_group(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice([*file, *some(file, chance)])
    if chance.random() < 0.5:
        put(file, name, h5py.Empty("f8"))
    else:
        del file[name]
        file.create_group(name)


@change
def missing(file: h5py.File, chance: random.Random) -> None:
    for name in chance.sample([*file, *(f"signals/{name}" for name in file["signals"])], chance.choice([1, 1, 2, 5])):
        if name in file:
            del file[name]


@change
def checkpoint_form(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice(["numbers", "q", "wet", "clock", "film_samples", "new"])
    data: Any = chance.choice([np.zeros(3), np.full(17, np.nan), np.zeros((1000, 1000)), "text", np.zeros((5, 0)), 3.0])
    put(file, f"checkpoint/{name}", data)
    if chance.random() < 0.3:
        put(file, f"checkpoint/{name}", None, shape=(10**11,), dtype="f8")


@change
def checkpoint_numbers(file: h5py.File, chance: random.Random) -> None:
    numbers = file["checkpoint/numbers"]
    for _ in range(chance.choice([1, 1, 3])):
        at, value = chance.randrange(len(numbers)), chance.choice([-1.0, 1e300, np.nan, 1e9, 0.5, 0.0, -np.inf, 1e-300])
        numbers[at] = value


@change
def checkpoint_state(file: h5py.File, chance: random.Random) -> None:
    for name in chance.sample(["q", "v", "a", "past", "film_samples", "clock", "errors"], 2):
        data = file["checkpoint"][name]
        data[...] = chance.choice([np.nan, 1e300, -1e15, 1e3, 0.0, np.inf])


# --- where data lie ---


@change
def soft_or_external_link(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice([*file, *some(file, chance), "checkpoint/numbers"])
    links: list[Any] = [h5py.SoftLink("/signals/time_s"), h5py.SoftLink("/nowhere"), h5py.SoftLink(f"/{name}")]
    links += [h5py.ExternalLink(path, "/signals") for path in ("/dev/zero", "/etc/passwd", "run.h5", "none.h5")]
    del file[name]
    file[name] = chance.choice(links)


@change
def cycle_or_shared(file: h5py.File, chance: random.Random) -> None:
    how = chance.randrange(3)
    if how == 0:
        del file["signals"]
        file["signals"] = file["/"]
    elif how == 1:
        file["checkpoint/more"] = file["checkpoint"]
    else:
        for name in list(file["signals"])[1:]:
            told = dict(file["signals"][name].attrs)
            del file["signals"][name]
            file["signals"][name] = file["signals/time_s"]
            file["signals"][name].attrs.update(told)


@change
def data_elsewhere(file: h5py.File, chance: random.Random) -> None:
    for name in some(file, chance):
        if chance.random() < 0.5:
            put(file, name, None, shape=(501,), dtype="f8", external=[("/etc/passwd", 0, h5py.h5f.UNLIMITED)])
        else:
            layout = h5py.VirtualLayout(shape=(501,), dtype="f8")
            layout[:] = h5py.VirtualSource(chance.choice([".", "other.h5"]), "signals/time_s", shape=(501,))
            told = dict(file[name].attrs)
            del file[name]
            file.create_virtual_dataset(name, layout)
            file[name].attrs.update(told)


# --- values ---


@change
def one_value(file: h5py.File, chance: random.Random) -> None:
    value = chance.choice([np.nan, np.inf, -np.inf, 1e300, -1e300, 1e16, 1e15, -1e15, 1e-320, 1e8, -5.0])
    for name in some(file, chance):
        file[name][chance.randrange(len(file[name]))] = value


@change
def all_values(file: h5py.File, chance: random.Random) -> None:
    count = len(file["signals/time_s"])
    noise = np.random.default_rng(chance.randrange(2**32))
    size = chance.choice([1e-320, 1e-30, 1e-6, 1.0, 1e6, 1e15])
    forms = [np.full(count, size), np.zeros(count), size * noise.normal(size=count), size * (-1.0) ** np.arange(count),
             size * np.arange(count), np.full(count, -size)]  # fmt: skip
    names = some(file, chance)
    for name in names:
        if name != "signals/time_s" or len(names) == 1:
            file[name][...] = np.clip(chance.choice(forms), -1e15, 1e15)


@change
def times(file: h5py.File, chance: random.Random) -> None:
    count = len(file["signals/time_s"])
    even = np.arange(count, dtype=float)
    forms = [even[::-1], even**2, np.zeros(count), even * 1e-12, even * 1e-300, even * 1e6, 1e9 + even * 1e-4, -even,
             1e15 + even, np.where(even == 3, 3.5, even), even * 1e-3 - 5.0, even * 1e12, np.repeat(even, 2)[:count]]
    file["signals/time_s"][...] = chance.choice(forms)  # fmt: skip


@change
def speeds(file: h5py.File, chance: random.Random) -> None:
    count = len(file["signals/time_s"])
    top = chance.choice([1e300, 1e15, 1e7, 1e6, 1e5, 1e-9, 0.0, -300.0])
    file["signals/speed_Hz"][...] = chance.choice([np.full(count, top), np.linspace(0.0, top, count)])


# --- names and units ---


@change
def signal_names(file: h5py.File, chance: random.Random) -> None:
    names = ["unknown", "a/b", "..", "eccentricity_" + "W" * 200, "disk_\x1b[31m_x_m", "journal_left_x_m", "ring_x_m"]
    names += ["ring_speed_Hz", "oil_fraction", "eccentricity_left", "disk_z_m", "eccentricity_ä", "disk_wheel_x_m"]
    for name in chance.sample([name for name in names if name not in file["signals"]], chance.choice([1, 1, 3])):
        file[f"signals/{name}"] = np.zeros(len(file["signals/time_s"]))
        if name in file["signals"]:
            file["signals"][name].attrs["unit"] = chance.choice(["m", "", "Hz", "s"])


@change
def many_signals(file: h5py.File, chance: random.Random) -> None:
    count, kind = len(file["signals/time_s"]), chance.choice(["eccentricity_{}", "disk_{}_x_m", "oil_fraction_{}"])
    for number in range(chance.choice([30, 100, 600])):
        name = f"signals/{kind.format(number)}"
        file[name] = np.linspace(0.0, 1.0, count)
        file[name].attrs["unit"] = "m" if name.endswith("_m") else ""


@change
def units(file: h5py.File, chance: random.Random) -> None:
    for name in some(file, chance):
        del file[name].attrs["unit"]
        unit: Any = chance.choice([None, "\x1b[31m", "kg", 3.0, np.zeros(5), "W" * 60_000, b"\xff", ["m", "m"]])
        if unit is not None:
            file[name].attrs["unit"] = unit


@change
def attributes(file: h5py.File, chance: random.Random) -> None:
    value: Any = chance.choice([np.nan, np.inf, -1.0, 1e300, "text", np.zeros(3), 3 + 4j, h5py.Empty("f8"), 10**9, 0.5])
    if chance.random() < 0.5:
        file.attrs["t_end_s"] = value
    else:
        file["checkpoint"].attrs["samples"] = value


# --- texts and records ---


@change
def labels(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice(["title", "command", "case_name", "status"])
    texts = [*ESCAPES, LONG, "W" * 10**6, "$\\frac{1}{", "$x$ $", "", "漢字 🎉", "finished", "contact"]
    text = chance.choice(texts).replace("\0", "\b")  # which HDF5 would take for the end
    put(file, name, text)


@change
def text_forms(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice(["title", "case_text", "status", "events", "cost"])
    data: Any = chance.choice([3.0, np.zeros(3), b"\xff\xfe", np.array(["a", "b"], dtype="S1"), "W" * 3_000_000])
    put(file, name, data)


@change
def case_text(file: h5py.File, chance: random.Random) -> None:
    put(file, "case_text", chance.choice([
        "a = " + "[" * 1000 + "]" * 1000, "a = 1" + "0" * 5000, "a." * 20_000 + "b = 1", "[" + "a." * 30_000 + "b]",
        "not toml [", "film = 3", "[film]\ncavitation = 3", "[film]\ncavitation = []", "[film]\ncavitation = ['a']",
        "[film]\ncavitation = '\\u001b[31m'", "[film]\ntheory = {}", "[film]\ncavitation = 'elrod'", "x" * 300_000,
        "\x1b[31m = 3", "[[film]]\n" * 3000, "a = 1979-99-99", "a = nan", "\ufeff[film]", "é = 1",
        "a = '''" + "\n" * 9999,
        "[rotor]\nkind = 'turbocharger'\nfile = '/dev/zero'", "[film.cavitation]\n", "[film.cavitation.two-phase]\n",
    ]))  # fmt: skip


def event(**changed: Any) -> dict[str, Any]:
    told = {"kind": "onset", "film": None, "t_s": 0.3, "speed_Hz": 90.0, "frequency_Hz": 45.0, "frequency_ratio": 0.5}
    return told | changed


@change
def events(file: h5py.File, chance: random.Random) -> None:
    odd = chance.choice([{"film": chance.choice([*ESCAPES, LONG, "", "$\\x$", 3, [], "left_inner"])},
                         {"kind": chance.choice([*ESCAPES, LONG, "", "Onset", "resonance", None, {}])},
                         {"t_s": chance.choice([1e300, -1.0, "x", None, 1e9, True, 0.0, 10**400, 0.2500001])},
                         {"speed_Hz": chance.choice([1e300, "x", None, -90.0, 0.0, [1]])},
                         {"frequency_ratio": chance.choice(["x", 1e300, -1e15, {}])},
                         {"more": chance.choice(["\x1b[31m", [1] * 9, 3, "text", {"a": {}}])}])  # fmt: skip
    found = [event(**odd) for _ in range(chance.choice([1, 1, 60, 10_000, 100_000]))]
    if chance.random() < 0.2:
        del found[0][chance.choice(list(found[0]))]
    put(file, "events", json.dumps(found))


@change
def many_events(file: h5py.File, chance: random.Random) -> None:
    kinds = chance.choice([["contact"], ["onset", "offset", "lock-in", "critical-speed", "clearance-step"]])
    films = chance.choice([[None], ["inner", "outer"], [f"film-{number}" for number in range(50)]])
    count = chance.choice([51, 1000, 10_000, 10_001])
    put(file, "events", json.dumps([
        event(kind=chance.choice(kinds), film=chance.choice(films), t_s=0.5 * number / count) for number in range(count)
    ]))  # fmt: skip


@change
def record_text(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice(["versions", "references", "cost", "error", "events"])
    put(file, name, chance.choice([
        "[" * 1000, "[" * 100_000 + "]" * 100_000, '{"a":' * 2000 + "1" + "}" * 2000, "1" * 5000,
        '{"a": ' + "1" * 5000 + "}", "", "null", "[]", "3", '"x"', "{", '{"a": 1e999}', '{"a": NaN}', "{}{}",
        "[[]]", "{" + ", ".join(f'"key_{number}": 1' for number in range(60_000)) + "}", '{"\\u001b[31m": 1}',
        '{"a": "\\u001b[31m"}', '{"a": {"b": {}}}', '{"a": true}', '{"a": [1, 2]}', '{"": 1}', '{"a": "' + LONG + '"}',
    ]))  # fmt: skip


@change
def record_values(file: h5py.File, chance: random.Random) -> None:
    name = chance.choice(["cost", "error", "references"])
    record = json.loads(file[name].asstr()[()])
    for _ in range(chance.choice([1, 1, 3])):
        key = chance.choice([*record, "new", "clearance_m", "clearance_step_1_s", "eccentricity", "oil_in_m3"])
        if chance.random() < 0.3:
            record.pop(key, None)
        else:
            record[key] = chance.choice([None, "x", "\x1b[31m", [], {}, True, 0, -1, 1e300, -1e-300, 10**30, 1e-9, 3.0])
    put(file, name, json.dumps(record))


@change
def status_and_cost(file: h5py.File, chance: random.Random) -> None:
    put(file, "status", chance.choice(["finished", "contact", "starved", "not-converged", "interrupted", "weird"]))
    put(file, "cost", chance.choice(["{}", '{"cpu_s": 1.0}']))
    put(file, "events", "[]")


# --- bytes ---


def _metadata_bytes(base: bytes, chance: random.Random) -> bytes:
    """Bytes of HDF5's own changed, in the part of the file that holds no numbers."""
    content, own = bytearray(base), np.ones(len(base), dtype=bool)
    with h5py.File(io.BytesIO(base), "r") as file:
        for data in (*file["signals"].values(), *file["checkpoint"].values()):
            begin = data.id.get_offset() or 0
            own[begin : begin + data.nbytes] = False
    own[: USER_BLOCK + 8] = False
    places = np.flatnonzero(own)
    for _ in range(chance.choice([1, 1, 2, 8])):
        at = int(places[chance.randrange(len(places))])
        content[at] = chance.choice([0, 1, 255, 127, content[at] ^ (1 << chance.randrange(8)), chance.randrange(256)])
    return sealed(bytes(content))


def _cut(base: bytes, chance: random.Random) -> bytes:
    """A file that ends too early, sealed or not."""
    content = base[: chance.randrange(len(base))]
    return sealed(content) if chance.random() < 0.5 and len(content) > USER_BLOCK else content


def _longer(base: bytes, chance: random.Random) -> bytes:
    """A file with more behind it."""
    content = base + bytes(chance.choice([1, 1000, 20_000_000]))
    return sealed(content) if chance.random() < 0.7 else content


def _head(base: bytes, chance: random.Random) -> bytes:
    """A user block that says something else."""
    head = chance.choice([
        b"frb-run 2 length=1 crc32=00000000\n", MAGIC, MAGIC + b"length=" + b"9" * 400, MAGIC + b"length=-1 crc32=0\n",
        MAGIC + b"\x1b[31m", b"", b"\x89HDF\r\n\x1a\n", base[:40].upper(), base[:30] + b" " + base[30:50],
    ])  # fmt: skip
    return head.ljust(USER_BLOCK, b"\0") + base[USER_BLOCK:]


BYTES: dict[str, Callable[[bytes, random.Random], bytes]] = {
    "metadata_bytes": _metadata_bytes, "cut": _cut, "longer": _longer, "head": _head,
}  # fmt: skip
KINDS = (*CHANGES, *BYTES)
