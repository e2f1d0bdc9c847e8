"""Makes docs/figures/lwa4p-payload.png: the last picture of a video that the product rendered.

Needs the extra ``video`` and an OpenGL that renders without a screen.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageSequence

TARGET = Path(__file__).parents[1] / "docs" / "figures" / "lwa4p-payload.png"
RUN = ("simulate", "lwa4p-payload", "--duration", "3s", "--video", "run.gif")
COLOURS = 128


def main() -> None:
    """Runs, renders, and keeps the last picture."""
    with TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "modrobust", *RUN], cwd=folder, check=True)
        with Image.open(Path(folder) / "run.gif") as video:
            last = [frame.convert("RGB") for frame in ImageSequence.Iterator(video)][-1]
    last.quantize(COLOURS).save(TARGET, optimize=True)
    print(f"{TARGET.name}: {last.size[0]} x {last.size[1]}, {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
