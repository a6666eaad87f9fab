"""A good record and ways to write it."""

import numpy as np

T = np.arange(400) / 1000
ANGLE = 1.0 + 0.25 * np.sin(30 * T)


def table(head="time_s,knee_rad", separator=",", decimal=".", end="\n", row="{t:.3f}{s}{a:.6f}"):
    """The good record as text."""
    lines = [head.replace(",", separator)] if head else []
    lines += [row.format(t=t, a=a, s="|").replace(".", decimal) for t, a in zip(T, ANGLE, strict=True)]
    return end.join(lines).replace("|", separator) + end


def changed(number, line, text=None):
    """The good record, or another, with another line."""
    lines = (text or table()).split("\n")
    lines[number] = line
    return "\n".join(lines)


def written(folder, content, name="record.csv"):
    """The path of a file with this content."""
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path
