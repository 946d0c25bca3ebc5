"""Who may import whom: the table of docs/architecture.md, read and enforced. What no command and no public name reaches
is not there. The walk starts at the console script, the commands and the public names and follows every name that a
definition uses. It takes a name for used wherever it stands, so that what it does not reach has no use at all."""

import ast
import re
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest

import frbcli
from frbcli.cli.main import COMMANDS
from frbcli.plot.picture import PICTURES

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


Name = tuple[str, str]  # module, name of what it defines


@dataclass
class Module:
    """What a module defines, what each definition uses, and where its imports lead."""

    definitions: dict[str, list[ast.stmt]] = field(default_factory=lambda: defaultdict(list))
    always: list[ast.stmt] = field(default_factory=list)  # what runs when it is imported and defines nothing
    imported: dict[str, Name] = field(default_factory=dict)


def read(file: Path) -> tuple[str, Module]:
    parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
    name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
    module, tree = Module(), ast.parse(file.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                module.imported[alias.asname or alias.name] = (node.module, alias.name)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                module.imported[alias.asname or alias.name.partition(".")[0]] = (alias.name, "")
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            module.definitions[statement.name].append(statement)
            module.always += [ast.Expr(decorator) for decorator in statement.decorator_list]
        elif isinstance(statement, ast.Assign | ast.AnnAssign | ast.AugAssign):
            targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
            names = [node for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)]
            for node in names:
                if isinstance(node.ctx, ast.Store):
                    module.definitions[node.id].append(statement)
            if not any(isinstance(node.ctx, ast.Store) for node in names):  # of an attribute
                module.always.append(statement)
        elif not isinstance(statement, ast.Import | ast.ImportFrom):
            module.always.append(statement)
    return name, module


def uses(module: Module, here: str, statement: ast.AST) -> Iterator[Name]:
    """The definitions that a statement names."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Name):
            yield module.imported.get(node.id, (here, node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            of, inside = module.imported.get(node.value.id, ("", ""))
            yield f"{of}.{inside}".rstrip("."), node.attr
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


def overloads(module: Module) -> Iterator[tuple[str, str]]:
    """(implementation, what it implements): numba finds it by its decorator."""
    for name, statements in module.definitions.items():
        for statement in statements:
            if isinstance(statement, ast.FunctionDef):
                for decorator in statement.decorator_list:
                    if isinstance(decorator, ast.Call) and getattr(decorator.func, "id", "") == "overload":
                        yield name, ast.unparse(decorator.args[0])


def parents(module: str) -> Iterator[str]:
    """The packages of a module, which are imported before it."""
    while "." in module:
        module = module.rpartition(".")[0]
        yield module


def reached(modules: dict[str, Module], roots: list[Name]) -> set[Name]:
    found, waiting, awake = set[Name](), list(roots), set[str]()
    implementing = {
        (module.imported.get(what, (here, what))): (here, name)
        for here, module in modules.items()
        for name, what in overloads(module)
    }
    while waiting:
        here, name = waiting.pop()
        if f"{here}.{name}" in modules:  # a module, imported by its name
            here, name = f"{here}.{name}", ""
        if here not in modules or (here, name) in found:
            continue
        found.add((here, name))
        module = modules[here]
        statements = list(module.definitions.get(name, ()))
        if name in module.imported and name not in module.definitions:
            waiting.append(module.imported[name])
        if here not in awake:
            awake.add(here)
            statements += module.always
            waiting += [(package, "") for package in parents(here)]
        if (here, name) in implementing:
            waiting.append(implementing[here, name])
        for statement in statements:
            waiting += uses(module, here, statement)
    return found


def roots() -> list[Name]:
    public = [module.partition(":") for module in frbcli._PUBLIC.values()]
    named = [(module, attribute or name) for (module, _, attribute), name in zip(public, frbcli._PUBLIC, strict=True)]
    places = (place.partition(":") for place, *_ in COMMANDS.values())
    commands = [(module, attribute or "command") for module, _, attribute in places]
    drawn = (place.partition(":") for place in PICTURES.values())
    pictures = [(f"frbcli.plot.{module}", name) for module, _, name in drawn]
    start = [("frbcli.cli.process", "main"), ("frbcli", "__getattr__"), ("frbcli", "__dir__")]
    return [*start, *named, *commands, *pictures]


def test_commands_and_public_names_reach_all_that_is_there() -> None:
    modules = dict(map(read, PACKAGE.rglob("*.py")))
    found = reached(modules, roots())
    unused = [
        f"{here}.{name}"
        for here, module in modules.items()
        for name in module.definitions
        if (here, name) not in found and not name.startswith("__")
    ]
    assert sorted(unused) == []


def test_the_walk_finds_what_nothing_uses() -> None:
    """A definition that only itself uses is not reached, one that is used by way of others is."""
    source = "def lost():\n    return lost()\n\ndef helped():\n    return TABLE[0]\n\nTABLE = (1,)\n"
    tree, module = ast.parse(source), Module()
    for statement in tree.body:
        name = statement.name if isinstance(statement, ast.FunctionDef) else "TABLE"
        module.definitions[name].append(statement)
    assert {name for _, name in reached({"one": module}, [("one", "helped")])} == {"helped", "TABLE"}
