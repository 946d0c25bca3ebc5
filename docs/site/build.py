"""Build the documentation as a site: `python docs/site/build.py [FOLDER]`, by default build/site.

The pages are those of docs/ and the README; to them come a page for every command with its help and a picture that the
command itself draws here, a gallery, the reference of the Python functions from their docstrings, and a search. Nothing
is loaded from a network, neither now nor by a reader, and a warning of MkDocs ends the build.
"""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import click

import frbcli
from frbcli.cli.main import COMMANDS, GROUPS, frb
from frbcli.linear.sheets.film_state import FilmState

sys.path.insert(0, str(Path(__file__).parent))
from reference import reference

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
SHORT = ["--set", "film.theory=short"]
RUN = ["runup", "jeffcott", *SHORT, "--set", "output.signals=[\"force\", \"power\"]", "-o", "run.h5"]
FIT = ["--measured", "run.h5", "--vary", "bearing.clearance"]
# The line that draws the picture of each command, and what it draws; commands without a picture show their output.
SHOWN: dict[str, tuple[list[str], str]] = {
    "check": (["check", "jeffcott"], ""),
    "rotation": (["rotation", "bearing-axial-groove", "--cavitation", "half-sommerfeld,reynolds"],
                 "bearing-axial-groove-rotation.png"),
    "squeeze": (["squeeze", "squeeze", "--cavitation", "half-sommerfeld", "--set", "motion.periods=1"],
                "squeeze-squeeze.png"),
    "whirl": (["whirl", "whirl", "--cavitation", "half-sommerfeld", "--set", "motion.periods=1"], "whirl-whirl.png"),
    "runup": (RUN, "run-summary.png"),
    "rundown": (["rundown", "jeffcott", *SHORT, "-o", "down.h5"], "down-summary.png"),
    "waterfall": (["waterfall", "run.h5", "--rpm"], "run-waterfall.png"),
    "plot": (["plot", "run.h5", "--what", "orbit"], "run-orbit.png"),
    "compare": (["compare", "jeffcott", "--cavitation", "half-sommerfeld,sommerfeld", *SHORT], "jeffcott-compare.png"),
    "bearing": (["bearing", "jeffcott"], "jeffcott-bearing.png"),
    "thrust": (["thrust", "thrust", "--speed", "900 Hz"], "thrust-thrust.png"),
    "fit": (["fit", "jeffcott", *SHORT, "--set", "bearing.clearance=37 um", *FIT], "jeffcott-fit.png"),
    "stability": (["stability", "jeffcott"], "jeffcott-campbell.png"),
    "limit-cycles": (["limit-cycles", "jeffcott"], "jeffcott-limit-cycles.png"),
    "response": (["response", "jeffcott", *SHORT], "jeffcott-response.png"),
    "balance": (["balance", "run.h5", "--planes", "disk", "--speed", "100 Hz"], ""),
    "accuracy": (["accuracy", "jeffcott", "--theory", "short", "--until", "1 s"], "jeffcott-accuracy.png"),
    "sweep": (["sweep", "jeffcott", *SHORT, "--stability", "--jobs", "1", "--set",
               "bearing.clearance=30 um,35 um,40 um,45 um", "-o", "study"], "study/sweep.png"),
    "report": (["report", "run.h5"], ""),
    "export": (["export", "run.h5"], ""),
    "warm-up": (["warm-up", "jeffcott"], ""),
    "docs": (["docs", "conventions", "--text"], ""),
    "cases": (["cases"], ""),
    "schema": (["schema"], ""),
}  # fmt: skip
# Further pictures of the gallery: line, picture, words.
MORE = [
    (["plot", "run.h5", "--what", "power"], "run-power.png", "Power that goes into the film of a run-up."),
    (["waterfall", "run.h5", "--cascade", "-o", "cascade.png"], "cascade.png", "The waterfall as a cascade."),
    (["stability", "jeffcott", *SHORT, "--shapes", "200 Hz"], "jeffcott-shapes.png", "Damped modes and their shapes."),
    (["response", "turbocharger-car", "--speed", "1000 Hz", "--map"], "turbocharger-car-critical-map.png",
     "Undamped critical speeds over the stiffness of the bearings."),
    (["runup", "squeeze-film-damper", "-o", "damper.h5"], "damper-summary.png",
     "A rotor on squeeze film dampers passes its critical speed."),
    (["runup", "turbocharger-engine", "-o", "engine.h5"], "engine-summary.png",
     "A turbocharger in an elastic housing, shaken by orders 2, 4 and 6 of its engine."),
    (["runup", "cold-start", "-o", "cold.h5"], "cold-summary.png",
     "A cold start: the rotor idles while its oil warms up, and runs up on warm oil."),
    (["thrust", "turbocharger-car-thrust"], "turbocharger-car-thrust-thrust.png",
     "The thrust bearing of a turbocharger where it carries its axial load."),
    (["bearing", "bearing", "--over", "eccentricity"], "bearing-bearing.png", "A bearing over its eccentricity."),
]  # fmt: skip
LONGEST = 40  # lines of output on a page
WIDTH = 80  # columns of a help: what a page shows without scrolling


def main(target: Path, quick: bool) -> None:
    """Build into `target`; quick: without running commands, for a look at the pages alone."""
    source = target.parent / f"{target.name}-source"
    shutil.rmtree(source, ignore_errors=True)
    (source / "commands").mkdir(parents=True)
    pictures = source / "pictures"
    pictures.mkdir()
    pages(source)
    shown = dict.fromkeys(COMMANDS, "") if quick else run_commands(pictures)
    for name in COMMANDS:
        (source / "commands" / f"{name}.md").write_text(command_page(name, shown[name], quick), encoding="utf-8")
    gallery(source, pictures, quick)
    (source / "reference.md").write_text(reference(None if quick else pictures), encoding="utf-8")
    settings = source.parent / f"{target.name}.yml"
    settings.write_text(configuration(source, target), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-f", str(settings)], check=True)


def pages(source: Path) -> None:
    """The pages of docs/ as they are, the README as the first page, with links that lead within the site."""
    for page in DOCS.glob("*.md"):
        text = page.read_text(encoding="utf-8").replace("](../README.md)", "](index.md)")
        name = "contents.md" if page.name == "README.md" else page.name
        (source / name).write_text(text, encoding="utf-8")
    shutil.copy(DOCS / "tutorial.ipynb", source)
    shutil.copytree(DOCS / "images", source / "images")
    shutil.copy(DOCS / "site" / "equations.css", source)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    readme = readme.replace("](docs/README.md)", "](contents.md)").replace("](docs/", "](")
    outside = r"\[([^\]]*)\]\((?:LICENSE|CHANGELOG\.md|CITATION\.cff|(?:cases|tests|frbcli)/[^)]*)\)"
    readme = re.sub(outside, r"\1", readme)
    (source / "index.md").write_text(readme, encoding="utf-8")


def run_commands(pictures: Path) -> dict[str, str]:
    """Run the line of every command among the pictures; its output by its name."""
    said = {"runup": run(SHOWN["runup"][0], pictures)}  # others need its run
    others = [name for name in COMMANDS if name not in said]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outputs = pool.map(lambda words: run(words, pictures), [SHOWN[name][0] for name in others])
        more = pool.map(lambda words: run(words, pictures), [words for words, _, _ in MORE])
        printed_tables(pictures / "printed.png")
        said |= dict(zip(others, outputs, strict=True))
        list(more)  # raises what a line raised
    return said


def run(words: list[str], folder: Path) -> str:
    """What a line prints; a line that fails ends the build."""
    start = "from frbcli.cli.process import main; main()"
    line = [sys.executable, "-c", start, *words]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"frb {' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def command_page(name: str, output: str, quick: bool) -> str:
    """Help, line, output and picture of one command."""
    command = frb.get_command(click.Context(frb), name)
    assert command is not None
    context = click.Context(command, info_name=f"frb {name}", max_content_width=WIDTH, terminal_width=WIDTH,
                            help_option_names=["-h", "--help"])  # fmt: skip
    words, picture = SHOWN[name]
    line = " ".join(f'"{word}"' if " " in word or '"' in word else word for word in words)
    lines = output.rstrip().splitlines()
    told = "\n".join([*lines[:LONGEST], *(["..."] if len(lines) > LONGEST else [])])
    parts = [f"# frb {name}", COMMANDS[name][1], f"```text\n{command.get_help(context)}\n```", "## Example"]
    parts.append(f"```sh\nfrb {line}\n```")
    if told:
        parts.append(f"```text\n{told}\n```")
    if picture and not quick:
        parts.append(f"![The picture of frb {name}](../pictures/{picture})")
    return "\n\n".join(parts) + "\n"


def gallery(source: Path, pictures: Path, quick: bool) -> None:
    """All pictures with the lines that draw them."""
    parts = ["# Gallery", "Every picture is drawn by the line above it, when this site is built."]
    shown = [(words, picture, COMMANDS[name][1]) for name, (words, picture) in SHOWN.items() if picture]
    for words, picture, told in [] if quick else [*shown, *MORE]:
        assert (pictures / picture).exists(), picture
        parts.append(f"## {told}\n\n```sh\nfrb {' '.join(words)}\n```\n\n![{told}](pictures/{picture})")
    if not quick:
        told = "Dots are printed, lines computed: Sommerfeld number and attitude angle over the eccentricity."
        head = "## Butenschoen's tables and `frb bearing`"
        parts.append(f"{head}\n\n{told}\n\n![Printed and computed](pictures/printed.png)")
    (source / "gallery.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def printed_tables(target: Path) -> None:
    """Butenschoen's Sommerfeld numbers and attitude angles, and those of the bearing sheet."""
    from matplotlib.figure import Figure

    from frbcli.plot.style import COLOURS, styled

    text = (ROOT / "tests" / "data" / "butenschoen.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    with styled():
        figure = Figure(figsize=(8.6, 4.0))
        left, right = figure.subplots(1, 2)
        for colour, ratio in zip(COLOURS, ("1", "0.5", "0.25"), strict=False):
            own = [row for row in rows if float(row["width_over_diameter"]) == float(ratio)]
            places = [float(row["eccentricity"]) for row in own]
            sheet = [_printed_state(row) for row in own]
            for axes, key, values in (
                (left, "sommerfeld_number", [state.sommerfeld_number for state in sheet]),
                (right, "attitude_deg", [state.attitude_deg for state in sheet]),
            ):
                axes.plot([state.eccentricity for state in sheet], values, color=colour, label=f"B/D = {ratio}")
                axes.plot(places, [float(row[key]) for row in own], color=colour, marker="o", markersize=3.5,
                          linestyle="none")  # fmt: skip
        left.set_yscale("log")
        left.set_ylabel("Sommerfeld number")
        right.set_ylabel("attitude angle in °")
        for axes in (left, right):
            axes.set_xlabel("eccentricity")
        right.legend()
        figure.savefig(target, dpi=150)


def _printed_state(row: dict[str, str]) -> FilmState:
    """The film of one row, which begins at the widest gap: there is a groove of half a degree."""
    groove = f'{{ kind = "axial-grooves", position = "{row["attitude_deg"]} deg", opening_angle = "0.5 deg", '
    case = frbcli.load_case("bearing", [
        f"bearing.width={0.02 * float(row['width_over_diameter'])}", "bearing.diameter=20 mm",
        "bearing.clearance=20 um", "film.cavitation=reynolds", "oil.viscosity=10 mPa*s", "bearing.ends=oil-bath",
        f'bearing.supply={groove}pressure = "1 bar" }}',
    ])  # fmt: skip
    return frbcli.sommerfeld_chart(case, [float(row["eccentricity"])], 50.0).points[0]


def configuration(source: Path, target: Path) -> str:
    """Settings of MkDocs: no fonts and scripts from elsewhere, equations by equations.py."""
    commands = "\n".join(f"      - {name}: commands/{name}.md" for names in GROUPS.values() for name in names)
    guides = ("cases", "floating-rings", "rotors", "elements", "surroundings", "heat", "thrust", "bearing-sheet",
              "limit-cycles", "gas-and-contact", "measurements", "sweeps", "report", "standards")  # fmt: skip
    concepts = ("conventions", "theory", "equations", "couplings", "accuracy", "validation", "textbooks")
    tables = ("case-file", "matrix", "columns", "command-line")
    development = ("contributing", "architecture", "adding-a-model", "accuracy-measured", "limit-cycles-method",
                   "hard-cases")  # fmt: skip

    def entries(names: tuple[str, ...]) -> str:
        return "\n".join(f"      - {name.replace('-', ' ')}: {name}.md" for name in names)

    return f"""site_name: frb
docs_dir: {source}
site_dir: {target}
use_directory_urls: false
theme:
  name: material
  font: false
  features: [navigation.sections, content.code.copy]
plugins: [search]
markdown_extensions:
  - tables
  - fenced_code
  - toc
  - pymdownx.arithmatex:
      generic: true
hooks: [{DOCS / "site" / "equations.py"}]
extra_css: [equations.css]
validation:
  links:
    anchors: warn
nav:
  - frb: index.md
  - tutorial:
      - contents: contents.md
      - installation: installation.md
      - tutorial: tutorial.md
      - terms: terms.md
      - gallery: gallery.md
  - how-to:
{entries(guides)}
  - concepts:
{entries(concepts)}
  - reference:
{entries(tables)}
      - Python: reference.md
  - commands:
{commands}
  - development:
{entries(development)}
"""


if __name__ == "__main__":
    given = [word for word in sys.argv[1:] if word != "--quick"]
    main(Path(given[0] if given else ROOT / "build" / "site").resolve(), "--quick" in sys.argv[1:])
