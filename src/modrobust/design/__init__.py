"""Gains of the law ``sampled``, chosen for a robot's box and the loop that it is run in."""
