"""Plugin of pytest: its workers get the time to write down what they counted.

pytest-xdist ends a worker that is not gone ten seconds after its last test, and with it the counts
of coverage.py and gcov, which are written at the very end. On a busy machine that is too soon.
"""

from xdist.workermanage import NodeManager

NodeManager.EXIT_TIMEOUT = 300  # [s]
