"""The package's headless Chromium, whose pictures are arrays here."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from spear_pin.viz import chromium
from spear_pin.viz.chromium import find

__all__ = ["Browser", "find", "pixels"]


class Browser(chromium.Browser):
    """One headless browser with one page."""

    def screenshot(self, save_to: Path | None = None) -> NDArray[np.uint8]:
        """What the page looks like, (height, width, 3)."""
        image = self.capture()
        if save_to is not None:
            save_to.write_bytes(image)
        return pixels(image)


def pixels(image: bytes) -> NDArray[np.uint8]:
    """A picture, (height, width, 3)."""
    return np.asarray(Image.open(io.BytesIO(image)).convert("RGB"))
