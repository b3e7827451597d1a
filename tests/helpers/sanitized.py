"""CUDA C as a program for the CPU under AddressSanitizer, each array in an allocation of its own."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

MAIN = """
#include <cstdio>
#include <cstdlib>
static void* p[64];
int main() {
  int head[3];  // what `call` needs, and how many arrays there are
  while (fread(head, 4, 3, stdin) == 3) {
    for (int i = 0; i < head[2]; ++i) {
      long long size;
      if (fread(&size, 8, 1, stdin) != 1) return 3;
      p[i] = malloc(size);
      if (fread(p[i], 1, size, stdin) != size_t(size)) return 3;
    }
    call(head[0], head[1]);
    for (int i = 0; i < head[2]; ++i) free(p[i]);
  }
  return 0;
}
"""


class Program:
    """The program; `add` writes a call, `run` makes all of them.

    Args:
        folder: Where it is made.
        source: C++, with `run` of the kernel's own test.
        call: How that is called: C++ that names `p`, `a` and `b`.
    """

    def __init__(self, folder: Path, source: str, call: str) -> None:
        compiler = shutil.which("c++") or shutil.which("g++")
        if compiler is None:
            pytest.skip("there is no C++ compiler here")
        self.path, self.calls = folder / "checked", folder / "calls"
        main = folder / "checked.cpp"
        body = MAIN.replace("int main()", f"static void call(int a, int b) {{ {call}; }}\nint main()")
        main.write_text(source + body)
        options = ["-std=c++17", "-O1", "-w", "-fno-strict-aliasing", "-fsanitize=address"]
        if subprocess.run([compiler, *options, "-o", self.path, main], check=False).returncode:
            pytest.skip("the compiler has no AddressSanitizer")
        self.calls.write_bytes(b"")

    def add(self, arrays: Sequence[np.ndarray], a: int = 0, b: int = 0) -> None:
        """Writes a call of arrays, results among them."""
        with self.calls.open("ab") as file:
            file.write(np.array([a, b, len(arrays)], np.int32).tobytes())
            for x in arrays:
                file.write(np.int64(x.nbytes).tobytes() + np.ascontiguousarray(x).tobytes())

    def run(self, seconds: float = 200) -> None:
        """Fails with what the sanitizer says."""
        with self.calls.open("rb") as file:
            done = subprocess.run([self.path], stdin=file, capture_output=True, text=True, timeout=seconds, check=False)
        assert done.returncode == 0, done.stderr[:3000]
