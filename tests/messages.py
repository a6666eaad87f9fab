"""Every refusal that the package can say: `python -m tests.messages [--flagged]` prints them.

A row has the place, the class of the error, its text with what is filled in between braces, and what the text lacks. A
message should say what was given, where, what is valid and what to type, in at most two lines; of a list of names it
should show the nearest three.
"""

from __future__ import annotations

import argparse
import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("spear_pin", "viz", "urdf")
MOST = 200  # characters of a message, what is filled in counted as WIDTH
WIDTH = 10
PATTERNS = {  # how a class makes its text of its arguments, and their names
    "BadValue": ("{name} is {value}; expected {expected}", ("name", "value", "expected")),
    "UnknownName": ("unknown {kind} {value}; valid: {valid}, or {also}", ("kind", "value", "valid", "also")),
    "BadFunction": ("{what}: {problem}", ("what", "function", "file", "line", "problem")),
    "BadFile": ("{path}: {problem}", ("path", "problem", "line")),
    "NoGait": ("no gait found: {reason}; {cause}; try {remedy}", ("reason", "residual", "cause", "remedy")),
    "Infeasible": (
        "{constraint} is missed by {violation} {unit}; try {remedy}",
        ("constraint", "violation", "unit", "remedy"),
    ),
    "import_extra": ("{purpose} needs {module}: pip install '.[{extra}]'", ("module", "extra", "purpose")),
    "MissingProgram": ("{purpose} need {program}: install {package}", ("program", "purpose", "package")),
    "require": ("{name} is {value}; expected {expected}", ("name", "value", "valid", "expected")),
}
HELPERS = ("require", "import_extra")  # functions that raise
REFUSE = ("refuse", "error")  # methods of the command line's parser
TELLING = "errors.py"  # makes the texts of the classes
# by one of these a reader finds what to do; the system's own words tell that, too
HINT = re.compile(
    r"--\w|`|remedy|tried|strerror|\b(expected|valid|try|give|use|name|pass|run|type|write|set|load|install|lock|needs?|"
    r"takes?|only|must|should|add|choose|remove|rename|save|resume|make|leave (it )?out|let|instead|nearest|at most|at "
    r"least|more than|say)\b"
)
LIST = re.compile(r"\{', '\.join\((?![A-Z]+\b)")  # but a constant, which is as short as it stands there
FORBIDDEN = re.compile(
    r"\b(from cold|beside|led|told|tells|wish(?:es)?|across|seen|lets? go|begun|asked|by features)\b"
)


@dataclass(frozen=True)
class Message:
    """A refusal.

    Attributes:
        place: file and line.
        kind: class of the error.
        text: what it says, with what is filled in between braces.
        lacks: what is wrong with it.
    """

    place: str
    kind: str
    text: str
    lacks: tuple[str, ...]


def sources() -> list[Path]:
    """The files of the package."""
    return sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))


def kinds(trees: list[ast.Module]) -> set[str]:
    """Names of `SpearError` and of all classes made from it."""
    classes = [node for tree in trees for node in tree.body if isinstance(node, ast.ClassDef)]
    found = {"SpearError"}
    while True:
        more = {each.name for each in classes if {called(base) for base in each.bases} & found} - found
        if not more:
            return found
        found |= more


def called(node: ast.AST) -> str:
    """Name of a class or a function without its module."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def said(node: ast.expr | None, known: dict[str, ast.expr]) -> str:
    """The text of an expression, with what is filled in between braces.

    Args:
        node: the expression.
        known: what names of the function stand for.
    """
    match node:
        case None:
            return ""
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=values):
            return "".join(said(value, known) for value in values)
        case ast.FormattedValue(value=value):
            return said(value, known) if isinstance(value, ast.Name | ast.IfExp) else hole(value)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return said(left, known) + said(right, known)
        case ast.IfExp(body=body, orelse=orelse):
            return max(said(body, known), said(orelse, known), key=len)
        case ast.Name(id=name) if name in known:
            return said(known[name], {key: value for key, value in known.items() if key != name})
        case ast.Call(func=func, args=[only]) if called(func) in ("one_line", "printable", "str"):
            return said(only, known)
    return hole(node)


def hole(node: ast.expr) -> str:
    """What is filled in, between braces."""
    return "{" + ast.unparse(node).translate({ord("{"): "(", ord("}"): ")"}) + "}"


def arguments(call: ast.Call, names: tuple[str, ...]) -> dict[str, ast.expr]:
    """Arguments of a call by their names."""
    return dict(zip(names, call.args, strict=False)) | {each.arg: each.value for each in call.keywords if each.arg}


def text_of(kind: str, call: ast.Call, known: dict[str, ast.expr]) -> str:
    """What a refusal says."""
    if kind not in PATTERNS:
        texts = [said(each, known) for each in call.args]
        return max(texts, key=lambda text: len(re.sub(r"\{.*?\}", "", text)), default="")
    pattern, names = PATTERNS[kind]
    given = {name: said(value, known) for name, value in arguments(call, names).items()}
    parts = [
        part for part in re.split(r"(?<=[;:,]) ", pattern) if not re.search(r"\{(\w+)\}", part) or filled(part, given)
    ]
    return re.sub(r"\{(\w+)\}", lambda hole: given.get(hole[1], ""), " ".join(parts)).rstrip(";:, ")


def filled(part: str, given: dict[str, str]) -> bool:
    """Whether anything is given for the holes of a part of a pattern."""
    return any(given.get(name) for name in re.findall(r"\{(\w+)\}", part))


def lacking(kind: str, text: str) -> Iterator[str]:
    """What is wrong with a message."""
    if len(re.sub(r"\{[^{}]*\}", "#" * WIDTH, text)) > MOST:
        yield "long"
    plain, expected = re.sub(r"\{[^{}]*\}", "", text), text.partition("; expected ")[2]
    if LIST.search(expected or text):
        yield "the nearest of a list"
    if kind in ("BadValue", "require"):
        if not expected or re.match(r"(no|not|none|another|other)\b", expected):
            yield "what is valid"
    elif kind != "UnknownName" and re.search(r"\w \w", plain) and not HINT.search(text):
        yield "what to do"
    if words := sorted(set(re.findall(FORBIDDEN, plain))):
        yield f"the word {', '.join(words)}"


def assigned(function: ast.AST) -> dict[str, ast.expr]:
    """What names of a function are set to, where that is done once and is a text."""
    found: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            found.setdefault(node.targets[0].id, []).append(node.value)
    return {name: values[0] for name, values in found.items() if len(values) == 1 and is_text(values[0])}


def is_text(node: ast.expr) -> bool:
    """Whether an expression is a text, as far as it shows."""
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def within(tree: ast.Module) -> Iterator[tuple[ast.Call, tuple[ast.AST, ...]]]:
    """Each call in a file, with the functions that it stands in."""
    waiting: list[tuple[ast.AST, tuple[ast.AST, ...]]] = [(tree, ())]
    while waiting:
        node, functions = waiting.pop()
        if isinstance(node, ast.Call):
            yield node, functions
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions = (*functions, node)
        waiting += [(child, functions) for child in ast.iter_child_nodes(node)]


def names_of(tree: ast.Module, functions: tuple[ast.AST, ...]) -> dict[str, ast.expr]:
    """What names of a file and of functions stand for."""
    known = assigned(ast.Module([node for node in tree.body if isinstance(node, ast.Assign)], []))
    for function in functions:
        known |= assigned(function)
    return known


def imports(tree: ast.Module, name: str) -> bool:
    """Whether a file imports a name from the module of errors."""
    froms = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module == "spear_pin.errors")
    return any(alias.name == name for node in froms for alias in node.names)


@cache
def messages() -> tuple[Message, ...]:
    """All refusals, by file and line."""
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in sources()}
    classes = kinds([*trees.values()])
    found = []
    for path, tree in trees.items():
        if path.name == TELLING:
            continue
        for call, functions in within(tree):
            kind = called(call.func)
            refuses = path.parent.name == "cli" and isinstance(call.func, ast.Attribute) and kind in REFUSE
            helps = isinstance(call.func, ast.Name) and kind in HELPERS and imports(tree, kind)
            if kind in classes or helps or refuses or re.fullmatch("Argument(Type)?Error", kind):
                text = text_of(kind, call, names_of(tree, functions))
                place = path.relative_to(ROOT).as_posix(), call.lineno
                found.append((place, Message(f"{place[0]}:{place[1]}", kind, text, tuple(lacking(kind, text)))))
    return tuple(message for _, message in sorted(found, key=lambda each: each[0]))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flagged", action="store_true", help="only those that lack something")
    flagged = parser.parse_args().flagged
    every = messages()
    for each in every:
        if each.lacks or not flagged:
            lacks = f"  <- {'; '.join(each.lacks)}" if each.lacks else ""
            print(f"{each.place:<52} {each.kind:<16} {each.text}{lacks}")
    print(f"{len(every)} messages, {sum(bool(each.lacks) for each in every)} flagged")


if __name__ == "__main__":
    main()
