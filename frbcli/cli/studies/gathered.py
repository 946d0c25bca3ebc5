"""Options of a command that belong together reach it as one frozen record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import wraps
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def gathered(name: str, record: type) -> Callable[[Function], Function]:
    """Give a command the options that are named as the fields of a dataclass as one argument; below the options."""
    names = [field.name for field in fields(record)]

    def decorated(function: Function) -> Function:
        @wraps(function)
        def command(**options: Any) -> Any:
            options[name] = record(**{option: options.pop(option) for option in names})
            return function(**options)

        return command  # type: ignore[return-value]

    return decorated
