"""Our whole robust command in C against one inverse dynamics of Pinocchio in C++, in one process.

    python benchmarks/pinocchio_cpp.py [ROBOT ...]

1,000 random states, 101 interleaved rounds, native flags for both, then the kernel with the flags
that it ships with. CC and CXX name other compilers. Needs a C++ compiler and the extra "peers".
"own bounds": those of the file, Table II for lwa4p-paper. "all bodies": 5 % of mass, 5 mm of COM,
10 % of inertia on every body. Target: ratios of minima at most 1.0 and 1.5 with `hull`.
"""

from functools import partial

from common import announce, main

from modrobust.bench.peers.native import pinocchio_cpp

if __name__ == "__main__":
    for flags in ("native", "shipped"):
        main("Pinocchio, C++", partial(pinocchio_cpp, flags=flags, announce=announce))
