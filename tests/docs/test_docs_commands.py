"""Every command line that the documents show is one that `frb` takes: its options, its case, its settings, its plan."""

import importlib.util
import re
import shlex
import shutil
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click
import pytest
from paths import ROOT

import frbcli
from frbcli.case.schema import Case
from frbcli.cli.main import COMMANDS, frb, run
from frbcli.errors import InputError
from frbcli.results.store import Run
from frbcli.scene.planning.kinematic_plan import kinematic_plan

OWN_TEST = ("command-line.md",)  # its lines are run by test_command_line.py
PLACEHOLDERS = {
    "CASE": "my.toml",
    "RUN.h5": "run.h5",
    "NAME": "jeffcott",
    "FILE": "out.txt",
    "DIR": "study",
}
WRONG_ON_PURPOSE = ("bearing.clearnce",)
EXTRAS = {"parquet": "pyarrow"}  # words of lines, and the library that these need
NO_LINE = ("...", "KEY=")  # shows a form, not a line
LONGEST_s, MOMENT = 60.0, "50 ms"
SHAKEN = """
[[force]]
at = "disk"
force = ["1 N", "0 N"]

[[force]]
at = "disk"
force = ["5 N", "0 N"]
order = 2

[base]
acceleration = ["2 m/s^2", "0 m/s^2"]
order = 1
speed = "50 Hz"
"""


def lines_of(page: Path) -> Iterator[str]:
    """The command lines in blocks of code and within sentences."""
    text = page.read_text(encoding="utf-8")
    for block in re.findall(r"```[a-z]*\n(.*?)```", text, flags=re.DOTALL):
        for line in block.replace("\\\n", " ").splitlines():
            if match := re.match(r"^(?:\$ )?(frb .*)$", line):
                yield match[1]
    for line in re.findall(r"`(frb [^`]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        if len(line.split()) > 2:  # "frb runup" alone names the command
            yield line


def shown() -> list[str]:
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    lines = (line for page in pages if page.name not in OWN_TEST for line in lines_of(page))
    # of those that differ by a comment, one
    return list({tuple(words_of(line)): line for line in lines if not any(form in line for form in NO_LINE)}.values())


def words_of(line: str) -> list[str]:
    """The arguments behind `frb`, up to a pipe, a redirection or a comment; placeholders stand for files."""
    words = shlex.split(line, comments=True)[1:]
    ends = [words.index(sign) for sign in ("|", ">", "&&") if sign in words]
    # A run is a measurement, too: a long one, in which orders can be told.
    measured = {"RUN.h5": "jeffcott.h5", "FILE": "jeffcott.h5"} if {"--measured", "--order"} & set(words) else {}
    listed = {"FILE": "measured.csv"} if "--columns" in words or "--list" in words else {}
    supported = {"RUN.h5": "supported.h5"} if "support" in words else {}
    shaken = {"CASE": "shaken.toml"} if "--excitation" in words else {}
    known = PLACEHOLDERS | measured | listed | supported | shaken
    return [known.get(word, word) for word in words[: min(ends, default=len(words))]]


def write_measurement(run: Run, file: Path) -> None:
    table = run.to_pandas()[["time_s", "speed_Hz", "journal_x_m", "journal_y_m"]]
    table[["journal_x_m", "journal_y_m"]] *= 1e6
    table = table.set_axis(["t", "n", "x", "y"], axis=1)
    turns = (table.n.cumsum() * (table.t[1] - table.t[0])) % 1.0
    more = {"t_s": table.t, "x_um": table.x, "y_um": table.y, "key": 5.0 * (turns < 0.2)}
    table.assign(**more).to_csv(file, index=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with a case and with the runs that the lines name."""
    folder = tmp_path_factory.mktemp("documents")
    settings = ["film.theory=short", "speed.duration=50 ms"]
    case = frbcli.load_case("jeffcott", settings)
    (folder / "my.toml").write_text(case.source_text, encoding="utf-8")
    (folder / "shaken.toml").write_text(case.source_text + SHAKEN, encoding="utf-8")
    page = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
    text = "\n".join(re.findall(r"```toml\n(.*?)```", page, re.DOTALL))
    (folder / "turbo.toml").write_text(text, encoding="utf-8")
    frbcli.runup(case, folder / "run.h5")
    for name, file, unbalance in (("jeffcott", "measured", "3 g*mm"), ("trial", "trial", "5 g*mm")):
        longer = frbcli.load_case("jeffcott", [settings[0], "speed.duration=3 s", f"rotor.unbalance={unbalance}"])
        write_measurement(frbcli.runup(longer, folder / f"{name}.h5"), folder / f"{file}.csv")
    rings = frbcli.load_case_text(text, ["speed.duration=20 ms", "speed.to=100 Hz"], name="turbo")
    ringed = frbcli.runup(rings, folder / "turbo.h5").path
    shutil.copy(ringed, folder / "ring.h5")
    on_supports = [f"bearing.support.{key}" for key in ("mass=1 kg", "stiffness=50 kN/mm", "damping=100 N*s/m")]
    frbcli.runup(frbcli.load_case("jeffcott", [*settings, *on_supports]), folder / "supported.h5")
    named = {word for line in shown() for word in words_of(line) if word.endswith(".h5")}
    for name in named - {"run.h5", "jeffcott.h5", "turbo.h5", "ring.h5", "supported.h5"}:
        shutil.copy(folder / "run.h5", folder / name)
    return folder


def commands_of(words: list[str]) -> tuple[str, list[str]]:
    return words[0], words[1:]


@pytest.mark.parametrize("line", shown())
def test_a_line_is_one_that_frb_takes(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    name, words = commands_of(words_of(line))
    if name.startswith("-"):
        return
    assert name in COMMANDS
    command = frb.get_command(click.Context(frb), name)
    assert command is not None
    if any(key in line for key in WRONG_ON_PURPOSE):
        with pytest.raises(InputError):
            command.make_context(name, words)
        return
    if "--help" in words:
        return
    given = command.make_context(name, words).params
    case = given.get("case")
    if name in ("runup", "rundown", "check", "accuracy", "compare") and isinstance(case, Case):
        frbcli.make_plan(case)
    if name in ("rotation", "squeeze", "whirl") and isinstance(case, Case):
        kinematic_plan(case, None, name)


@pytest.fixture(scope="module")
def heated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with heat: its kernels take a minute to compile, which the lines of the gate do not need."""
    case = frbcli.load_case("floating-ring-heat", ["speed.duration=20 ms", "speed.to=100 Hz"])
    path = frbcli.runup(case, tmp_path_factory.mktemp("heat") / "heat.h5").path
    return Path(path)


def shortened(words: list[str]) -> list[str]:
    """The line with run-ups of a moment, unless it says how long they take: what comes after them runs, too."""
    said = any(word.startswith(("speed.duration", "output.films", "--until", "--measured")) for word in words)
    if words[0] not in ("runup", "rundown", "compare", "sweep", "accuracy") or said or "--stability" in words:
        return words
    down = ("speed.hold=10 ms", f"speed.down_duration={MOMENT}") if words[0] == "rundown" else ()
    return [*words, *(word for each in (f"speed.duration={MOMENT}", *down) for word in ("--set", each))]


@contextmanager
def interrupted_after(seconds: float) -> Iterator[None]:
    """Interrupts this process as a user does after so much CPU time."""
    before = signal.signal(signal.SIGPROF, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@pytest.mark.nightly
@pytest.mark.parametrize("line", [line for line in shown() if "dask" not in line])
def test_a_line_runs(
    line: str, folder: Path, heated: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """What takes longer than LONGEST_s is interrupted, and says so."""
    for word, library in EXTRAS.items():
        if word in line and importlib.util.find_spec(library) is None:
            pytest.skip(f"{library} is not installed")
    place = shutil.copytree(folder, tmp_path / "here")
    shutil.copy(heated, place / heated.name)
    words = words_of(line)
    if "cold.h5" in words and "heat" in words:
        shutil.copy(heated, place / "cold.h5")
    for word, name, shipped, more in (
        ("engine.h5", "engine.h5", "turbocharger-engine", ()),
        ("axial", "run.h5", "turbocharger-car-thrust", ()),
        ("pin", "run.h5", "floating-ring", ('bearing.pin={radius="16 mm", play="0.1 mm", stiffness="1e6 N/m"}',)),
        ("supply-pressure", "run.h5", "jeffcott", ('bearing.supply.pressure=[["0 s", "1 bar"], ["1 s", "2 bar"]]',)),
        ("film", "onset.h5", "turbocharger-low-supply", ('output.films={ from="5 ms", to="0.2 s" }', "speed.to=60 Hz")),
    ):
        if word in words and words[0] != "runup":
            given = ["speed.duration=0.2 s" if more else "speed.duration=20 ms", *more]
            frbcli.runup(frbcli.load_case(shipped, given), place / name, force=True)
    if words[0] in ("runup", "rundown"):
        words.append("--force")
    if words[0] == "cases" and "-o" in words:  # frb does not write over a file of one's own
        (place / words[words.index("-o") + 1]).unlink(missing_ok=True)
    monkeypatch.chdir(place)
    with interrupted_after(LONGEST_s):
        code = run(shortened(words))
    expected = (2,) if any(key in line for key in WRONG_ON_PURPOSE) else (0, 3, 130)
    assert code in expected, capsys.readouterr().err


NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
OF_THE_MACHINE = ("CPU time", "CPU s", "with --uncertainty", "predicted", "film solves", "of the cells", "target")
CLOSE = 0.03  # of numbers that are shown: they are of another processor


def shown_outputs() -> Iterator[tuple[str, str, list[str], list[float], str]]:
    """Each block that shows a command with its output: page, command, lines, the speeds that the sentences up to the
    next one quote, and the case that the page has so far."""
    for page in sorted((ROOT / "docs").glob("*.md")):
        case = ""
        blocks = re.split(r"```([a-z]*)\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)[1:]
        for place, (kind, block) in enumerate(zip(blocks[::3], blocks[1::3], strict=True)):
            case += f"{block}\n" if kind == "toml" and page.name == "tutorial.md" else ""
            first, _, rest = block.partition("\n")
            if first.startswith("$ frb "):
                lines = [line.rstrip() for line in rest.splitlines() if line.strip(" ─") not in ("", "...")]
                yield page.name, first[2:], lines, quoted(blocks[3 * place + 1 :]), case


def quoted(blocks: Sequence[str]) -> list[float]:
    """The speeds of the sentences behind a block of a page, up to the next block that shows a command. blocks: words of
    a block, then sentences and the kind of the next one in turn."""
    sentences = ""
    for words, behind in zip(blocks[::3], blocks[1::3], strict=True):
        if sentences and words.startswith("$ frb "):
            break
        sentences += f"{behind} "
    return [float(number) for number in re.findall(r"(\d+(?:\.\d+)?) (?:Hz|rpm)\b", sentences)]


def alike(shown: str, printed: str) -> bool:
    """Whether two lines have the same words, and numbers that differ by less than CLOSE or by one in the last place."""
    if NUMBER.sub("#", " ".join(shown.split())) != NUMBER.sub("#", " ".join(printed.split())):
        return False
    for one, other in zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True):
        mantissa, _, exponent = one.partition("e")
        digit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        if abs(float(one) - float(other)) > max(CLOSE * abs(float(one)), 1.01 * digit):
            return False
    return True


def test_lines_of_other_numbers_or_words_are_not_alike() -> None:
    assert alike("onset 171.5  0.62", "onset   172.0   0.63")
    assert not alike("onset 171.5", "onset 190.0")
    assert not alike("onset 171.5", "offset 171.5")
    assert not alike("error 1.1e-03", "error 1.1e-02")


def unknown_numbers(quoted_numbers: Sequence[float], printed: str) -> list[float]:
    """Those that are not close to any number of an output."""
    numbers = [float(number) for number in NUMBER.findall(printed)]
    return [each for each in quoted_numbers if all(abs(each - number) > CLOSE * each for number in numbers)]


# Sentences that quote what a command prints, and the command
QUOTES = (
    ("limit-cycles.md", "The Hopf point at 177.19 Hz", "stability jeffcott"),
    ("limit-cycles.md", "the fold at 170.81 Hz", "limit-cycles jeffcott"),
    ("heat.md", "the inner film has 142 degC, the outer one 93 degC, and the oil carries 612",
     "stability floating-ring-heat --speed '900 Hz'"),
)  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize(("page", "words", "line"), QUOTES)
def test_sentences_quote_what_commands_print(
    page: str, words: str, line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    assert words in " ".join((ROOT / "docs" / page).read_text(encoding="utf-8").split())
    monkeypatch.chdir(tmp_path)
    assert run([*shlex.split(line), "--no-picture"]) == 0
    assert unknown_numbers([float(number) for number in NUMBER.findall(words)], capsys.readouterr().out) == []


@pytest.mark.nightly  # the time loop of the tutorial is no other test's
def test_pages_show_what_their_commands_print(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every line and number of the outputs in the pages, but for those of the machine that computed them; and of the
    sentences behind them every speed."""
    monkeypatch.chdir(tmp_path)
    outputs = list(shown_outputs())
    assert len(outputs) >= 3
    for page, line, shown, speeds, case in outputs:
        Path("turbo.toml").write_text(case, encoding="utf-8")
        run([*shlex.split(line)[1:]])
        said = capsys.readouterr()
        printed = [*said.out.splitlines(), *said.err.splitlines()]
        wanted = [each for each in shown if not any(word in each for word in OF_THE_MACHINE)]
        missing = [each for each in wanted if not any(alike(each, other) for other in printed)]
        assert missing == [], (page, line)
        assert unknown_numbers(speeds, " ".join(printed)) == [], (page, line)
