"""Time and tightness of the bounds: ours, a search over the box, and other programs' (peers)."""
