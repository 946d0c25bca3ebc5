"""Who may import whom: the table of docs/architecture.md, read and enforced."""

import ast
import re
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import frbcli

PACKAGE = Path(frbcli.__file__).parent
PROJECT = PACKAGE.parent
ROW = re.compile(r"^\| `([a-z_]+)(?:/|\.py)` \|.*\| ([^|]*) \|$", re.MULTILINE)

# Libraries that have one room, so that they can be exchanged there.
LIBRARY_ROOMS = {
    "click": {"cli"},
    "rich": {"cli"},
    "matplotlib": {"plot"},
    "pint": {"units"},
    "pydantic": {"case"},
    "pydantic_core": {"case"},
    "h5py": {"results"},
    "jinja2": {"report"},
}
HEAVY = ("numpy", "scipy", "numba", "pydantic", "pint", "matplotlib", "pandas", "h5py", "skfem", "rich", "jinja2")


def documented_dependencies() -> dict[str, set[str]]:
    """Each room of the table with all it may import, directly or through what it imports."""
    rows = dict(ROW.findall((PROJECT / "docs" / "architecture.md").read_text(encoding="utf-8")))
    rooms = set(rows)
    direct = {
        room: rooms if "everything" in text else {word for word in re.findall(r"[a-z_]+", text) if word in rooms}
        for room, text in rows.items()
    }
    for _ in rooms:  # as many rounds as the longest chain can have
        direct = {room: uses.union(*(direct[used] for used in uses)) for room, uses in direct.items()}
    return direct


@cache
def parts(file: Path) -> list[ast.AST]:
    """All nodes of a file's syntax tree."""
    return list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))


def imports(file: Path) -> Iterator[str]:
    """The dotted names of all modules that `file` imports, at any place in it."""
    package = ("frbcli", *file.relative_to(PACKAGE).parent.parts)
    for node in parts(file):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join((*above, *filter(None, [node.module])))
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def room_of(file: Path) -> str:
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


FILES = sorted(file for file in PACKAGE.rglob("*.py") if file.parent != PACKAGE or not file.stem.startswith("__"))


def test_table_names_every_room() -> None:
    documented = documented_dependencies()
    assert {room_of(file) for file in FILES} <= set(documented)
    assert "rotor" not in documented["film"]
    assert "film" not in documented["rotor"]


def test_imports_follow_the_table() -> None:
    documented, strangers = documented_dependencies(), dict[str, set[str]]()
    for file in FILES:
        room, names = room_of(file), set(imports(file)) - {"frbcli.__version__"}
        used = {name.split(".")[1] for name in names if name.startswith("frbcli.")}
        if not used <= documented[room] | {room}:
            strangers[str(file.relative_to(PACKAGE))] = used - documented[room] - {room}
    assert strangers == {}


def test_libraries_stay_in_their_rooms() -> None:
    strangers = [
        (str(file.relative_to(PACKAGE)), name)
        for file in FILES
        for name in {name.split(".")[0] for name in imports(file)} & set(LIBRARY_ROOMS)
        if room_of(file) not in LIBRARY_ROOMS[name]
    ]
    assert strangers == []


def test_help_imports_nothing_heavy() -> None:
    code = f"""
import sys
from frbcli.cli.main import run
assert run(["--help"]) == 0
loaded = sorted(name for name in {HEAVY!r} if name in sys.modules)
assert not loaded, loaded
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "waterfall" in done.stdout


def test_plans_are_made_without_a_compiler() -> None:
    """Those are slow to import: of kernels, of matrices (which turbochargers have), of pictures. A case with heat has
    its temperatures from kernels that are compiled already: the compiler comes last. Short runs of films on cells, for
    the error that is expected, are part of what is shown, not of the plan. Balls have elliptic integrals."""
    code = """
import sys
import frbcli
from frbcli.cli.main import run
cases = {name: frbcli.load_case(name) for name in frbcli.shipped_cases()}
light = [name for name, case in cases.items() if case.heat is None and not case.shaft and "ball" not in name]
for name in light:
    assert run(["check", name, "--quiet"]) == 0
assert run(["check", "jeffcott"]) == 0
loaded = sorted({"numba", "scipy.linalg", "scipy.sparse", "matplotlib"} & set(sys.modules))
assert not loaded, loaded
for name in cases:
    if cases[name].heat is None:
        assert run(["check", name, "--quiet"]) == 0
assert "numba" not in sys.modules and len(light) < len(cases)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_public_names_resolve_lazily() -> None:
    code = f"""
import sys, frbcli
assert not [name for name in {HEAVY!r} if name in sys.modules]
assert frbcli.load_case("jeffcott").name == "jeffcott"
"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    for name in frbcli.__all__:
        assert getattr(frbcli, name)
    with pytest.raises(AttributeError):
        frbcli.no_such_name  # noqa: B018


def test_version_is_that_of_the_project() -> None:
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert frbcli.__version__ == project["version"]


MOST_ARGUMENTS, MOST_LINES = 10, 70


def test_functions_are_short_and_take_few_arguments() -> None:
    too_long = []
    for file in PACKAGE.rglob("*.py"):
        for node in parts(file):
            if isinstance(node, ast.FunctionDef):
                given = node.args
                words = node.body[0] if ast.get_docstring(node) is not None else None
                documented = 0 if words is None else (words.end_lineno or 0) - words.lineno + 1
                lines = (node.end_lineno or 0) - node.lineno - documented
                arguments = len(given.posonlyargs + given.args + given.kwonlyargs)
                if arguments > MOST_ARGUMENTS or lines >= MOST_LINES:
                    too_long.append((str(file.relative_to(PACKAGE)), node.name))
    assert too_long == []


MOST_FILES = 12


def test_rooms_are_small() -> None:
    """A stranger can draw a room after one look; the folders of the tests count, too."""
    files = Counter(file.parent for folder in (PACKAGE, PROJECT / "tests") for file in folder.rglob("*.py"))
    assert {str(room.relative_to(PROJECT)): count for room, count in files.items() if count > MOST_FILES} == {}


def test_a_class_name_has_one_meaning() -> None:
    names = [
        (node.name, str(file.relative_to(PACKAGE)))
        for file in PACKAGE.rglob("*.py")
        for node in parts(file)
        if isinstance(node, ast.ClassDef)
    ]
    places: dict[str, list[str]] = {}
    for name, place in names:
        places.setdefault(name, []).append(place)
    assert not {name: found for name, found in places.items() if len(found) > 1}


def test_public_methods_say_what_they_do() -> None:
    """A method that overrides another one has its docstring, as `help` shows it, unless it has more to say."""
    classes = {node.name: node for file in FILES for node in parts(file) if isinstance(node, ast.ClassDef)}

    def line(name: str) -> Iterator[ast.ClassDef]:
        if name in classes:
            yield classes[name]
            for base in classes[name].bases:
                yield from line(ast.unparse(base).partition("[")[0])

    def says(node: ast.AST, name: str) -> bool:
        return isinstance(node, ast.FunctionDef) and node.name == name and ast.get_docstring(node) is not None

    silent = [
        (name, method.name)
        for name, node in classes.items()
        if not name.startswith("_")
        for method in node.body
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_")
        if not any(says(own, method.name) for ancestor in line(name) for own in ancestor.body)
    ]
    assert silent == []


MODULE = re.compile(r"(?<![\w./{}])(?:\w+/)*\w+\.py\b")


def test_modules_that_are_named_are_there() -> None:
    """In comments, docstrings and pages: a module that has moved is looked for in vain."""
    folders = ("frbcli", "tests", "docs", ".ci")
    there = [file.relative_to(PROJECT).as_posix() for folder in folders for file in (PROJECT / folder).rglob("*.py")]
    texts = (*PACKAGE.rglob("*.py"), *(PROJECT / "docs").rglob("*.md"))
    missing = [
        (str(file.relative_to(PROJECT)), name)
        for file in texts
        for name in MODULE.findall(file.read_text(encoding="utf-8"))
        if not any(f"/{place}".endswith(f"/{name}") for place in there)
    ]
    assert missing == []
