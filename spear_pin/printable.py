"""Text as it may be shown: what acts on a terminal, or cannot be seen, is written out."""

from __future__ import annotations

import unicodedata

# letters and marks by their category, but nothing is seen of them
_UNSEEN = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u3164\uffa0")


def printable(text: str, kept: str = "") -> str:
    r"""Write out, as `\x1b`, the characters that act on a terminal or cannot be seen.

    These are controls, ends of lines, marks of direction and of no width, and lone surrogates. Spaces stay.

    Args:
        text: from anywhere.
        kept: characters that stay all the same, such as ends of lines in a table.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(char if char in kept or _is_seen(char) else _written_out(char) for char in text)


def is_printable(text: str) -> bool:
    """Tell whether a text has no character that `printable` writes out."""
    return all(map(_is_seen, text))


def _is_seen(char: str) -> bool:
    return char not in _UNSEEN and (char.isprintable() or unicodedata.category(char) == "Zs")


def _written_out(char: str) -> str:
    code = ord(char)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"
