"""Python that does what a command did: commands give values and calls, and imports and layout are made here."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping, Sized
from dataclasses import MISSING, Field, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

WIDTH = 100  # columns of a line, beyond which its arguments stand in lines of their own
UNSAID = object()


class Code(str):
    """Source text of a value; a call knows its arguments, so that it can be broken into lines."""

    head: str = ""
    arguments: tuple[str, ...] = ()


class Program:
    """Lines of Python, and what they import.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.cli.python_lines import Program
        >>> program = Program()
        >>> robot = program.let("robot", program.call(load, "spear_ii", locked=["boom_x"]))
        >>> print(program)
        from spear_pin import load
        <BLANKLINE>
        robot = load("spear_ii", locked=["boom_x"])
    """

    def __init__(self) -> None:
        self._imports: dict[str, set[str]] = {}
        self._lines: list[str] = []

    def let(self, name: str, value: object) -> Code:
        """Add a line that gives a value a name, by which other lines call it."""
        self._add(f"{name} = ", value)
        return Code(name)

    def do(self, value: object) -> None:
        """Add a line of a call whose result is not kept."""
        self._add("", value)

    def show(self, value: object) -> None:
        """Add a line that prints a value."""
        self._add("", _call("print", [self.source(value)]))

    def say(self, text: str) -> None:
        """Add a comment."""
        self._lines.append(f"# {' '.join(text.split())}")

    def say_functions(self, *functions: Callable[..., Any]) -> None:
        """Add a comment that names the functions that a command calls, where no few lines do the same."""
        names = (f"{function.__module__}.{function.__qualname__}" for function in functions)
        self.say(f"this command calls {', '.join(names)}")

    def call(self, function: Callable[..., Any], *arguments: object, **options: object) -> Code:
        """Write a call of a function or class of this package; options that it has by default are left out."""
        return _call(self.name(function), [*map(self.source, arguments), *self._options(function, options)])

    def method(self, of: Code, name: str, *arguments: object, **options: object) -> Code:
        """Write a call of a method of a value; options that are None or empty are left out."""
        given = [f"{option}={self.source(value)}" for option, value in options.items() if not _is_nothing(value)]
        return _call(f"{of}.{name}", [*map(self.source, arguments), *given])

    def change(self, base: Code, own: Any, value: Any) -> Code:
        """Write a dataclass as another one with other numbers.

        Args:
            base: source of the other one.
            own: the other one.
            value: the dataclass.
        """
        names = [field.name for field in fields(value) if getattr(value, field.name) != getattr(own, field.name)]
        if not names:
            return base
        return self.call(replace, base, **{name: getattr(value, name) for name in names})

    def name(self, function: Callable[..., Any]) -> str:
        """Import a function or class from where readers would look for it, and return what it is called."""
        name: str = function.__qualname__
        first, parts = name.partition(".")[0], function.__module__.split(".")
        homes = (".".join(parts[: i + 1]) for i in range(len(parts)))
        found = next((home for home in homes if _is_home(home, first, function)), function.__module__)
        self.take(found, first)
        return name

    def take(self, module: str, name: str) -> None:
        """Import a constant."""
        self._imports.setdefault(module, set()).add(name)

    def source(self, value: Any) -> str:
        """Write a value as Python does; a dataclass by what it has not by default.

        Raises:
            TypeError: its source is not known.
        """
        from spear_pin.model.catalogue import MOTORS, motor
        from spear_pin.model.motor import Motor

        if isinstance(value, Code):
            return value
        if isinstance(value, Motor) and value.name in MOTORS and value == motor(value.name):
            return self.call(motor, value.name)
        if is_dataclass(value) and not isinstance(value, type):
            return self.call(
                type(value), **{f.name: getattr(value, f.name) for f in fields(value) if _is_own(value, f)}
            )
        if isinstance(value, Mapping):
            return f"{{{', '.join(f'{self.source(key)}: {self.source(each)}' for key, each in value.items())}}}"
        if isinstance(value, list):
            return f"[{', '.join(map(self.source, value))}]"
        if isinstance(value, tuple):
            return f"({', '.join(map(self.source, value))}{',' * (len(value) == 1)})"
        if isinstance(value, (str, Path)):
            quoted = repr(str(value))
            return quoted if {'"', "\\"} & set(quoted) else f'"{quoted[1:-1]}"'
        if value is None or isinstance(value, (bool, int)):
            return repr(value)
        if isinstance(value, float) or hasattr(value, "__float__"):
            return repr(float(value))
        raise TypeError(f"no source of {type(value).__name__}")

    def __str__(self) -> str:
        """Lines, the imports first."""
        first = sorted(self._imports, key=lambda module: (module.startswith("spear_pin"), module))
        imports = [f"from {module} import {', '.join(sorted(self._imports[module]))}" for module in first]
        return "\n".join([*imports, *([""] if imports else []), *self._lines])

    def _add(self, begin: str, value: object) -> None:
        source = self.source(value)
        if len(begin) + len(source) > WIDTH and isinstance(source, Code) and source.arguments:
            lines = "".join(f"    {each},\n" for each in source.arguments)
            source = f"{source.head}(\n{lines})"
        self._lines += f"{begin}{source}".split("\n")

    def _options(self, function: Callable[..., Any], options: Mapping[str, object]) -> list[str]:
        usual = {name: each.default for name, each in inspect.signature(function).parameters.items()}
        own = {name: value for name, value in options.items() if not _is_same(value, usual.get(name, UNSAID))}
        return [f"{name}={self.source(value)}" for name, value in own.items()]


def _call(head: str, arguments: list[str]) -> Code:
    code = Code(f"{head}({', '.join(arguments)})")
    code.head, code.arguments = head, tuple(arguments)
    return code


def _is_own(value: Any, field: Field[Any]) -> bool:
    """Whether a field of a dataclass has to be said."""
    usual = field.default if field.default_factory is MISSING else field.default_factory()
    return field.init and not _is_same(getattr(value, field.name), usual)


def _is_nothing(value: object) -> bool:
    return value is None or (isinstance(value, Sized) and not len(value))


def _is_same(value: object, usual: object) -> bool:
    if _is_nothing(value) and _is_nothing(usual):
        return True
    return type(value) is type(usual) and bool(value == usual)


def _is_home(module: str, name: str, function: Callable[..., Any]) -> bool:
    """Whether a module has a function, or the class that it is of, by its name."""
    found = getattr(sys.modules.get(module), name, None)
    return found is not None and getattr(found, "__module__", None) == function.__module__
