"""Our functions against Algorithm 1 written line by line in NumPy (src/modrobust/reference.py).

python benchmarks/numpy_transcription.py [ROBOT ...]
"""

from common import main

from modrobust.bench.peers.python_calls import numpy_transcription

if __name__ == "__main__":
    main("NumPy, Algorithm 1", numpy_transcription)
