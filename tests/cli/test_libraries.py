"""What a process of `frb` imports: what it uses, and nothing else."""

import subprocess
import sys
from pathlib import Path

# A command as the console script calls it, and which of some libraries it has imported
SCRIPT = """
import sys
from frbcli.cli.process import main
sys.argv = ["frb", *sys.argv[1:]]
try:
    main()
except SystemExit as ended:
    assert not ended.code, ended.code
heavy = {"scipy.linalg", "scipy.special", "scipy.sparse", "scipy.optimize", "matplotlib", "pandas", "pint", "rich"}
heavy |= {"numba.np.arraymath", "numba.np.linalg"}  # among what numba needs to compile
print(*sorted(heavy & set(sys.modules)))
"""
# In such a process, how matplotlib tells a class of its own to take its properties, and a picture
DRAWS = """
import sys
from frbcli.cli.process import prepare_libraries
if sys.argv[1] == "prepared":
    prepare_libraries()
import matplotlib.artist
from frbcli.plot.style import new_figure, save_figure
figure = new_figure("title", "subtitle")
axes = figure.subplots()
axes.plot([0.0, 1.0], [0.0, 2.0], label="line")
axes.legend().set(visible=True)
axes.set(xlabel="x", xlim=(0.0, 1.0))
save_figure(figure, sys.argv[1] + ".png")
print(len(axes.set.__doc__ or ""))
"""
RUN = ("runup", "jeffcott", "--set", "speed.duration=0.05 s", "--force", "--quiet", "--no-picture", "-o", "x.h5")


def python(place: Path, *words: str) -> str:
    return subprocess.run([sys.executable, *words], cwd=place, capture_output=True, text=True, check=True).stdout


def test_a_run_whose_tables_are_kept_imports_no_library_that_it_does_not_use(tmp_path: Path) -> None:
    """The first run may make tables and modes of the film, which need scipy; the second finds them on the disk."""
    python(tmp_path, "-c", SCRIPT, *RUN)
    assert python(tmp_path, "-c", SCRIPT, *RUN).split() == []


def test_matplotlib_draws_the_same_without_the_docstrings_of_its_classes(tmp_path: Path) -> None:
    assert int(python(tmp_path, "-c", DRAWS, "plain")) > 0
    assert int(python(tmp_path, "-c", DRAWS, "prepared")) == 0
    assert (tmp_path / "prepared.png").read_bytes() == (tmp_path / "plain.png").read_bytes()
