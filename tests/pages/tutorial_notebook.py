"""Writes docs/tutorial.ipynb, with outputs: `cd tests && python -m pages.tutorial_notebook`; needs nbclient, ipykernel.

Its case is that of docs/tutorial.md, so that the notebook runs alone wherever it is opened.
"""

import os
import re
import tempfile
from pathlib import Path

from paths import DOCS

NOTEBOOK = DOCS / "tutorial.ipynb"
MOST_SECONDS = 1800


def case_text() -> str:
    """The case of the page, as its blocks of TOML give it one after the other."""
    page = (DOCS / "tutorial.md").read_text(encoding="utf-8")
    return "\n".join(re.findall(r"```toml\n(.*?)```", page, re.DOTALL))


def cells() -> list[tuple[str, str]]:
    """Kind and source of each cell."""
    return [
        ("markdown", "# A turbocharger in Python\n\n"
         "The case is that of the tutorial page; every step of the terminal is one function."),
        ("code", f"import frbcli\n\ntext = '''\n{case_text()}'''\n"
         'case = frbcli.load_case_text(text, name="turbo")\ncase'),
        ("markdown", "What will be modelled, and why:"),
        ("code", "frbcli.make_plan(case)"),
        ("markdown", "The run-up. The file keeps everything; `run` reads from it."),
        ("code", 'run = frbcli.runup(case, "turbo.h5")\nrun'),
        ("code", "frbcli.picture(run)"),
        ("code", "run.to_pandas().describe()"),
        ("markdown", "Waterfall and orbit on given axes:"),
        ("code", "from matplotlib import pyplot\n\nfigure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 4), "
         'width_ratios=(2, 1), layout="constrained")\nfrbcli.draw_waterfall(run, signal="front", ax=left)\n'
         'frbcli.draw_orbit(run, bearing="front", ax=right)'),
        ("markdown", "Undamped critical speeds over the stiffness of the bearings, and a page to send:"),
        ("code", "frbcli.picture(frbcli.critical_map(case, [1e5, 1e6, 1e7]))"),
        ("code", 'frbcli.write_report(run, "turbo.html", signal="front")'),
    ]  # fmt: skip


def write() -> None:
    """Run the cells in an empty folder and keep them with their outputs."""
    import nbformat
    from nbclient import NotebookClient

    made = nbformat.v4.new_notebook(metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}})
    make = {"markdown": nbformat.v4.new_markdown_cell, "code": nbformat.v4.new_code_cell}
    made.cells = [make[kind](source, id=f"cell-{place}") for place, (kind, source) in enumerate(cells())]
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(made, timeout=MOST_SECONDS, kernel_name="python3").execute(cwd=folder)
    for cell in made.cells:
        cell.metadata.pop("execution", None)  # when it ran
    nbformat.write(made, NOTEBOOK)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONWARNINGS", "ignore")
    assert Path(NOTEBOOK).parent.is_dir()
    write()
