"""What no command and no public name reaches is not there.

The walk starts at the console script, the commands and the public names and follows every name that a definition uses.
It takes a name for used wherever it stands, so that what it does not reach has no use at all.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import frbcli
from frbcli.cli.main import COMMANDS
from frbcli.plot.picture import PICTURES

PACKAGE = Path(frbcli.__file__).parent

# In array notation what a kernel computes, for readers and for the tests that hold the kernel to it.
PLAIN = (
    ("frbcli.film.rectangles.film_force", "solve_plain"),
    ("frbcli.film.rectangles.short", "short_pressure"),
    ("frbcli.film.roughness.plain", "plain_touch"),
)
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
    found = reached(modules, [*roots(), *PLAIN])
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
