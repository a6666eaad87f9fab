"""Results kept from one run to the next, in the user's cache folder, until something that they depend on changes.

A key is a hash over the package's own files, the versions of the libraries that compute and draw, and the item's name;
so any change of the package makes everything again. The cache does not use joblib or diskcache, which unpickle what
they read from a folder that others may write to. It is in the folder where heyoka also keeps what it compiles.
"""

from __future__ import annotations

import hashlib
import os
import platform
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from spear_pin.errors import BadFile
from spear_pin.files import atomic

LIBRARIES = ("numpy", "scipy", "pin", "matplotlib", "meshcat", "jinja2")
SUFFIXES = (".py", ".urdf", ".json", ".mplstyle", ".html", ".css", ".js")
MOST_BYTES = 60_000_000


@dataclass(frozen=True)
class Cache:
    """Bytes by name, in a folder of its own from which the oldest are removed.

    Attributes:
        folder: folder of the files.
        state: state of the package and its libraries, part of every key.
    """

    folder: Path
    state: str

    def get(self, name: str) -> bytes | None:
        """Returns the content kept under a name; None where there is none, or where it has changed."""
        path = self._path(name)
        with suppress(OSError):
            if path.is_file() and path.stat().st_size <= MOST_BYTES:
                digest, _, content = path.read_bytes().partition(b"\n")
                return content if digest == _digest(content) else None
        return None

    def put(self, name: str, content: bytes) -> None:
        """Keeps a content, if the disk allows it; removes the oldest to make room."""
        with suppress(OSError, BadFile):
            self.folder.mkdir(parents=True, exist_ok=True)
            with atomic(self._path(name), at_once=True) as temporary:
                temporary.write_bytes(_digest(content) + b"\n" + content)
            self._prune()

    def _path(self, name: str) -> Path:
        return self.folder / hashlib.sha256(f"{self.state} {name}".encode()).hexdigest()

    def _prune(self) -> None:
        kept = sorted((entry.stat().st_mtime, entry.stat().st_size, entry.path) for entry in os.scandir(self.folder))
        total = sum(size for _, size, _ in kept)
        for _, size, path in kept:
            if total <= MOST_BYTES:
                break
            with suppress(OSError):
                Path(path).unlink()
            total -= size


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()


def user_cache() -> Cache:
    """Returns the cache of this user for the present package."""
    home = os.environ.get("XDG_CACHE_HOME")
    return Cache((Path(home) if home else Path.home() / ".cache") / "spear_pin", package_state())


def package_state() -> str:
    """Returns a hash of the package's files, of Python's version and of its libraries'."""
    digest = hashlib.sha256(platform.python_version().encode())
    for name in LIBRARIES:
        digest.update(f" {name} {version(name)}".encode())
    root = Path(str(files("spear_pin")))
    found = sorted(
        Path(folder) / name
        for folder, _, names in os.walk(root, followlinks=True)
        for name in names
        if name.endswith(SUFFIXES)
    )
    for path in found:
        content = path.read_bytes()
        digest.update(f" {path.relative_to(root).as_posix()} {len(content)} ".encode())
        digest.update(content)
    return digest.hexdigest()
