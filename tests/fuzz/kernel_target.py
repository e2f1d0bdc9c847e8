"""Builds the kernel's fuzz target with clang's libFuzzer, and runs it for long.

    python tests/fuzz/kernel_target.py FOLDER [libFuzzer options]

keeps the target, the seeds, what it learnt and what it found in FOLDER; a second run goes on.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from support.kernel.native import FOLDER, compile_objects, compiler  # noqa: E402

FLAGS = [
    "-O1",
    "-g",
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow",
    "-fno-sanitize-recover=all",
]
OPTIONS = ["-max_len=16384", "-timeout=10", "-rss_limit_mb=2048"]


def build(folder: Path) -> Path:
    """The target as a program in a folder; skips where there is no clang or no libFuzzer."""
    import pytest

    path, target = compiler("clang"), folder / "kernel_fuzz"
    (folder / "empty.c").write_text("int LLVMFuzzerTestOneInput(void) { return 0; }\n")
    probe = [path, FLAGS[2], str(folder / "empty.c"), "-o", str(folder / "empty")]
    if subprocess.run(probe, capture_output=True, check=False).returncode != 0:
        pytest.skip("clang has no libFuzzer; install its runtime, such as libclang-rt-14-dev")
    sources = [HERE / "kernel_fuzz.c", *sorted(FOLDER.glob("*.c"))]
    objects = compile_objects("clang", FLAGS, sources, folder)
    subprocess.run([path, FLAGS[2], *objects, "-lm", "-o", target], check=True)
    return target


def main(folder: Path, options: list[str]) -> int:
    from fuzz.kernel_seeds import write_seeds

    folder.mkdir(parents=True, exist_ok=True)
    write_seeds(folder / "seeds")
    (folder / "grown").mkdir(exist_ok=True)
    command = [str(build(folder).absolute()), *OPTIONS, *options, "grown", "seeds"]
    return subprocess.run(command, cwd=folder, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
