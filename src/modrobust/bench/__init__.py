"""Time and tightness of the bounds: ours, a search over the box, and other programs' (peers)."""

from modrobust.bench.benchmark import benchmark
from modrobust.bench.found_range import found_range, probe_count

__all__ = ["benchmark", "found_range", "probe_count"]
