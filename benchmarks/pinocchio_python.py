"""Our functions against Pinocchio's through its Python binding, one call at a time.

python benchmarks/pinocchio_python.py [ROBOT ...]
"""

from common import main

from modrobust.bench.peers.python_calls import pinocchio_python

if __name__ == "__main__":
    main("Pinocchio, Python", pinocchio_python)
